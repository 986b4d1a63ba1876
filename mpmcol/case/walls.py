"""Walls that stand in the domain of a case: dams, baffles, steps and end walls."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from itertools import combinations
from typing import Annotated, Any

from pydantic import Field

from mpmcol.case.fields import shortened
from mpmcol.case.friction import coefficient
from mpmcol.case.geometry import GeometryTable
from mpmcol.case.problem import refusal
from mpmcol.units import Table, counted, option, quantity

FLOOR, BACK_WALL, GATE_WALL = "floor", "back_wall", "gate"  # names of the other walls whose forces are recorded
LEAST_CELLS = 2  # thickness and height of a wall, and distance between two of them: splines are three nodes wide
THICKER = "decrease grid.spacing, or enlarge the wall"
_NAME = re.compile(r"[A-Za-z0-9-]{1,40}")

Span = tuple[float | None, float | None]


class WallTable(Table):
    """A rigid wall: a box on the base, from which material may separate."""

    name: str = option("its name in results: letters, digits and hyphens; default: wall-1, wall-2, ...", "")
    from_: Annotated[float, Field(alias="from")] = quantity(
        "its face at the smaller x, distance from the wall, plane of symmetry or axis at x = 0", "m"
    )
    to: float | None = quantity(
        "its face at the larger x; default: an end wall, up to the end of the domain", "m", None
    )
    height: float | None = quantity("its height above the base; default: up to the top of the domain", "m", None, gt=0)
    half_width: float | None = quantity(
        "3D: half of its width across z, if it is in the middle; default: as wide as the domain", "m", None, gt=0
    )
    side_from: float | None = quantity("3D: its face at the smaller z, instead of half_width", "m", None)
    side_to: float | None = quantity("3D: its face at the larger z", "m", None)
    friction: float = coefficient("coefficient mu of its faces, or a friction angle; 0: frictionless", 0.0)

    @property
    def along(self) -> Span:
        """Where it is along x, m; None at the end of the domain."""
        return self.from_, self.to

    @property
    def across(self) -> Span:
        """Where it is along z, m; None at the ends of the domain."""
        if self.half_width is not None:
            return -self.half_width, self.half_width
        return self.side_from, self.side_to

    @property
    def closes(self) -> bool:
        """Whether it closes the domain along x: an end wall that the flow cannot pass."""
        return self.to is None and self.height is None and self.across == (None, None)


def with_names(walls: list[Any]) -> tuple[Any, ...]:
    """Walls as given, with the default of their names."""
    return tuple(
        {"name": f"wall-{number}", **wall} if isinstance(wall, dict) else wall for number, wall in enumerate(walls, 1)
    )


def check_walls(walls: tuple[WallTable, ...], geometry: GeometryTable, wall_impulse: bool, h: float | None) -> None:
    """Raise PydanticCustomError if a wall is not in the domain of this geometry, or in the way of another thing.

    wall_impulse: that of the method, which walls need. h: spacing of the grid, m; None if it is invalid.
    """
    if walls and not wall_impulse:
        raise refusal("walls need their reaction: set method.wall_impulse = true")
    for number, wall in enumerate(walls):
        for key, problem in (*_problems(wall, geometry), *(_thin_parts(wall, geometry.model, h) if h else ())):
            raise refusal(f"wall {shortened(wall.name)}: {problem}", number, key)
    for (_, one), (number, other) in combinations(enumerate(walls), 2):
        if one.name == other.name:
            raise refusal(f"two walls have the name {one.name}", number)
        if _overlap(one.along, other.along) and _overlap(one.across, other.across):
            raise refusal(f"walls {one.name} and {other.name} overlap", number)


def _thin_parts(wall: WallTable, model: str, h: float) -> Iterator[tuple[str, str]]:
    """Keys of the faces of a wall that are less than LEAST_CELLS from the opposite one, and what is wrong."""
    across = (0.0, wall.half_width) if model == "quarter" and wall.half_width is not None else wall.across
    far_key = "side_to" if wall.half_width is None else "half_width"
    for key, (low, high) in (("to", wall.along), ("height", (0.0, wall.height)), (far_key, across)):
        if low is not None and high is not None and (cells := round(high / h) - round(low / h)) < LEAST_CELLS:
            yield key, f"{too_thin(cells, h)}; {THICKER}"


def too_thin(cells: int, h: float) -> str:
    """What is wrong with a wall that is too few cells of size h (m) thick or high."""
    return (
        f"{counted(max(cells, 0), 'cell')} of {h:.4g} m, expected at least {LEAST_CELLS}, since material passes "
        "thinner walls"
    )


def _problems(wall: WallTable, geometry: GeometryTable) -> Iterator[tuple[str, str]]:
    """Keys of a wall that do not fit this geometry, and what is wrong with each."""
    start, end, (left, right) = wall.from_, wall.to, wall.across
    given = {key: getattr(wall, key) is not None for key in ("half_width", "side_from", "side_to")}
    if not _NAME.fullmatch(wall.name) or wall.name in (FLOOR, BACK_WALL, GATE_WALL):
        yield "name", "expected letters, digits and hyphens, and not the name of another wall: floor, back_wall, gate"
    if geometry.base == "elastic":
        yield "from", 'needs a floor that does not move: set geometry.base = "rigid" or "granular"'
    if start < 0.0 and geometry.model != "full":
        yield (
            "from",
            f"from = {start:g} m is outside the domain, which begins at x = 0; only full models extend to less",
        )
    if end is not None and not start < end:
        yield "to", f"from = {start:g} m must be smaller than to = {end:g} m"
    if geometry.dimension == 2 and any(given.values()):
        key = next(key for key, one in given.items() if one)
        yield key, f"{key} has no meaning in two dimensions: remove it"
    if wall.half_width is not None and (given["side_from"] or given["side_to"]):
        yield "half_width", "give half_width, or side_from and side_to"
    if left is not None and right is not None and not left < right:
        yield "side_to", f"side_from = {left:g} m must be smaller than side_to = {right:g} m"
    if geometry.model == "quarter" and wall.half_width is None and left is not None and left < 0.0:
        yield "side_from", f"side_from = {left:g} m is outside the quarter, which begins at z = 0"
    if _overlaps_column(wall, geometry):
        edge = _column_edge(geometry)
        upslope = f", or to < {-edge:g} m" if geometry.model == "full" else ""
        yield "from", f"overlaps the column, which ends at x = {edge:g} m; set from > {edge:g} m{upslope}"


def _overlaps_column(wall: WallTable, geometry: GeometryTable) -> bool:
    x, z = (_nearest(span) for span in (wall.along, wall.across))
    if geometry.dimension == 3 and geometry.section == "cylinder":
        return math.hypot(x, z) < _column_edge(geometry)
    is_beside = geometry.dimension == 3 and z >= (geometry.depth or geometry.r_i)
    return x < _column_edge(geometry) and not is_beside


def _column_edge(geometry: GeometryTable) -> float:
    """Largest distance of the column from x = 0, m; a cylinder on a slope leans to the other side."""
    leans = geometry.dimension == 3 and geometry.section == "cylinder"
    return geometry.r_i + (geometry.lean * geometry.h_i if leans else 0.0)


def _nearest(span: Span) -> float:
    """Distance of a span from zero, m."""
    low, high = _limits(span)
    return max(low, -high, 0.0)


def _overlap(one: Span, other: Span) -> bool:
    (a, b), (c, d) = _limits(one), _limits(other)
    return a < d and c < b


def _limits(span: Span) -> tuple[float, float]:
    return -math.inf if span[0] is None else span[0], math.inf if span[1] is None else span[1]
