"""Lengths of a model: grid spacing and material edges fitted to each other, and a domain that holds the runout."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from math import ceil

import numpy as np

from mpmcol.case import Case
from mpmcol.errors import UsageError
from mpmcol.experiments import expected_runout
from mpmcol.measure import ColumnShape
from mpmcol.mpm.grid import NODE
from mpmcol.setup.geometries import GEOMETRIES
from mpmcol.setup.time_step import points_per_axis, time_step_warnings

RUNOUT_MARGIN = 0.5  # r_i beyond the farthest-running experiment
EMPTY_FACTOR = 2.0  # on the runout over a rigid base, where the empty part of the domain costs nothing
USUAL_FRICTION, LEAST_FRICTION = 33.0, 10.0  # degrees: of the experiments' sand; below, domains grow no more
HEADROOM_CELLS = 6
END_CELLS = 4  # nodes this near to an open end hold what comes: far enough from it for the support of every basis
SOFT = 0.01  # weight over stiffness from which on a unit is probably wrong
# its record and that of the last good state, sorting, its share of the nodes that are touched, and what is copied while
# a snapshot is written
BYTES_PER_POINT = {2: 800, 3: 1060}
BYTES_PER_NODE = 5  # masks, and what they are made from
ROUNDING_WORTH_A_WARNING = 1e-9


@dataclass(frozen=True)
class Discretization:
    """Lengths in m; the column stands on y = 0 and the grid starts at -base."""

    shape: str  # name of the geometry
    is_full: bool  # whether x and z begin at -length instead of a wall, axis or plane of symmetry
    h: float
    r_i: float
    h_i: float
    depth: float  # half-depth of a box, r_i otherwise
    base: float  # thickness of the base, 0 for a rigid floor
    cells_along: int  # from the wall or axis to the end of the domain
    cells_up: int
    points_per_axis: int
    rows: int  # of points over the height of the column
    warnings: tuple[str, ...]

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return int(GEOMETRIES[self.shape].DIMENSION)

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
        """Where the grid begins, m."""
        side = -self.length if self.is_full else 0.0
        return (side, -self.base, side)[: self.dimension]

    def is_held(self, x: np.ndarray) -> np.ndarray:
        """Which of the points at x (n, d) are so near to an open end of the domain that it holds them."""
        return np.asarray(np.abs(x[:, ::2]).max(axis=1) > self.length - (END_CELLS + 1) * self.h)

    def fall_time(self, gravity: float) -> float:
        """tau = sqrt(h_i / g), s."""
        return math.sqrt(self.h_i / gravity)

    def wave_time(self, wave_speed2: float) -> float:
        """Time that a wave takes twice up and down through column and base, s."""
        return 4.0 * (self.h_i + self.base) / math.sqrt(wave_speed2)

    def section(self, length: float) -> np.ndarray:
        """Horizontal positions (n, d - 1) of a lattice of points as long as `length` from wall or axis, m."""
        count = round(length / self.point_size)
        axis = self.point_size * (np.arange(-count if self.is_full else 0, count) + 0.5)
        return np.stack(np.meshgrid(*[axis] * (self.dimension - 1), indexing="ij"), axis=-1).reshape(
            -1, self.dimension - 1
        )

    def column_section(self) -> np.ndarray:
        """Horizontal positions (n, d - 1) of the column's points, m."""
        places = self.section(max(self.r_i, self.depth))
        gate = GEOMETRIES[self.shape].gate(tuple(places.T), self.r_i, self.depth)
        return places[~np.logical_or.reduce(gate)]

    @property
    def most_points(self) -> int:
        """Number of material points of column and base, as if a round column filled the square around it."""
        lengths = (self.length, self.r_i, self.depth, self.base)
        along, wide, deep, below = (round(length / self.point_size) for length in lengths)
        if self.dimension == 2:
            return wide * self.rows + along * below
        return (4 if self.is_full else 1) * (wide * deep * self.rows + along**2 * below)

    @property
    def memory_bytes(self) -> int:
        """Memory that the arrays take, bytes; of the grid's nodes only those near material are ever touched."""
        return self.most_points * BYTES_PER_POINT[self.dimension] + math.prod(self.cells) * BYTES_PER_NODE

    @property
    def grid_bytes(self) -> int:
        """Size of the whole array of nodes, bytes: not every system promises more than it has."""
        return math.prod(self.cells) * NODE * 8

    @property
    def point_size(self) -> float:
        """Initial distance between points, m."""
        return self.h / self.points_per_axis


