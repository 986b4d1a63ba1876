"""Discretization of a case: grid spacing fitted to the edges of the material, cells, and lattices of points."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from math import ceil

import numpy as np

from mpmcol.case import Case
from mpmcol.case.geometry import whole_cells
from mpmcol.case.outline import Outline, area
from mpmcol.errors import UnfitCase
from mpmcol.mpm.boundary import AXIS, OPEN_END, Faces
from mpmcol.setup.cut_cells import material_above, point_shares
from mpmcol.setup.domain import domain_size
from mpmcol.setup.geometry import GEOMETRIES, ROUNDING, Geometry, domain_faces, points_per_axis
from mpmcol.setup.unfit_settings import setting_warnings
from mpmcol.setup.wall_boxes import WallBox, place_walls, rounding_warnings
from mpmcol.setup.walls import Wall, recorded_walls
from mpmcol.units import counted

MOST_SHARE = 8.0  # of its cell: largest volume of a point, the end of a slope of 2 degrees


@dataclass(frozen=True)
class Discretization:
    """Lengths (m) and numbers of cells and points; the column stands on y = 0, and the grid starts at -base."""

    shape: str  # name of the geometry
    faces: Faces  # boundary types of the faces of the domain
    walls: tuple[Wall, ...]  # those with friction or recorded forces, in the order of their numbers
    h: float
    r_i: float
    h_i: float
    depth: float  # half-depth of a box; r_i otherwise
    base: float  # thickness of the base, 0 for a rigid floor
    cells_along: int  # from the wall or axis to the end of the domain
    cells_up: int
    points_per_axis: int
    rows: int  # of points over the height of the column
    warnings: tuple[str, ...]
    outline: Outline | None = None  # of a column that is not given by r_i and h_i
    layers: tuple[tuple[float, float], ...] = ()  # heights of the lower and the upper ends of those of the column
    lean: float = 0.0  # distance that the sides of the column lean upslope per height: x + lean y is that at the base
    wall_boxes: tuple[WallBox, ...] = ()  # those of [[walls]]

    @property
    def geometry(self) -> Geometry:
        """Entry of GEOMETRIES."""
        return GEOMETRIES[self.shape]

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return self.geometry.dimension

    @property
    def is_full(self) -> bool:
        """Whether x and z start at -length instead of a wall, axis or plane of symmetry."""
        return self.faces[0][0] == OPEN_END

    @property
    def length(self) -> float:
        """Length of the domain from the wall or axis, m."""
        return self.cells_along * self.h

    @property
    def cells(self) -> tuple[int, ...]:
        """Cells of the grid along x, y and, in three dimensions, z."""
        across = self.cells_along * (2 if self.is_full else 1)
        return (across, self.cells_up, across)[: self.dimension]

    @property
    def origin(self) -> tuple[float, ...]:
        """Position of the first node, m."""
        side = -self.length if self.is_full else 0.0
        return (side, -self.base, side)[: self.dimension]

    @property
    def point_size(self) -> float:
        """Initial distance between points, m."""
        return self.h / self.points_per_axis

    @property
    def row_height(self) -> float:
        """Vertical distance between points of the column, m."""
        return self.h_i / self.rows

    @property
    def lattice_cells(self) -> int:
        """Cells of the lattice of points of a two-dimensional column; an outline does not fill all of them."""
        return round(self.r_i / self.point_size) * self.rows

    @property
    def most_points(self) -> int:
        """Upper bound of the number of points: a round column is counted as the square around it.

        For an outline, the number by its area.
        """
        lengths = (self.length, self.r_i, self.depth, self.base)
        along, wide, deep, below = (round(length / self.point_size) for length in lengths)
        if self.outline is not None:
            return round(area(self.outline) / (self.point_size * self.row_height)) + along * below
        if self.dimension == 2:
            return wide * self.rows + along * below
        return (4 if self.is_full else 1) * (wide * deep * self.rows + along**2 * below)

    def beyond_column(self, position: tuple[np.ndarray, ...], tolerance: float = 0.0) -> tuple[np.ndarray, ...]:
        """For each horizontal axis, where positions are at or beyond the sides of the column (tolerance in m).

        position: x, y and, in three dimensions, z.
        """
        x, y, *z = position
        return self.geometry.beyond((x + self.lean * y, *z), self.r_i - tolerance, self.depth - tolerance)

    def outward(self, x: np.ndarray) -> np.ndarray:
        """Outward normals (n, 3) of the gate at positions x (n, d) at or beyond it."""
        normals = np.zeros((len(x), 3))
        normals[:, ::2][:, : self.dimension - 1] = np.column_stack(
            self.geometry.outward((x[:, 0] + self.lean * x[:, 1], *x[:, 2:].T))
        )
        return normals

    @property
    def gate_length(self) -> float:
        """Length of the gate along the base, m; 1 in plane strain, per radian in axisymmetry."""
        return (4 if self.dimension == 3 and self.is_full else 1) * self.geometry.perimeter(self.r_i, self.depth)

    def in_walls(self, x: np.ndarray) -> np.ndarray:
        """Whether points at x (n, d) are in one of the walls."""
        cells = tuple(np.floor((x - np.array(self.origin)) / self.h).astype(np.intp).T)
        return np.logical_or.reduce([np.zeros(len(x), bool), *(box.contains(cells) for box in self.wall_boxes)])

    def in_end_zone(self, x: np.ndarray) -> np.ndarray:
        """Whether points at x (n, d) are in the zone of held nodes of an open end, or less than a cell from it."""
        limit = self.length - (OPEN_END.zone_cells + 1) * self.h
        return np.asarray(np.abs(x[:, ::2]).max(axis=1) > limit)

    def fall_time(self, gravity: float) -> float:
        """Characteristic time sqrt(h_i / g), s."""
        return math.sqrt(self.h_i / gravity)

    def wave_time(self, wave_speed2: float) -> float:
        """Time in which a wave travels twice up and down through column and base, s."""
        return 4.0 * (self.h_i + self.base) / math.sqrt(wave_speed2)

    def lattice(self, length: float) -> np.ndarray:
        """Horizontal positions (n, d - 1) of a lattice of points up to `length` from the wall or axis, m."""
        count = round(length / self.point_size)
        axis = self.point_size * (np.arange(-count if self.is_full else 0, count) + 0.5)
        axes = np.meshgrid(*[axis] * (self.dimension - 1), indexing="ij")
        return np.stack(axes, axis=-1).reshape(-1, self.dimension - 1)

    def layers_at(self, y: np.ndarray) -> np.ndarray:
        """Number of the layer of the column at heights y (n,), m, from 1; 0 for the column's own material."""
        numbers = np.zeros(y.shape, np.intp)
        for number, (lower, upper) in enumerate(self.layers, 1):
            numbers[(y >= lower) & (y < upper)] = number
        return numbers

    @property
    def row_heights(self) -> np.ndarray:
        """Heights (rows,) of the points of the column, m."""
        return self.row_height * (np.arange(self.rows) + 0.5)

    def column_lattice(self) -> np.ndarray:
        """Positions (n, d) of the points of the column, m; of an outline, of the rectangle around it."""
        leaning = self.lean * self.h_i if self.outline is None else 0.0
        positions = stack(self.lattice(max(self.r_i + leaning, self.depth)), self.row_heights)
        if self.outline is not None:
            return positions
        return positions[~np.logical_or.reduce(self.beyond_column(tuple(positions.T)))]

    def outline_shares(self) -> np.ndarray:
        """Volume of the points of an outline over that of their cells, (n columns, rows); 0 for cells without a point.

        Raises UnfitCase if parts of the outline are too thin for the points.
        """
        assert self.outline is not None
        x_lines = self.point_size * np.arange(round(self.r_i / self.point_size) + 1)
        y_lines = self.row_height * np.arange(self.rows + 1)
        per_radian, layers = self.faces[0][0] == AXIS, self.layers_at(self.row_heights)
        shares = point_shares(self.outline, x_lines, y_lines, per_radian, layers)
        if not 0.0 < shares.max() <= MOST_SHARE:
            raise UnfitCase(
                "geometry.outline",
                f"geometry.outline is thinner than half the distance between points, {self.point_size:.4g} m, over a "
                "length of many points",
                "decrease grid.spacing, or omit its thin parts",
            )
        return shares

    def material_above(self, horizontal: tuple[np.ndarray, ...], y: np.ndarray) -> np.ndarray:
        """Height of the material of the column above positions, m; on and below the base all of it."""
        if self.outline is not None:
            return material_above(self.outline, horizontal[0], np.maximum(y, 0.0))
        beyond = np.logical_or.reduce(self.beyond_column((horizontal[0], y, *horizontal[1:])))
        return np.where(beyond, 0.0, self.h_i - np.maximum(y, 0.0))


