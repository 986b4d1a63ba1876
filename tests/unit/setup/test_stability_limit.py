"""The time step that a lone point bears: theory, and the least of a case."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from mpmcol.case import load_case, shipped_cases
from mpmcol.mpm.kernels.transfer_common import WALL_GAP
from mpmcol.mpm.shape_functions import SHAPE_FUNCTIONS
from mpmcol.setup.stability_limit import BETWEEN, FREE, SMOOTH, STICKING, LonePoint, one_point_bound
from mpmcol.setup.time_step import axis_gap, case_bound

AXIS = (SMOOTH, FREE)


@pytest.mark.parametrize(
    ("point", "bound"),
    [
        (LonePoint((BETWEEN, BETWEEN), nu=0.0), 0.816),
        (LonePoint((BETWEEN, BETWEEN)), 0.730),
        (LonePoint((BETWEEN, BETWEEN), nu=0.3), 0.683),
        (LonePoint((4.25, 4.25)), 0.856),
        (LonePoint((BETWEEN,) * 3), 0.667),
        (LonePoint((BETWEEN,) * 3, nu=0.3), 0.599),
        (LonePoint((4.25,) * 3), 0.782),
        (LonePoint((0.25, BETWEEN), walls=AXIS, axisymmetric=True), 0.60),
        (LonePoint((0.1, BETWEEN), walls=AXIS, axisymmetric=True), 0.39),
        (LonePoint((0.05, BETWEEN), walls=AXIS, axisymmetric=True), 0.28),
        (LonePoint((BETWEEN,) * 3, transfer="flip"), 0.667 / np.sqrt(2.0)),
        (LonePoint((BETWEEN,) * 3, transfer="pic"), 0.667 / np.sqrt(2.0)),
        (LonePoint((BETWEEN,) * 3, transfer="tpic"), 0.667),
        (LonePoint((BETWEEN,) * 3, transfer="apic"), 0.667 * np.sqrt(0.75)),
        (LonePoint((BETWEEN,) * 2, nu=0.0, basis="cubic"), 2.0 / np.sqrt(SHAPE_FUNCTIONS["cubic"].STIFFNESS)),
    ],
)  # fmt: skip
def test_bounds_of_single_points(point: LonePoint, bound: float) -> None:
    """By hand from S = sum w'^2 / w; near the axis by another script; APIC: omega^2 dt^2 (1 - 2 / S) < 2."""
    assert one_point_bound(point) == pytest.approx(bound, abs=0.5 * 10 ** -len(f"{bound:.3g}".partition(".")[2]) + 1e-3)


@pytest.mark.parametrize("transfer", ["taylor-flip", "flip", "apic"])
@pytest.mark.parametrize("basis", ["quadratic", "cubic"])
@pytest.mark.parametrize(("d", "axisymmetric"), [(2, False), (2, True), (3, False)])
def test_half_way_between_nodes_and_next_to_walls_nothing_bears_less_elsewhere(
    transfer: str, basis: str, d: int, axisymmetric: bool
) -> None:
    rng, gaps = np.random.default_rng(3), np.full(d, WALL_GAP)
    gaps[0] = 0.2 if axisymmetric else WALL_GAP
    point = LonePoint((BETWEEN,) * d, 0.3, (SMOOTH, STICKING, SMOOTH)[:d], axisymmetric, transfer, 1.0, basis)
    corners = np.stack(np.meshgrid(*[(gap, BETWEEN) for gap in gaps], indexing="ij"), -1).reshape(-1, d)
    least = min(one_point_bound(replace(point, place=tuple(map(float, place)))) for place in corners)
    for place in rng.uniform(gaps, BETWEEN, (60, d)):
        assert one_point_bound(replace(point, place=tuple(map(float, place)))) > least - 3e-3, place


@pytest.mark.parametrize("name", shipped_cases())
def test_the_default_stands_for_lone_points_of_every_shipped_case(name: str) -> None:
    bound, _ = case_bound(load_case(name))
    assert bound > 0.5 / 0.95


@pytest.mark.parametrize(
    ("overrides", "bound", "where"),
    [
        ([], 0.544, "beside two walls"),
        (["material.poissons_ratio=0.3"], 0.494, "beside two walls"),
        (["geometry.model=full"], 0.667, "half-way between nodes"),
        (["geometry.model=full", "geometry.base=rigid"], 0.628, "beside the floor"),
        (["geometry.model=axisymmetric", "grid.points_per_cell=16"], 0.438, "beside the axis"),
        (["geometry.model=axisymmetric", "grid.points_per_cell=4", "method.transfer=flip"], 0.416, "beside the axis"),
        (["method.basis=linear"], 0.0, "on a line of nodes"),
    ],
    ids=str,
)
def test_the_least_of_a_case_and_where(overrides: list[str], bound: float, where: str) -> None:
    assert case_bound(load_case("lube-quarter", overrides)) == (pytest.approx(bound, abs=1e-3), where)


def test_points_that_start_near_the_axis_stay_as_near() -> None:
    gaps = {ppc: axis_gap(load_case("lube-cylinder", [f"grid.points_per_cell={ppc}"])) for ppc in (1, 4, 9, 16)}
    assert gaps == {1: 0.2, 4: 0.2, 9: pytest.approx(1.0 / 6.0), 16: 0.125}
