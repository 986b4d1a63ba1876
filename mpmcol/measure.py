"""Runout, height and shape of a deposit, from its material points.

Three definitions of the front are always given; their spread is the uncertainty of the front:

* `front_max`: the farthest material point, grains in flight included;
* `front_connected`: the farthest point reached from the pile without a gap wider than one cell;
* `front_height`: where the deposit's height, mass per bin of width h over density, falls below
  max(h / 2, r_i / 100), contiguous from the pile.

A two-sided release is measured on its half model: r_i is then the half-width of the column. In axisymmetry
masses are per radian. Points have the size `point_size`, so a point's edge lies half of it beyond its
position.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FRONTS = ("front_max", "front_connected", "front_height")
WALL_CELLS = 4  # width of the strip in which the height at the wall or axis is taken
UNDISTURBED = 1e-3  # m: a point that moved less since release is undisturbed (the paper's Figure 9)


@dataclass(frozen=True)
class ColumnShape:
    """The column as released: what a deposit is measured against (m, kg/m3)."""

    model: str  # "plane" | "axisymmetric"
    release: str  # "one-sided" | "two-sided"
    r_i: float
    h_i: float
    spacing: float  # grid node spacing h
    density: float  # at release
    point_size: float  # distance between neighbouring points at the start

    @property
    def a(self) -> float:
        """Aspect ratio h_i / r_i."""
        return self.h_i / self.r_i

    def potential_energy(self, gravity: float) -> float:
        """Of the column as released, above the base: J per metre of width, or per radian."""
        width = self.r_i**2 / 2.0 if self.model == "axisymmetric" else self.r_i
        return self.density * gravity * width * self.h_i**2 / 2.0


@dataclass(frozen=True)
class Measurement:
    """A measured deposit: lengths in m; dictionaries have the three front definitions as keys."""

    front: dict[str, float]
    zeta: dict[str, float]  # (front - r_i) / r_i
    spread: float  # max - min of zeta
    height: float  # top of the contiguous pile at the wall or axis, above the base
    beta: float  # height / h_i
    area_factor: float  # plane: V / (r_f h_f) = integral of y* dx*; axisymmetric: V / (pi r_f^2 h_f)
    undisturbed_radius: float | None  # None if no displacement was given
    profile_x: Array  # bin centres
    profile_y: Array  # height of each bin: mass over density and bin area

    def scalars(self) -> dict[str, Any]:
        """All but the profile, as plain numbers, for JSON."""
        return {name: value for name, value in vars(self).items() if not name.startswith("profile")}


def measure(x: Array, mass: Array, displacement: Array | None, shape: ColumnShape) -> Measurement:
    """Measure the deposit that the column's points make.

    Args:
        x: positions, (n, 2) or (n, 3), m; points that are not finite are left out.
        mass: (n,), kg per metre of width, or per radian in axisymmetry.
        displacement: since release, (n, 2) or (n, 3), m, or None.
        shape: the column as released.
    """
    finite = np.isfinite(x).all(axis=1)
    x, mass = x[finite], mass[finite]
    profile_x, profile_y = deposit_profile(x, mass, shape)
    grounded = _grounded(x, shape, shape.spacing)
    front = _fronts(x, grounded, profile_x, profile_y, shape)
    zeta = {name: value / shape.r_i - 1.0 for name, value in front.items()}
    height = _height_at_wall(x, shape)
    still = None if displacement is None else undisturbed_radius(x, displacement[finite], shape)
    return Measurement(
        front=front,
        zeta=zeta,
        spread=max(zeta.values()) - min(zeta.values()),
        height=height,
        beta=height / shape.h_i,
        area_factor=_area_factor(mass, front["front_height"], height, shape),
        undisturbed_radius=still,
        profile_x=profile_x,
        profile_y=profile_y,
    )


def deposit_profile(x: Array, mass: Array, shape: ColumnShape) -> tuple[Array, Array]:
    """Bin centres and depth-integrated height (m) in bins of one cell from the wall or axis outward.

    The height is mass over density and bin area, so that it does not count loosening as material. Each point
    shares its mass linearly between the two nearest bin centres, mirrored at the wall: in sharp bins, points
    that have been drawn apart by a quarter would fall one or two a bin and make the height of a level deposit
    jump by 40 %. The last bin is empty: the profile ends at zero.
    """
    bins = int(_column(x, shape.spacing).max(initial=0)) + 3
    volume = _share(np.abs(x[:, 0]), mass / shape.density, shape.spacing, bins)
    return shape.spacing * (np.arange(bins, dtype=np.float64) + 0.5), volume / _bin_area(bins, shape)


def undisturbed_radius(x: Array, displacement: Array, shape: ColumnShape) -> float:
    """Radius (m) within which no point of the top surface has moved by 1 mm since release; 0 if none."""
    released = x[:, :2] - displacement[:, :2]
    column = _column(released, shape.point_size)
    order = np.lexsort((released[:, 1], column))
    top = order[np.diff(column[order], append=-1) != 0]
    moved = np.linalg.norm(displacement[top], axis=1) >= UNDISTURBED
    still = top[: np.argmax(moved)] if moved.any() else top
    return float(released[still, 0].max() + shape.point_size / 2.0) if still.size else 0.0


def stop_time(time: Array, front: Array, tolerance: float) -> float | None:
    """First of the given times (s) from which on the front stays within `tolerance` (m) of its last position.

    None if that is only the last time, when nothing shows that the front has stopped.
    """
    away = np.flatnonzero(np.abs(front - front[-1:]) > tolerance)
    first = away[-1] + 1 if away.size else 0
    return float(time[first]) if first < len(time) - 1 else None


def _share(distance: Array, volume: Array, spacing: float, bins: int) -> Array:
    """Volume in each bin, every point sharing its own between the two nearest centres, mirrored at zero."""
    position = distance / spacing + 0.5  # the centre of bin i is at i + 1; 0 is the mirror of bin 0
    left = position.astype(np.intp)
    outer = position - left
    shared = np.zeros(bins + 1)
    shared += np.bincount(left, volume * (1.0 - outer), bins + 1)
    shared += np.bincount(left + 1, volume * outer, bins + 1)
    shared[1] += shared[0]
    return shared[1:]


def _bin_area(bins: int, shape: ColumnShape) -> Array:
    """Area of each bin, m or m2 per radian: what the points as released, of unit height, share with it.

    That is h, or r h, but for the first bin in axisymmetry.
    """
    size = shape.point_size
    lattice = size * (np.arange((bins + 1) * round(shape.spacing / size), dtype=np.float64) + 0.5)
    area = size * lattice if shape.model == "axisymmetric" else np.full_like(lattice, size)
    return _share(lattice, area, shape.spacing, bins + 2)[:bins]


def _column(x: Array, width: float) -> NDArray[np.intp]:
    """Index of the vertical column of the given width that each point is in."""
    return np.maximum(np.floor(x[:, 0] / width), 0.0).astype(np.intp)


def _grounded(x: Array, shape: ColumnShape, width: float) -> NDArray[np.bool_]:
    """Points reached from the base upward, within their column of the given width, without a gap over one cell.

    What is left out is in flight: it is neither the top of the pile nor its front. The gap to the base itself
    may be two cells: the kernels of points that flow over the base meet its own, and hold them 1.2 to 1.6 h
    above it.
    """
    column = _column(x, width)
    order = np.lexsort((x[:, 1], column))
    first = np.diff(column[order], prepend=-1) != 0
    bottom = x[order, 1] - shape.point_size / 2.0
    below = np.where(first, shape.spacing, np.roll(bottom, 1) + shape.point_size)
    gap = bottom - below > shape.spacing
    gaps_so_far = np.cumsum(gap)
    gaps_in_columns_before = (gaps_so_far - gap)[first]
    grounded = np.empty(len(x), dtype=bool)
    grounded[order] = gaps_so_far == gaps_in_columns_before[np.cumsum(first) - 1]
    return grounded


def _fronts(
    x: Array, grounded: NDArray[np.bool_], profile_x: Array, profile_y: Array, shape: ColumnShape
) -> dict[str, float]:
    half = shape.point_size / 2.0
    farthest = float(x[:, 0].max() + half) if len(x) else 0.0
    by_height = _front_by_height(profile_x, profile_y, max(0.5 * shape.spacing, 0.01 * shape.r_i))
    fronts = (farthest, _connected_front(x[grounded, 0], shape), min(by_height, farthest))
    return dict(zip(FRONTS, fronts, strict=True))


def _connected_front(x: Array, shape: ColumnShape) -> float:
    """Edge of the last point before the first gap wider than one cell, outward from the median point."""
    if not x.size:
        return 0.0
    ordered = np.sort(x)[(x.size - 1) // 2 :]
    gap = np.diff(ordered, append=np.inf) - shape.point_size > shape.spacing
    return float(ordered[np.argmax(gap)] + shape.point_size / 2.0)


def _front_by_height(profile_x: Array, profile_y: Array, threshold: float) -> float:
    """Where the profile first falls below the threshold outward of its peak, linear between bin centres."""
    peak = int(np.argmax(profile_y))
    if profile_y[peak] < threshold:
        return 0.0
    outer = peak + int(np.argmax(profile_y[peak:] < threshold))
    pair = slice(outer - 1, outer + 1)
    return float(np.interp(-threshold, -profile_y[pair], profile_x[pair]))


def _height_at_wall(x: Array, shape: ColumnShape) -> float:
    """Top of the contiguous pile in the first WALL_CELLS cells: in one cell alone, a crack would cut it short."""
    band = WALL_CELLS * shape.spacing
    pile = x[(x[:, 0] < band) & _grounded(x, shape, band), 1]
    return float(pile.max() + shape.point_size / 2.0) if pile.size else 0.0


def _area_factor(mass: Array, front: float, height: float, shape: ColumnShape) -> float:
    volume = float(mass.sum()) / shape.density
    box = front * height if shape.model == "plane" else front**2 * height / 2.0
    return volume / box if box > 0.0 else 0.0
