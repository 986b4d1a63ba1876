"""A deposit cut into vertical sections and columns: 3D is measured by what measures two dimensions."""

from __future__ import annotations

from math import pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mpmcol.measure.shape import AZIMUTHS, ColumnShape

Array = NDArray[np.float64]

SECTOR = pi / 18.0  # rad: a cylinder's deposit in 3D is measured in each sector of azimuth


class Section(NamedTuple):
    """Points that are measured together, as those of a plane or an axisymmetric model are."""

    x: Array  # positions, (n, 2) or (n, 3), m
    distance: Array  # (n,) from the wall or axis, m
    mass: Array  # (n,) kg per metre of width, or per radian


def cut(x: Array, mass: Array, shape: ColumnShape) -> list[Section]:
    """The sections of a deposit, empty ones too.

    In 2D there is one, the model. A cylinder in 3D has one for each sector of azimuth. A box has its strip
    |z| < depth / 2, one on either side of x = 0 that is modelled: there the flow is the nearest to plane.
    """
    distance, number = locate(x, shape)
    count, width = _sections(shape)
    order = np.argsort(number, kind="stable")
    bounds = np.searchsorted(number[order], np.arange(count + 1))
    rows = [order[bounds[i] : bounds[i + 1]] for i in range(count)]
    return [Section(x[own], distance[own], mass[own] / width) for own in rows]


def locate(x: Array, shape: ColumnShape) -> tuple[Array, NDArray[np.int8]]:
    """Distance (n,) of points from the wall or axis, m, and the number (n,) of their section; -1 for none."""
    if shape.dimension == 2:
        return x[:, 0], np.zeros(len(x), np.int8)
    if shape.has_sectors:
        turned = np.arctan2(x[:, 2], x[:, 0]) - AZIMUTHS[shape.model][0]
        sector = np.clip(turned / SECTOR, 0, _sections(shape)[0] - 1)  # a hair behind a wall is in front of it
        return np.hypot(x[:, 0], x[:, 2]), sector.astype(np.int8)
    side = (x[:, 0] < 0.0) & (shape.sides == 2)
    return np.abs(x[:, 0]), np.where(np.abs(x[:, 2]) < shape.half_depth / 2.0, side, -1).astype(np.int8)


def _sections(shape: ColumnShape) -> tuple[int, float]:
    """Number of sections, and the width that each takes of the model's mass: m, or rad; 1 in 2D."""
    if shape.dimension == 2:
        return 1, 1.0
    if shape.has_sectors:
        return round(shape.angle / SECTOR), SECTOR
    return shape.sides, shape.sides * shape.half_depth / 2.0  # as deep as it has sides: z > 0, or both signs


def columns(x: Array, width: float, shape: ColumnShape) -> NDArray[np.intp]:
    """Index of the vertical column that each point is in: `width` wide, and in 3D as deep."""
    along = np.floor(x[:, 0] / width).astype(np.intp)
    if shape.dimension == 2:
        return np.maximum(along, 0)
    across = np.floor(x[:, 2] / width).astype(np.intp)
    along -= along.min(initial=0)
    across -= across.min(initial=0)
    return along * (across.max(initial=0) + 1) + across


def grounded(y: Array, column: NDArray[np.intp], shape: ColumnShape) -> NDArray[np.bool_]:
    """Points reached from the base upward, within their column, without a gap over one cell.

    What is left out is in flight: it is neither the top of the pile nor its front. The gap to the base itself
    may be two cells: the kernels of points that flow over the base meet its own, and hold them 1.2 to 1.6 h
    above it.
    """
    order = np.lexsort((y, column))
    first = np.diff(column[order], prepend=-1) != 0
    bottom = y[order] - shape.point_size / 2.0
    below = np.where(first, shape.spacing, np.roll(bottom, 1) + shape.point_size)
    gap = bottom - below > shape.spacing
    gaps_so_far = np.cumsum(gap)
    gaps_in_columns_before: NDArray[np.intp] = (gaps_so_far - gap)[first]
    reached = np.empty(len(y), dtype=bool)
    reached[order] = gaps_so_far == gaps_in_columns_before[np.cumsum(first) - 1]
    return reached
