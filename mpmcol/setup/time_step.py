"""The time step that a case asks for, beside the largest one that a point of its column bears alone."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from math import isinf, sqrt

from mpmcol.case import Case
from mpmcol.mpm.kernels.transfer_common import WALL_GAP
from mpmcol.mpm.shape_functions import SHAPE_FUNCTIONS
from mpmcol.setup.stability_limit import BETWEEN, FREE, SMOOTH, STICKING, TRANSFERS, LonePoint, one_point_bound

AXIS_GAP = 0.2  # in h: points nearer to the axis would be too stiff for the default time step; the first start farther

Nearby = tuple[float, str, str]  # place along a direction, what the first node of it is, and that in words
WALL = "a wall"
_BETWEEN: Nearby = (BETWEEN, FREE, "")


def points_per_axis(case: Case) -> int:
    """Points along each edge of a full cell."""
    return round(case.grid.points_per_cell ** (1.0 / case.geometry.dimension))


def axis_gap(case: Case) -> float:
    """How near to the axis points may come, in h: no nearer than they start."""
    return min(AXIS_GAP, 0.5 / points_per_axis(case))


def case_bound(case: Case) -> tuple[float, str]:
    """The largest time.cfl that a lone point of the column bears wherever it may come, and the place that bears least.

    In each direction that is between two nodes, or as near to a wall, the floor or the axis as points are kept; for the
    linear basis a line of nodes, on which no step is small enough.
    """
    if isinf(SHAPE_FUNCTIONS[case.method.basis].STIFFNESS):
        return 0.0, "on a line of nodes"
    return min((_bound(case, nearby), _in_words(nearby)) for nearby in product(*_directions(case)))


def _directions(case: Case) -> Iterator[tuple[Nearby, ...]]:
    """Along x, y and, in three dimensions, z: where a lone point of the column may be."""
    model = case.geometry.model
    side: Nearby = (axis_gap(case), SMOOTH, "the axis") if model == "axisymmetric" else (WALL_GAP, SMOOTH, WALL)
    sides = (_BETWEEN,) if model == "full" else (_BETWEEN, side)
    yield sides
    yield (_BETWEEN, (WALL_GAP, STICKING, "the floor")) if case.geometry.base == "rigid" else (_BETWEEN,)
    if case.geometry.dimension == 3:
        yield sides


def _bound(case: Case, nearby: tuple[Nearby, ...]) -> float:
    method = case.method
    place, walls, _ = zip(*nearby, strict=True)
    return one_point_bound(
        LonePoint(
            place, case.material.poissons_ratio, walls, case.geometry.model == "axisymmetric", method.transfer,
            method.flip_fraction, method.basis, method.kernel_correction,
        )
    )  # fmt: skip


def _in_words(nearby: tuple[Nearby, ...]) -> str:
    beside = [where for _, _, where in nearby if where]
    if beside.count(WALL) == 2:
        beside = ["two walls", *(where for where in beside if where != WALL)]
    return "beside " + " and ".join(beside) if beside else "half-way between nodes"


def time_step_limit(case: Case) -> str:
    """What a lone point bears in this case, in words."""
    bound, where = case_bound(case)
    if bound == 0.0:
        return f'a point alone bears no step {where} of the "{case.method.basis}" basis'
    return f"in this case a point alone bears {bound:.2f}, {where}"


def time_step_warnings(case: Case) -> list[str]:
    """A line if the case asks for more than a lone point bears."""
    cfl, (bound, where) = case.time.cfl, case_bound(case)
    if bound == 0.0:
        return [
            f'method.basis = "{case.method.basis}": with time.cfl = {cfl:g} a point alone is unstable where it is '
            f"within {_reach(case):.2g} h of a line of nodes along each axis; lower time.cfl if the run diverges"
        ]
    if cfl <= bound:
        return []
    return [f"time.cfl = {cfl:g} exceeds {bound:.2f}, up to which a point alone is stable {where}"]


def _reach(case: Case) -> float:
    """How near to a node hats are too steep, in h: xi of omega^2 = (1 + (d - 1) nu / (1 - nu)) / (xi (1 - xi))."""
    nu, taylor = case.material.poissons_ratio, TRANSFERS[case.method.transfer][0]
    sideways = (1.0 + (case.geometry.dimension - 1) * nu / (1.0 - nu)) * (1.0 if taylor else 2.0)
    return 0.5 - 0.5 * sqrt(max(1.0 - case.time.cfl**2 * sideways, 0.0))
