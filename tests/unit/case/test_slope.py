"""geometry.slope_deg: its constraints, the defaults that depend on it, and the direction of gravity."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mpmcol.case import case_hash, conditions_of, experiment_of, load_case
from mpmcol.case.slope import ENDLESS_REMEDY, LARGEST_FACTOR, endless_flow, slope_factor
from mpmcol.setup.discretization import discretize
from tests.support.case_files import GOOD, Write, only_problem

SIN_PHI = math.sin(math.radians(28.5))  # of the case inclined-channel


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (["geometry.model=axisymmetric"], 'must be 0 with geometry.model = "axisymmetric"'),
        (["geometry.model=quarter"], 'must be 0 with geometry.model = "quarter"'),
        (["geometry.release=two-sided"], 'must be 0 with geometry.release = "two-sided"'),
        (["geometry.slope_deg=-1"], "expected a number >= 0 and < 90, in deg"),
        (["geometry.slope_deg=90"], "expected a number >= 0 and < 90, in deg"),
    ],
)
def test_models_without_a_downslope_direction_are_refused(write: Write, overrides: list[str], message: str) -> None:
    assert message in only_problem(write(GOOD), "geometry.slope_deg=10", *overrides).message


@pytest.mark.parametrize("model", ["plane", "full"])
def test_other_models_are_accepted(model: str) -> None:
    points = "grid.points_per_cell=8" if model == "full" else "grid.points_per_cell=9"
    case = load_case("coarse-channel", [f"geometry.model={model}", points, "geometry.slope_deg=0.5 rad"])
    assert case.geometry.slope_deg == pytest.approx(math.degrees(0.5))


def test_gravity_points_downslope_and_toward_the_base() -> None:
    geometry = load_case("coarse-channel", ["geometry.slope_deg=30"]).geometry
    assert geometry.gravity_vector == pytest.approx((4.905, -9.81 * math.sqrt(0.75), 0.0))
    assert load_case("coarse-channel").geometry.gravity_vector == (0.0, -9.81, 0.0)


def test_a_slope_of_zero_leaves_the_hash_unchanged() -> None:
    """So that the folders of sweeps keep their names."""
    hashes = [case_hash(load_case("coarse-channel", [f"geometry.slope_deg={slope}"])) for slope in (0, 1e-9, 10)]
    assert hashes[0] == case_hash(load_case("coarse-channel")) == "da9b2b635b34" and len(set(hashes)) == 3


def test_runout_and_duration_grow_as_the_friction_over_its_excess() -> None:
    case = load_case("inclined-channel")
    factor = SIN_PHI / (SIN_PHI - math.tan(math.radians(10.0)))
    assert slope_factor(10.0, case.material) == pytest.approx(factor)
    assert case.stages.collapse.max_time_factor == pytest.approx(10.0 * factor)
    assert load_case("inclined-channel", ["geometry.slope_deg=0"]).stages.collapse.max_time_factor == 10.0
    steep = load_case("inclined-channel", ["geometry.slope_deg=25"])
    assert steep.stages.collapse.max_time_factor == pytest.approx(10.0 * LARGEST_FACTOR)
    assert load_case("inclined-channel", ["stages.collapse.max_time_factor=7"]).stages.collapse.max_time_factor == 7.0


def test_the_flow_stops_below_the_friction_in_shear() -> None:
    slopes = {slope: endless_flow(load_case("inclined-channel", [f"geometry.slope_deg={slope}"])) for slope in (25, 26)}
    assert slopes[25] == "" and slopes[26].startswith("geometry.slope_deg = 26: the flow does not stop")
    assert "25.5 degrees" in slopes[26]
    assert endless_flow(load_case("lube-channel-dense", ["geometry.slope_deg=60"]))
    elastic = "material={ law = 'elastic', density = 2650, youngs_modulus = 1e7, poissons_ratio = 0.2 }"
    assert endless_flow(load_case("coarse-channel", ["geometry.slope_deg=60", elastic])) == ""


def test_no_experiment_applies_to_a_slope() -> None:
    case = load_case("coarse-channel", ["geometry.slope_deg=10"])
    assert experiment_of(case).laws == () and "it slopes by 10 deg" in experiment_of(case).title
    own = experiment_of(load_case("coarse-channel"))
    assert own.laws and own.misfit(conditions_of(case)) == "for a horizontal base; here it slopes by 10 deg"


def test_a_floor_with_less_friction_than_the_material_limits_the_slope() -> None:
    floor = ["friction.floor=0.3", "geometry.slope_deg=10"]
    case = load_case("inclined-channel", floor)
    friction = math.sin(math.radians(28.5))
    assert slope_factor(10.0, case.material, 0.3) == pytest.approx(0.3 / (0.3 - math.tan(math.radians(10.0))))
    assert case.stages.collapse.max_time_factor == pytest.approx(10.0 * slope_factor(10.0, case.material, 0.3))
    assert slope_factor(10.0, case.material, 2.0 * friction) == slope_factor(10.0, case.material)
    assert (slope_factor(0.0, case.material, 0.0), slope_factor(5.0, case.material, 0.0)) == (1.0, LARGEST_FACTOR)
    assert endless_flow(case) == ""
    steep = endless_flow(load_case("inclined-channel", [*floor, "geometry.slope_deg=17"]))
    assert "the friction angle of the floor is 16.7 degrees" in steep


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (["geometry.slope_deg=0"], "has no meaning with geometry.slope_deg = 0"),
        (["geometry.outline=[[0, 0], [0.2, 0], [0, 0.1]]"], "must be absent with geometry.outline"),
        (["geometry.slope_deg=60"], "leads the front of the column to the wall below its top"),
        (
            ["geometry.model=full", "grid.points_per_cell=8", "stages.initial_stress=k0"],
            "only gravity loading finds the stress",
        ),
    ],
)
def test_vertical_sides_are_refused_without_a_slope_or_a_top(write: Write, overrides: list[str], message: str) -> None:
    given = ["geometry.sides=vertical", "geometry.slope_deg=10"]
    assert message in only_problem(write(GOOD), *given, *overrides).message


def test_vertical_sides_are_parallel_to_gravity() -> None:
    geometry = load_case("inclined-channel", ["geometry.sides=vertical"]).geometry
    assert geometry.polygon is not None
    foot, top = np.array(geometry.polygon[1:3])
    downward, upward = np.array(geometry.gravity_vector[:2]) / 9.81, (top - foot) / np.linalg.norm(top - foot)
    np.testing.assert_allclose(upward, -downward, rtol=1e-12)
    normal = load_case("inclined-channel", ["geometry.sides=normal"])
    assert normal.geometry.polygon is None and case_hash(normal) == case_hash(load_case("inclined-channel"))


@pytest.mark.parametrize(
    ("case", "overrides", "limit", "texts"),
    [
        (
            "granular-bed",
            ["base_material.friction_deg=20"],
            18.9,
            ("bed and column flow on", "the friction of the bed in shear is 18.9 degrees"),
        ),
        ("granular-bed", [], 28.6, ("the flow does not stop", "the friction of the material in shear is 28.6 degrees")),
        ("layered-column", [], 20.5, ("the flow does not stop", "the friction of layer 1 in shear is 20.5 degrees")),
    ],
)
def test_the_weakest_of_column_layers_and_bed_limits_the_slope(
    case: str, overrides: list[str], limit: float, texts: tuple[str, str]
) -> None:
    below, above = (load_case(case, [*overrides, f"geometry.slope_deg={limit + step}"]) for step in (-0.1, 0.1))
    assert endless_flow(below) == "" and all(text in endless_flow(above) for text in texts)
    assert below.stages.collapse.max_time_factor == pytest.approx(10.0 * LARGEST_FACTOR)
    assert load_case(case, overrides).stages.collapse.max_time_factor == 10.0
    (note,) = (text for text in discretize(above).warnings if text.startswith("geometry.slope_deg"))
    assert note == f"{endless_flow(above)}; {ENDLESS_REMEDY}"


def test_a_strong_bed_leaves_the_limit_of_the_column() -> None:
    """An elastic base, and a bed with cohesion, do not flow."""
    weak = ["material.friction_deg=20", "geometry.slope_deg=25"]
    for own in (["base_material.friction_deg=40"], ["base_material.cohesion=500"]):
        assert "the friction of the material" in endless_flow(load_case("granular-bed", [*weak, *own]))
    assert "the friction of the material" in endless_flow(load_case("channel", weak))