def discretize(case: Case) -> Discretization:
    """Fit the grid to the column: the spacing so that the radius is whole cells, base and depth to whole cells.

    The height needs no whole cells: its points are spread evenly. Raises UsageError if the domain is too small.
    """
    geometry, warnings = case.geometry, []
    columns = max(round(geometry.r_i / case.grid.spacing), 1)
    h = geometry.r_i / columns
    if abs(h / case.grid.spacing - 1.0) > ROUNDING_WORTH_A_WARNING:
        warnings.append(
            f"grid.spacing became {h:.6g} m ({h / case.grid.spacing - 1.0:+.2%}) "
            f"so that the radius of {geometry.r_i:g} m is {columns} whole cells"
        )
    base = 0.0 if geometry.base == "rigid" else _whole_cells("base_thickness", geometry.base_thickness, h, warnings)
    depth = geometry.r_i if geometry.depth is None else _whole_cells("depth", geometry.depth, h, warnings)
    shortening = case.material.density * geometry.gravity * geometry.h_i / case.material.youngs_modulus
    if shortening > SOFT:
        warnings.append(
            f"the column will shorten by about {shortening:.1%} under its own weight: "
            "are material.youngs_modulus and material.density in Pa and kg/m3?"
        )
    warnings += time_step_warnings(case)
    length, height = _domain(case, h)
    per_axis = points_per_axis(case)
    return Discretization(
        shape=geometry.shape,
        is_full=geometry.model == "full",
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
    )


def _whole_cells(key: str, asked: float, h: float, warnings: list[str]) -> float:
    """A length rounded to cells, m, with a warning that says by how much."""
    cells = max(round(asked / h), 1)
    if abs(cells * h / asked - 1.0) > 1e-6:
        warnings.append(
            f"geometry.{key} became {cells * h:.6g} m ({cells * h / asked - 1.0:+.2%}), {cells} whole cells"
        )
    return cells * h


def require_memory_for(discretization: Discretization) -> None:
    """Raise UsageError if the arrays cannot fit into the memory of this machine."""
    what = f"{discretization.most_points:,} points and {' x '.join(f'{n:,}' for n in discretization.cells)} cells"
    remedy = "make grid.spacing larger, or is a length in mm instead of m?"
    require_memory(max(discretization.memory_bytes, discretization.grid_bytes), what, remedy)


def require_memory(needed: int, what: str, remedy: str) -> None:
    """Raise UsageError, with what takes it and how to mend that, if so many bytes are more than this machine has."""
    memory = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    if needed > memory:
        raise UsageError(f"{what} need {needed / 1e9:,.0f} GB, this machine has {memory / 1e9:,.0f} GB; {remedy}")


def _domain(case: Case, h: float) -> tuple[float, float]:
    """Length and height of the domain above the base, m: as asked for, or from the expected runout."""
    geometry = case.geometry
    runout = expected_runout(geometry.model, geometry.a, geometry.section) * _slipperiness(case)
    runout *= EMPTY_FACTOR if geometry.base == "rigid" else 1.0
    widest = max(geometry.r_i, geometry.depth or 0.0)
    length = geometry.domain_length or widest + geometry.r_i * (runout + RUNOUT_MARGIN) + END_CELLS * h
    height = geometry.domain_height or geometry.h_i + HEADROOM_CELLS * h
    for key, given, least in (
        ("domain_length", length, widest + (END_CELLS + 1) * h),
        ("domain_height", height, geometry.h_i + (END_CELLS + 1) * h),
    ):
        if given < least:
            raise UsageError(
                f"geometry.{key} = {given:g} m is too small for the column: at least {least:g} m are needed; "
                "make it larger, or leave it out to have the domain sized from the expected runout"
            )
    return length, height


def _slipperiness(case: Case) -> float:
    """How much farther than the experiments' sand a material runs, about: as its friction is lower, of what has one."""
    material = case.material
    friction = getattr(material, "friction_residual_deg", getattr(material, "friction_deg", USUAL_FRICTION))
    return max(math.tan(math.radians(USUAL_FRICTION)) / math.tan(math.radians(max(friction, LEAST_FRICTION))), 1.0)


def column_shape(case: Case, discretization: Discretization) -> ColumnShape:
    """What a deposit of this model is measured against."""
    return ColumnShape(
        model=case.geometry.model,
        release=case.geometry.release,
        r_i=discretization.r_i,
        h_i=discretization.h_i,
        spacing=discretization.h,
        density=case.material.density,
        point_size=discretization.point_size,
        section=case.geometry.section,
        depth=discretization.depth,
    )
