"""Height profiles and fronts of the sections of a deposit, and the height of the pile."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from mpmcol.measure.sections import SECTOR, Array, Section, column_index, connected_to_base
from mpmcol.measure.shape import ColumnShape

FRONTS = ("front_max", "front_connected", "front_height")
WALL_CELLS = 4  # width of the strip at the wall or axis in which the height is measured
SAMPLES_PER_CELL = 32  # for the area of a bin in 3D, where the points of a lattice have many different radii


def profiles(sections: Sequence[Section], shape: ColumnShape) -> tuple[Array, Array]:
    """Bin centres (bins,) and heights (sections, bins), m; see `mpmcol.measure.deposit_profile`.

    Where a sector of azimuth is narrower than a cell, the mean over all sectors is used, since a sector holds too few
    points.
    """
    bins = int(max(section.distance.max(initial=0.0) for section in sections) / shape.spacing) + 3
    volume = [_distribute(np.abs(own.distance), own.mass / shape.density, shape.spacing, bins) for own in sections]
    centre = shape.spacing * (np.arange(bins, dtype=np.float64) + 0.5)
    height = np.array(volume) / _bin_area(bins, shape)
    if shape.has_sectors:
        narrow = centre * SECTOR < shape.spacing
        height[:, narrow] = height[:, narrow].mean(axis=0)
    return centre, height


def fronts(section: Section, profile_x: Array, profile_y: Array, shape: ColumnShape) -> tuple[float, float, float]:
    """The fronts of a section in the order of FRONTS, m; 0 for a section without points."""
    half = shape.point_size / 2.0
    farthest = float(section.distance.max() + half) if len(section.distance) else 0.0
    column = np.maximum(np.floor(section.distance / shape.spacing), 0.0).astype(np.intp)
    pile = connected_to_base(section.x[:, 1], column, shape)
    by_height = front_by_height(profile_x, profile_y, shape)
    return farthest, _connected_front(section.distance[pile], shape), min(by_height, farthest)


def pile_height(sections: Sequence[Section], shape: ColumnShape) -> float:
    """Top of the contiguous pile within WALL_CELLS cells of the wall or axis, m; of an outline, anywhere.

    The strip is several cells wide, since a crack could interrupt the pile in a single cell. In 3D the pile must be
    contiguous within vertical columns of 2 by 2 cells; otherwise points in flight at different azimuths would close
    each other's gaps.
    """
    reach = WALL_CELLS * shape.spacing if shape.outline is None else np.inf
    near = np.concatenate([section.x[section.distance < reach] for section in sections])
    width = shape.spacing * WALL_CELLS ** (1.0 / (shape.dimension - 1))
    pile = near[connected_to_base(near[:, 1], column_index(near, width, shape), shape), 1]
    return float(pile.max() + shape.point_size / 2.0) if pile.size else 0.0


def _distribute(distance: Array, volume: Array, spacing: float, bins: int) -> Array:
    """Volume of each bin: that of a point is distributed over the two nearest centres, with reflection at zero."""
    position = distance / spacing + 0.5  # the centre of bin i is at i + 1; 0 is the mirror of bin 0
    left = position.astype(np.intp)
    outer = position - left
    shared = np.zeros(bins + 1)
    shared += np.bincount(left, volume * (1.0 - outer), bins + 1)
    shared += np.bincount(left + 1, volume * outer, bins + 1)
    shared[1] += shared[0]
    return shared[1:]


def _bin_area(bins: int, shape: ColumnShape) -> Array:
    """Area of each bin, m or m2 per radian: that of the initial lattice of points, distributed as their volume.

    It equals h, or r h, except for the first bin of a cylinder.
    """
    size = shape.point_size if shape.dimension == 2 else shape.spacing / SAMPLES_PER_CELL
    return _lattice_area(bins, size, shape.spacing, shape.is_round)


@lru_cache(maxsize=64)  # the history of a run has hundreds of profiles
def _lattice_area(bins: int, size: float, spacing: float, is_round: bool) -> Array:
    lattice = size * (np.arange((bins + 1) * round(spacing / size), dtype=np.float64) + 0.5)
    area = size * lattice if is_round else np.full_like(lattice, size)
    shared = _distribute(lattice, area, spacing, bins + 2)[:bins]
    shared.setflags(write=False)
    return shared


def _connected_front(distance: Array, shape: ColumnShape) -> float:
    """Edge of the last point before the first gap wider than one cell, outward from the median point, m."""
    if not distance.size:
        return 0.0
    ordered = np.sort(distance)[(distance.size - 1) // 2 :]
    gaps = np.flatnonzero(ordered[1:] - ordered[:-1] - shape.point_size > shape.spacing)
    last = gaps[0] if gaps.size else -1
    return float(ordered[last] + shape.point_size / 2.0)


def front_by_height(profile_x: Array, profile_y: Array, shape: ColumnShape) -> float:
    """Position outward of the peak where the profile first falls below a threshold, linear between bins, m."""
    layer = min(shape.point_size, 0.5 * shape.spacing)  # one layer of points, the resolution limit
    threshold = max(layer, 0.01 * shape.r_i)
    peak = int(np.argmax(profile_y))
    if profile_y[peak] < threshold:
        return 0.0
    outer = peak + int(np.argmax(profile_y[peak:] < threshold))
    pair = slice(outer - 1, outer + 1)
    return float(np.interp(-threshold, -profile_y[pair], profile_x[pair]))
