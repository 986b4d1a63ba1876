"""Runs with a random field of friction: limits that have a uniform material, and the field in the snapshots."""

from __future__ import annotations

from math import atan, degrees, radians, tan
from pathlib import Path

import numpy as np
import pytest

import mpmcol
from mpmcol.io.results import Results
from mpmcol.mpm.particles import BASE
from mpmcol.setup.model import build_model

COARSE = ("grid.spacing=0.2", "grid.points_per_cell=4", "geometry.aspect=1", "output.snapshots=2")
SAND = "law = 'mohr-coulomb', density = 1700.0, youngs_modulus = 12e6, poissons_ratio = 0.2"


def run(out: Path, *overrides: str) -> Results:
    return mpmcol.run(mpmcol.load_case("random-friction", [*COARSE, *overrides]), out, notify=lambda note: None)


@pytest.fixture(scope="module")
def field(tmp_path_factory: pytest.TempPathFactory) -> Results:
    return run(tmp_path_factory.mktemp("field") / "run")


def test_a_field_of_infinite_length_is_a_uniform_material(tmp_path: Path) -> None:
    """Its friction angle is that of all points; both collapses then differ by round-off only."""
    long = run(tmp_path / "long", "material.correlation_length=1e9", "material.correlation_length_vertical=1e9")
    ((_, variation),) = long.case.material.initial_history(np.zeros((1, 2)))
    angle = degrees(atan(tan(radians(33.0)) * (1.0 + float(variation))))
    np.testing.assert_allclose(long.snapshot(-1).arrays["local_friction_angle"], angle, rtol=1e-6)
    assert abs(angle - 33.0) > 0.5
    uniform = run(
        tmp_path / "uniform", f"material={{{SAND}, friction_deg = {angle!r}}}", f"stages.k0={long.case.stages.k0!r}"
    )
    assert long.summary["zeta"] == pytest.approx(uniform.summary["zeta"], rel=1e-4)
    assert long.summary["beta"] == pytest.approx(uniform.summary["beta"], rel=1e-4)


def test_points_keep_their_friction(field: Results) -> None:
    first, last = (field.snapshot(k).arrays for k in (0, -1))
    order, later = np.argsort(first["id"]), np.argsort(last["id"])
    np.testing.assert_array_equal(first["local_friction_angle"][order], last["local_friction_angle"][later])
    assert np.abs(first["position"][order] - last["position"][later]).max() > 0.2
    material = field.case.material
    variation = material.initial_history(first["position"][:, :2] - first["displacement"][:, :2])[:, 1]
    expected = np.degrees(np.arctan(tan(radians(33.0)) * (1.0 + variation)))
    # the equilibration moves points a little
    np.testing.assert_allclose(first["local_friction_angle"], expected, atol=0.5)


def test_a_bed_continues_the_field_of_the_column() -> None:
    bed = ("geometry.base=granular", "geometry.base_thickness=0.4")
    points = build_model(mpmcol.load_case("random-friction", [*COARSE, *bed])).points
    below = points.kind == BASE
    assert below.any() and np.ptp(points.history[below, 1]) > 0.1
    material = mpmcol.load_case("random-friction", COARSE).material
    np.testing.assert_array_equal(points.history, material.initial_history(points.x))
    elastic = build_model(mpmcol.load_case("random-friction", [*COARSE, "geometry.base=elastic", bed[1]])).points
    assert np.all(elastic.history[elastic.kind == BASE] == 0.0)  # an elastic base has no friction


def test_realizations_differ(field: Results, tmp_path: Path) -> None:
    other = run(tmp_path / "other", "material.seed=1")
    assert abs(other.summary["zeta"]["front_height"] - field.summary["zeta"]["front_height"]) > 0.01
    mean = tan(radians(33.0)) * (1.0 - 0.2)
    assert other.snapshot(-1).arrays["local_friction_angle"].min() < degrees(atan(mean))


def test_a_layer_has_a_field_of_its_own_parameters(tmp_path: Path) -> None:
    overrides = ("layers=[{from = 0.0, to = 0.4, material = {friction_variation = 0.0, friction_deg = 25.0}}]",)
    found = run(tmp_path / "layer", *overrides).snapshot(-1).arrays
    assert set(np.round(found["local_friction_angle"][found["material"] == 2], 9)) == {25.0}
    assert np.ptp(found["local_friction_angle"][found["material"] == 0]) > 5.0
