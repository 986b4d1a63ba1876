"""Walls that stand in the domain: boxes of whole cells, and the boundaries on their faces."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import reduce
from itertools import combinations

import numpy as np

from mpmcol.case import Case
from mpmcol.case.walls import LEAST_CELLS, THICKER, Span, WallTable, too_thin
from mpmcol.errors import UnfitCase
from mpmcol.mpm.boundary import CONTACT, WALL_INSIDE, Boundary
from mpmcol.mpm.grid import Grid, grid_shape
from mpmcol.setup.geometry import ROUNDING, VERTICAL
from mpmcol.units import counted

KEYS = ("from to", "height", "half_width side_from side_to")  # of a wall, along x, y and z


@dataclass(frozen=True)
class WallBox:
    """A wall from node `low` to node `high` (indices along each axis); it stands on the bottom of the grid."""

    name: str
    low: tuple[int, ...]
    high: tuple[int, ...]

    def contains(self, cells: tuple[np.ndarray, ...]) -> np.ndarray:
        """Whether cells, given by their indices along each axis, are in the wall."""
        return _within(self.low, cells, [last - 1 for last in self.high])


def _within(low: Sequence[int], indices: Sequence[np.ndarray], high: Sequence[int]) -> np.ndarray:
    """Where indices along each axis, which broadcast to a grid, are from `low` to `high` inclusive."""
    along = ((first <= i) & (i <= last) for first, i, last in zip(low, indices, high, strict=True))
    return reduce(np.logical_and, along)


def place_walls(case: Case, h: float, first: tuple[float, ...], cells: tuple[int, ...]) -> tuple[WallBox, ...]:
    """The walls of a case in a grid of `cells` cells of size h (m) whose first node is at `first` (m).

    Raises UnfitCase if one is too thin, ends outside the domain, or is too close to another one.
    """
    boxes = tuple(
        _place(f"walls.{i}", wall, _spans(wall, case.geometry.model), h, first, cells)
        for i, wall in enumerate(case.walls)
    )
    for one, other in combinations(boxes, 2):
        gaps = [max(a - d, c - b) for a, b, c, d in zip(one.low, one.high, other.low, other.high, strict=True)]
        if max(gaps) < LEAST_CELLS:
            raise UnfitCase(
                f"walls.{boxes.index(other)}",
                f"walls {one.name} and {other.name} are {counted(max(max(gaps), 0), 'cell')} of {h:.4g} m apart, "
                f"expected at least {LEAST_CELLS}",
                "move one of them, or decrease grid.spacing",
            )
    return boxes


def _place(
    key: str, wall: WallTable, spans: tuple[Span, ...], h: float, first: tuple[float, ...], cells: tuple[int, ...]
) -> WallBox:
    low, high = [], []
    for (start, end), x, n, keys in zip(spans, first, cells, KEYS, strict=False):
        low.append(0 if start is None else round((start - x) / h))
        high.append(n if end is None else round((end - x) / h))
        bottom = round(-x / h) if keys == KEYS[VERTICAL] else low[-1]  # the height is that above the base
        given = f"wall {wall.name}: {_values(wall, keys)}"
        if not 0 <= low[-1] <= high[-1] <= n:
            raise UnfitCase(
                key,
                f"{given}: outside the domain, which is from {x:.4g} to {x + n * h:.4g} m",
                "move the wall, or enlarge the domain by geometry.domain_length or geometry.domain_height",
            )
        if (thickness := high[-1] - bottom) < LEAST_CELLS:
            raise UnfitCase(key, f"{given}: {too_thin(thickness, h)}", THICKER)
    return WallBox(wall.name, tuple(low), tuple(high))


def _spans(wall: WallTable, model: str) -> tuple[Span, ...]:
    """Where a wall is along x, y and z, m; None at the ends of the domain."""
    across = (None, wall.across[1]) if model == "quarter" and wall.half_width is not None else wall.across
    return wall.along, (None, wall.height), across


def _values(wall: WallTable, keys: str) -> str:
    """Keys of a wall that are given, with their values."""
    values = wall.model_dump(by_alias=True)
    return ", ".join(f"{key} = {values[key]:g} m" for key in keys.split() if values[key] is not None)


def rounding_warnings(case: Case, boxes: tuple[WallBox, ...], h: float, first: tuple[float, ...]) -> Iterator[str]:
    """A warning for each edge that is not where the case has it."""
    for wall, box in zip(case.walls, boxes, strict=True):
        low, high = ([x + h * i for x, i in zip(first, nodes, strict=True)] for nodes in (box.low, box.high))
        lengths = {"from": (wall.from_, low[0]), "to": (wall.to, high[0]), "height": (wall.height, high[VERTICAL])}
        lengths |= {"half_width": (wall.half_width, high[-1])}
        lengths |= {"side_from": (wall.side_from, low[-1]), "side_to": (wall.side_to, high[-1])}
        for key, (given, used) in lengths.items():
            if given is not None and abs(used - given) > ROUNDING * max(abs(given), h):
                yield f"wall {wall.name}: {key} became {used:.6g} m ({used - given:+.3g} m), on a node of the grid"


def cells_in_walls(grid: Grid, boxes: tuple[WallBox, ...]) -> np.ndarray:
    """Which cells of the grid are in a wall, boolean (n_x - 1, n_y - 1[, n_z - 1])."""
    cells = tuple(np.indices([n - 1 for n in grid_shape(grid)], sparse=True))
    return np.logical_or.reduce([box.contains(cells) for box in boxes])


def nodes_of_walls(grid: Grid, boxes: tuple[WallBox, ...]) -> np.ndarray:
    """Which nodes of the grid are on or in a wall, boolean (n_x, n_y[, n_z])."""
    nodes, found = tuple(np.indices(grid_shape(grid), sparse=True)), np.zeros(grid_shape(grid), bool)
    for box in boxes:
        found |= _within(box.low, nodes, box.high)
    return found


def wall_boundaries(grid: Grid, box: WallBox) -> Iterator[Boundary]:
    """The faces of a wall, each with its edges, and its nodes inside. Faces on the ends of the domain are omitted.

    Nodes inside have the number of the wall along all axes.
    """
    shape = grid_shape(grid)
    nodes = tuple(np.indices(shape, sparse=True))
    on_box = inside = _within(box.low, nodes, box.high)
    for axis, (a, i, b, n) in enumerate(zip(box.low, nodes, box.high, shape, strict=True)):
        for side, end, is_open in ((1, a, a > 0), (0, b, b < n - 1)):
            if is_open:
                yield Boundary(CONTACT, axis, on_box & (i == end), side)
                inside = inside & (i != end)
    for axis in range(len(shape)):
        yield Boundary(WALL_INSIDE, axis, inside)
