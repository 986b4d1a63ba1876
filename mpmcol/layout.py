"""Lengths of a scene: grid spacing and material edges fitted to each other, and a domain that holds the runout."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from math import ceil, isqrt

from mpmcol.case import Case
from mpmcol.errors import UsageError
from mpmcol.experiments import expected_runout
from mpmcol.measure import ColumnShape

RUNOUT_MARGIN = 0.5  # r_i beyond the farthest-running experiment
EMPTY_FACTOR = 2.0  # on the runout over a rigid base, where the empty part of the domain costs nothing
HEADROOM_CELLS = 6
END_CELLS = 3  # kept free before the open ends, where material stops the run
SOFT = 0.01  # weight over stiffness from which on a unit is probably wrong
BYTES_PER_POINT = 450  # two copies of its record, sorting, and its share of touched nodes
BYTES_PER_NODE = 50  # masks, and the coordinates from which they are made
ROUNDING_WORTH_A_WARNING = 1e-9


@dataclass(frozen=True)
class Layout:
    """Lengths in m; the column stands on y = 0 and the grid starts at -base."""

    h: float
    r_i: float
    h_i: float
    base: float  # thickness of the base, 0 for a rigid floor
    cells_x: int
    cells_y: int
    points_per_axis: int
    rows: int  # of points over the height of the column
    warnings: tuple[str, ...]

    @property
    def length(self) -> float:
        """Length of the domain, m."""
        return self.cells_x * self.h

    def fall_time(self, gravity: float) -> float:
        """tau = sqrt(h_i / g), s."""
        return math.sqrt(self.h_i / gravity)

    def wave_time(self, wave_speed2: float) -> float:
        """Time that a wave takes twice up and down through column and base, s."""
        return 4.0 * (self.h_i + self.base) / math.sqrt(wave_speed2)

    @property
    def points(self) -> int:
        """Number of material points of column and base."""
        along, below = round(self.length / self.point_size), round(self.base / self.point_size)
        return round(self.r_i / self.point_size) * self.rows + along * below

    @property
    def memory_bytes(self) -> int:
        """Memory that the arrays take, bytes; of the grid's nodes only those near material are ever touched."""
        return self.points * BYTES_PER_POINT + self.cells_x * self.cells_y * BYTES_PER_NODE

    @property
    def point_size(self) -> float:
        """Initial distance between points, m."""
        return self.h / self.points_per_axis


def make_layout(case: Case) -> Layout:
    """Fit the grid to the column: the spacing so that the radius is whole cells, the base to whole cells.

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
    layers = 0 if geometry.base == "rigid" else max(round(geometry.base_thickness / h), 1)
    if layers and abs(layers * h / geometry.base_thickness - 1.0) > 1e-6:
        warnings.append(
            f"geometry.base_thickness became {layers * h:.6g} m ({layers * h / geometry.base_thickness - 1.0:+.2%}), "
            f"{layers} whole cells"
        )
    per_axis = isqrt(case.grid.points_per_cell)
    shortening = case.material.density * geometry.gravity * geometry.h_i / case.material.youngs_modulus
    if shortening > SOFT:
        warnings.append(
            f"the column will shorten by about {shortening:.1%} under its own weight: "
            "are material.youngs_modulus and material.density in Pa and kg/m3?"
        )
    length, height = _domain(case, h)
    return Layout(
        h=h,
        r_i=geometry.r_i,
        h_i=geometry.h_i,
        base=layers * h,
        cells_x=ceil(length / h - 1e-9),
        cells_y=layers + ceil(height / h - 1e-9),
        points_per_axis=per_axis,
        rows=max(round(geometry.h_i / h * per_axis), 1),
        warnings=tuple(warnings),
    )


def refuse_if_too_large(layout: Layout) -> None:
    """Raise UsageError if the arrays cannot fit into the memory of this machine."""
    memory = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    if layout.memory_bytes > memory:
        raise UsageError(
            f"{layout.points:,} points and {layout.cells_x:,} x {layout.cells_y:,} cells need "
            f"{layout.memory_bytes / 1e9:,.0f} GB, this machine has {memory / 1e9:,.0f} GB; "
            "make grid.spacing larger, or is a length in mm instead of m?"
        )


def _domain(case: Case, h: float) -> tuple[float, float]:
    """Length and height of the domain above the base, m: as asked for, or from the expected runout."""
    geometry = case.geometry
    runout = expected_runout(geometry.model, geometry.a) * (EMPTY_FACTOR if geometry.base == "rigid" else 1.0)
    length = geometry.domain_length or geometry.r_i * (1.0 + runout + RUNOUT_MARGIN) + END_CELLS * h
    height = geometry.domain_height or geometry.h_i + HEADROOM_CELLS * h
    for key, given, least in (
        ("domain_length", length, geometry.r_i + (END_CELLS + 1) * h),
        ("domain_height", height, geometry.h_i + (END_CELLS + 1) * h),
    ):
        if given < least:
            raise UsageError(
                f"geometry.{key} = {given:g} m is too small for the column: at least {least:g} m are needed; "
                "make it larger, or leave it out to have the domain sized from the expected runout"
            )
    return length, height


def column_shape(case: Case, layout: Layout) -> ColumnShape:
    """What a deposit of this scene is measured against."""
    return ColumnShape(
        model=case.geometry.model,
        release=case.geometry.release,
        r_i=layout.r_i,
        h_i=layout.h_i,
        spacing=layout.h,
        density=case.material.density,
        point_size=layout.point_size,
    )
