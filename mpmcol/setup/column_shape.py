"""The initial column as the measurements need it."""

from __future__ import annotations

from collections.abc import Iterator

from mpmcol.case import Case
from mpmcol.measure import ColumnShape
from mpmcol.measure.shape import Layer, Obstacle
from mpmcol.setup.discretization import Discretization


def column_shape(case: Case, discretization: Discretization) -> ColumnShape:
    """The column that deposits of a case are measured against."""
    return ColumnShape(
        model=case.geometry.model,
        release=case.geometry.release,
        r_i=discretization.r_i,
        h_i=discretization.h_i,
        spacing=discretization.h,
        density=case.material.density,
        point_size=discretization.point_size,
        section=case.geometry.column_section,
        depth=discretization.depth,
        layers=tuple(Layer(layer.from_, layer.to, layer.material.density) for layer in case.layers),
        slope_deg=case.geometry.slope_deg,
        outline=None if case.geometry.is_rectangle else case.geometry.polygon,
        lean=case.geometry.lean,
        gate=case.stages.gate,
        obstacles=tuple(obstacles(discretization)),
        bed=discretization.base,
        bed_density=case.base_material.density if case.geometry.base == "granular" else None,
    )


def obstacles(discretization: Discretization) -> Iterator[Obstacle]:
    """The walls of [[walls]] as they are in the grid."""
    h, (x, y, *_) = discretization.h, discretization.origin
    for box in discretization.wall_boxes:
        yield Obstacle(x + h * box.low[0], x + h * box.high[0], y + h * box.high[1])
