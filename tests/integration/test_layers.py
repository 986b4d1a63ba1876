"""Columns with layers: masses, stress at rest, heights, and the energy ledger."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import mpmcol
from mpmcol.case import load_case
from mpmcol.mpm.particles import BASE, COLUMN, LAYER
from mpmcol.setup.model import build_model, mass_above
from tests.support.runs import small_case

HEAVY = "layers=[{from=0, to=0.03, material={density=5300}}, {from=0.03, to=0.06, material={friction_deg=20}}]"
COLUMN_CASE = ("geometry.aspect=1", "grid.spacing=0.015", HEAVY)


def test_points_have_the_kind_and_the_mass_of_their_layer() -> None:
    case = load_case("layered-column", COLUMN_CASE)
    model = build_model(case)
    points, y = model.points, model.points.x[:, 1]
    assert set(points.kind[y < 0.03]) == {LAYER} and set(points.kind[y > 0.06]) == {COLUMN}
    assert set(points.kind[(y > 0.03) & (y < 0.06)]) == {LAYER + 1}
    assert model.column_mass == pytest.approx(0.09 * (0.03 * 5300 + 0.06 * 2650))
    assert not (points.kind == BASE).any()


def test_the_geostatic_stress_is_the_weight_above() -> None:
    case = load_case("layered-column", COLUMN_CASE)
    heights = np.array([0.0, 0.015, 0.03, 0.045, 0.09])
    model, x = build_model(case), np.full(5, 0.01)
    assert mass_above(case, model.discretization, (x,), heights) == pytest.approx([318.0, 238.5, 159.0, 119.25, 0.0])
    points = model.points
    weight = mass_above(case, model.discretization, (points.x[:, 0],), points.x[:, 1])
    assert points.sigma[:, 1] == pytest.approx(-9.81 * weight)


def test_a_layered_collapse_closes_its_ledger_and_measures_heights_by_volume(tmp_path: Path) -> None:
    results = mpmcol.run(small_case("layers", HEAVY, "geometry.aspect=1"), tmp_path)
    summary, release = results.summary, results.measure(0)
    assert abs(summary["ledger"]["residual"]) < 1e-9 * summary["ledger"]["potential"]
    assert release.profile_y[:3] == pytest.approx(0.09, rel=0.02)
    assert results.shape.potential_energy(9.81) == pytest.approx(results.history["potential"][0], rel=0.01)
    assert all(error["error"] is None or "layers" not in error["comment"] for error in summary["errors"])
    assert all("layers" in error["comment"] for error in summary["errors"] if error["expected"] is None)


def test_a_layer_of_the_same_material_changes_nothing_but_the_order_of_sums(tmp_path: Path) -> None:
    """After 0.6 of the fall time, before rounding errors have grown by yielding."""
    short = "stages.equilibrate.law=elastic", "stages.collapse.max_time_factor=0.6"
    plain = mpmcol.run(small_case("layers", *short, "layers=[]"), tmp_path / "plain")
    same = mpmcol.run(small_case("layers", *short, "layers=[{to=0.045, material={}}]"), tmp_path / "same")
    one, other = plain.snapshot(-1).arrays, same.snapshot(-1).arrays
    assert set(one["material"]) == {0} and set(other["material"]) == {0, 2}
    for name in ("position", "velocity", "stress", "volume_ratio"):
        assert other[name] == pytest.approx(one[name], rel=1e-4, abs=1e-6 * float(np.abs(one[name]).max()))
