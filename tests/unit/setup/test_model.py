"""The model of a case: the keys of [method] in the solver, and the warnings of its time step."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mpmcol.case import load_case
from mpmcol.mpm.boundary import GATE
from mpmcol.mpm.grid import grid_shape, node_coordinates
from mpmcol.mpm.settings import PAPER, Scheme
from mpmcol.setup.discretization import discretize
from mpmcol.setup.model import build_model, initial_gate_opening, make_boundaries, set_boundaries
from mpmcol.setup.time_step import case_limit


@pytest.mark.parametrize(
    ("method", "taylor", "flip_fraction", "scheme"),
    [
        ([], 1.0, 1.0, PAPER),
        (["transfer=flip", "flip_fraction=0.9"], 0.0, 0.9, PAPER),
        (["transfer=pic"], 0.0, 0.0, PAPER),
        (["transfer=tpic"], 1.0, 0.0, PAPER),
        (["transfer=apic"], 1.0, 0.0, Scheme(affine=True)),
        (["stress_order=usf"], 1.0, 1.0, Scheme(stress_order="usf")),
        (["basis=cubic"], 1.0, 1.0, Scheme(basis="cubic")),
        (["volumetric_strain=cell"], 1.0, 1.0, Scheme(volumetric_strain="cell")),
        (["basis=linear", "transfer=flip"], 0.0, 1.0, Scheme(basis="linear")),
        (["stress_order=musl", "transfer=apic"], 1.0, 0.0, Scheme(stress_order="musl", affine=True)),
    ],
    ids=str,
)
def test_keys_of_the_method(method: list[str], taylor: float, flip_fraction: float, scheme: Scheme) -> None:
    model = build_model(load_case("coarse-channel", [f"method.{setting}" for setting in method]))
    for stage in (model.equilibrate, model.collapse):
        assert (stage.settings.taylor, stage.settings.flip_fraction) == (taylor, flip_fraction)
    assert model.scheme == scheme


@pytest.mark.parametrize(("update", "exponential"), [("determinant", False), ("exponential", True)])
def test_volume_update(update: str, exponential: bool) -> None:
    model = build_model(load_case("coarse-channel", [f"method.volume_update={update}"]))
    assert {model.equilibrate.settings.exponential_volume, model.collapse.settings.exponential_volume} == {exponential}


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (["time.cfl=0.6"], ""),
        (
            ["time.cfl=0.62"],
            "time.cfl = 0.62 exceeds 0.6, the stability limit of a single particle next to the smooth wall",
        ),
        (["method.transfer=flip"], "time.cfl = 0.5 exceeds 0.44"),
        (["time.cfl=0.62", "method.basis=cubic"], ""),
        (["time.cfl=0.64", "method.basis=cubic"], "time.cfl = 0.64 exceeds 0.62"),
        (["method.basis=linear"], "with time.cfl = 0.5 a single particle is unstable within 0.085 h"),
    ],
    ids=str,
)
def test_time_steps_above_the_single_particle_limit_cause_a_warning(overrides: list[str], message: str) -> None:
    """Limits for nu = 0.2 in plane strain."""
    warnings = [text for text in discretize(load_case("coarse-channel", overrides)).warnings if "cfl" in text]
    assert len(warnings) == (1 if message else 0)
    assert all(message in text for text in warnings)


@pytest.mark.parametrize("overrides", [["method.transfer=flip"], ["method.basis=cubic"], ["geometry.base=rigid"]])
def test_the_limit_in_a_message_is_itself_stable(overrides: list[str]) -> None:
    (warning,) = (
        text for text in discretize(load_case("lube-channel", [*overrides, "time.cfl=1"])).warnings if "cfl" in text
    )
    limit = warning.partition("exceeds ")[2].partition(",")[0]
    warnings = discretize(load_case("lube-channel", [*overrides, f"time.cfl={limit}"])).warnings
    assert not any("cfl" in text for text in warnings)


def test_without_a_gate_its_nodes_are_free_from_the_start() -> None:
    closed, free = (build_model(load_case("coarse-channel", [f"stages.gate={gate}"])) for gate in ("true", "false"))
    assert np.count_nonzero(closed.grid.fixed) > np.count_nonzero(free.grid.fixed)
    set_boundaries(closed.grid, closed.discretization, gate_opening=np.inf)
    assert np.array_equal(closed.grid.fixed, free.grid.fixed)
    assert initial_gate_opening(load_case("coarse-channel", ["stages.gate=false"])) == np.inf


def test_the_model_on_a_slope() -> None:
    """Gravity, assigned stress, the length of the domain, and the speed that gravity can cause in it."""
    level, slope = (
        build_model(load_case("inclined-channel", ["grid.spacing=0.02", f"geometry.slope_deg={degrees}"]))
        for degrees in (0.0, 20.0)
    )
    sine, cosine, tangent = (function(math.radians(20.0)) for function in (math.sin, math.cos, math.tan))
    for stage in (slope.equilibrate, slope.collapse):
        gravity = stage.settings.gravity_x, stage.settings.gravity_y, stage.settings.gravity_z
        assert gravity == pytest.approx((9.81 * sine, -9.81 * cosine, 0.0))
    normal = -1550.0 * 9.81 * cosine * (0.14 - slope.points.x[:, 1])
    assert slope.points.sigma[:, 1] == pytest.approx(normal)
    assert slope.points.sigma[:, 0] == pytest.approx(normal * level.points.sigma[0, 0] / level.points.sigma[0, 1])
    runouts = [one.discretization.length - 0.2 * 1.5 - 4 * 0.02 for one in (level, slope)]  # without margin and end
    friction = math.sin(math.radians(28.5))
    assert runouts[1] / runouts[0] == pytest.approx(friction / (friction - tangent), rel=0.05)  # of whole cells
    drop = 0.14 * cosine + slope.discretization.length * sine
    assert slope.collapse.settings.free_speed == pytest.approx(2.0 * math.sqrt(2.0 * 9.81 * drop))


@pytest.mark.parametrize(
    ("overrides", "limit", "where"),
    [
        (["geometry.model=plane"], 0.549, "the smooth wall and the wall with friction"),
        (["geometry.model=quarter", "grid.points_per_cell=8"], 0.507, "two smooth walls and the wall with friction"),
    ],
)
def test_a_particle_that_separates_from_a_floor_with_friction_limits_the_time_step(
    overrides: list[str], limit: float, where: str
) -> None:
    """It is less stable than beside a smooth floor (0.566 in plane strain) or one without slip (0.628)."""
    assert case_limit(load_case("frictional-floor", overrides)) == (pytest.approx(limit, abs=1e-3), f"next to {where}")


def test_the_least_stable_material_limits_the_time_step() -> None:
    stiff = case_limit(load_case("layered-column", ["material.poissons_ratio=0.4", "layers=[]"]))
    layer = "layers=[{to = 0.03, material = {poissons_ratio = 0.4}}]"
    assert case_limit(load_case("layered-column", [layer])) == stiff < case_limit(load_case("layered-column"))
    bed = ["base_material.poissons_ratio=0.4", "layers=[]", "geometry.base=granular"]
    assert case_limit(load_case("layered-column", bed)) == stiff


@pytest.mark.parametrize("section", ["cylinder", "box"])
def test_points_of_a_3d_column_with_vertical_sides_are_those_of_the_sheared_column(section: str) -> None:
    """Each row of points is inside the section at the base, moved upslope; the gate holds the nodes beyond it."""
    case = load_case(
        "coarse-channel",
        [
            "geometry.model=full", f"geometry.section={section}", "geometry.slope_deg=20", "geometry.sides=vertical",
            "geometry.base=rigid", "grid.points_per_cell=8", "grid.spacing=0.015",
        ],
    )  # fmt: skip
    model = build_model(case)
    size, lean = model.discretization, math.tan(math.radians(20.0))
    x, y, z = model.points.x.T
    at_base = x + lean * y
    inside = np.hypot(at_base, z) < size.r_i if section == "cylinder" else np.maximum(abs(at_base), abs(z)) < size.r_i
    assert inside.all() and at_base.max() > 0.9 * size.r_i and at_base.min() < -0.9 * size.r_i
    exact = case.material.density * size.h_i * size.r_i**2 * (math.pi if section == "cylinder" else 4.0)
    assert model.column_mass == pytest.approx(exact, rel=0.02)
    x, y, z = (np.broadcast_to(each, grid_shape(model.grid)) for each in node_coordinates(model.grid))
    gate = next(each for each in make_boundaries(model.grid, size, 0.0) if each.type == GATE and each.axis == 0)
    distance = np.hypot(x + lean * y, z) if section == "cylinder" else abs(x + lean * y)
    np.testing.assert_array_equal(np.broadcast_to(gate.nodes, x.shape), (distance > size.r_i - 1e-9) & (y > 1e-9))