def discretize(case: Case) -> Discretization:
    """Fit the grid to the column: r_i, base and depth become whole numbers of cells, r_i by changing the spacing.

    The height need not be a whole number of cells: its points are spread evenly. Raises UnfitCase if the given size of
    the domain is too small.
    """
    geometry, warnings = case.geometry, []
    columns, h = whole_cells(geometry.r_i, case.grid.spacing), geometry.fitted_spacing(case.grid.spacing)
    if abs(h / case.grid.spacing - 1.0) > ROUNDING:
        warnings.append(
            f"grid.spacing became {h:.6g} m ({h / case.grid.spacing - 1.0:+.2%}) "
            f"so that the radius of {geometry.r_i:g} m is {counted(columns, 'whole cell')}"
        )
    base = 0.0 if geometry.base == "rigid" else _whole_cells("base_thickness", geometry.base_thickness, h, warnings)
    depth = geometry.r_i if geometry.depth is None else _whole_cells("depth", geometry.depth, h, warnings)
    warnings += setting_warnings(case, h)
    length, height = domain_size(case, h)
    per_axis = points_per_axis(case)
    empty = Discretization(
        shape=geometry.shape,
        faces=domain_faces(case),
        walls=recorded_walls(case),
        h=h,
        r_i=geometry.r_i,
        h_i=geometry.h_i,
        depth=depth,
        base=base,
        cells_along=ceil(length / h - 1e-9),
        cells_up=round(base / h) + ceil(height / h - 1e-9),
        points_per_axis=per_axis,
        rows=max(round(geometry.h_i / h * per_axis), 1),
        warnings=tuple(warnings),
        outline=geometry.polygon,
        layers=tuple((layer.from_, layer.to) for layer in case.layers),
        lean=geometry.lean,
    )
    boxes = place_walls(case, h, empty.origin, empty.cells)
    return replace(empty, wall_boxes=boxes, warnings=(*warnings, *rounding_warnings(case, boxes, h, empty.origin)))


def stack(horizontal: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Positions (n, d) at all heights `y` over all horizontal positions (n, d - 1)."""
    x = np.repeat(horizontal, len(y), axis=0)
    return np.insert(x, 1, np.tile(y, len(horizontal)), axis=1)


def require_thick_outline(discretization: Discretization) -> None:
    """Raise UnfitCase if parts of an outline are too thin for the points, as `build_model` does."""
    if discretization.outline is not None:
        discretization.outline_shares()


def _whole_cells(key: str, length: float, h: float, warnings: list[str]) -> float:
    """A length rounded to whole cells, m; appends a warning if that changes it."""
    cells = whole_cells(length, h)
    if abs(cells * h / length - 1.0) > ROUNDING:
        warnings.append(
            f"geometry.{key} became {cells * h:.6g} m ({cells * h / length - 1.0:+.2%}), {counted(cells, 'whole cell')}"
        )
    return cells * h
