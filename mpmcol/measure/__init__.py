"""Runout, height and shape of a deposit, from its material points.

Three definitions of the front are always given; their spread is the uncertainty of the front:

* `front_max`: the farthest material point, grains in flight included;
* `front_connected`: the farthest point reached from the pile without a gap wider than one cell;
* `front_height`: where the deposit's height, mass per bin of width h over density, falls below
  max(s, r_i / 100), contiguous from the pile; s: a point's size as released, at most h / 2.

A two-sided release is measured on its half model: r_i is then the half-width of the column. In axisymmetry
masses are per radian. Points have the size `point_size`, so a point's edge lies half of it beyond its
position.

In 3D the same is done in each section of the deposit, and given are the mean over the sections, the least and the
largest. A cylinder's sections are sectors of azimuth, 10 degrees wide, with the distance from the axis and the mass per
radian. A box is measured along x, in the strip |z| < depth / 2 and with masses per metre; its sections are the sides
of x = 0 that are modelled.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmcol.measure.front import FRONTS, fronts, pile_height, profiles
from mpmcol.measure.sections import Array, Section, cut
from mpmcol.measure.shape import ColumnShape
from mpmcol.measure.surface import UNDISTURBED, failure_line, undisturbed_radius

__all__ = [
    "FRONTS",
    "UNDISTURBED",
    "Array",
    "ColumnShape",
    "Measurement",
    "deposit_profile",
    "failure_line",
    "measure",
    "stop_time",
    "undisturbed_radius",
]

Range = tuple[float, float]


@dataclass(frozen=True)
class Measurement:
    """A measured deposit: lengths in m; dictionaries have the three front definitions as keys."""

    front: dict[str, float]  # mean over the sections: in 3D around the axis
    zeta: dict[str, float]  # (front - r_i) / r_i
    spread: float  # max - min of zeta
    height: float  # top of the contiguous pile at the wall or axis, above the base
    beta: float  # height / h_i
    area_factor: float  # plane, box: V / (r_f h_f) = integral of y* dx*; cylinder: V / (pi r_f^2 h_f)
    undisturbed_radius: float | None  # None if no displacement was given
    profile_x: Array  # bin centres
    profile_y: Array  # height of each bin: mass over density and bin area; mean over the sections
    front_range: dict[str, Range] | None = None  # least and largest; None in 2D
    zeta_range: dict[str, Range] | None = None

    @property
    def reach(self) -> float:
        """Distance of the farthest point, m."""
        return self.front_range["front_max"][1] if self.front_range else self.front["front_max"]

    def scalars(self) -> dict[str, Any]:
        """All but the profile, as plain numbers, for JSON; where there are ranges, fronts have a mean, min and max."""
        values = {name: value for name, value in vars(self).items() if not name.startswith("profile")}
        for name in ("front", "zeta"):
            if (ranges := values.pop(f"{name}_range")) is not None:
                values[name] = {
                    front: {"mean": mean, "min": ranges[front][0], "max": ranges[front][1]}
                    for front, mean in values[name].items()
                }
        return values


def measure(x: Array, mass: Array, displacement: Array | None, shape: ColumnShape) -> Measurement:
    """Measure the deposit that the column's points make.

    Args:
        x: positions, (n, 2) or (n, 3), m; points that are not finite are left out. In 3D y is up, and the axis is
            x = z = 0.
        mass: (n,), kg; per metre of width in plane strain, per radian in axisymmetry.
        displacement: since release, of the shape of x, m, or None.
        shape: the column as released.
    """
    finite = np.isfinite(x).all(axis=1)
    x, mass = x[finite], mass[finite]
    sections = cut(x, mass, shape)
    profile_x, heights = profiles(sections, shape)
    found = np.array([fronts(own, profile_x, height, shape) for own, height in zip(sections, heights, strict=True)])
    front = dict(zip(FRONTS, found.mean(axis=0).tolist(), strict=True))
    zeta = {name: value / shape.r_i - 1.0 for name, value in front.items()}
    height = pile_height(sections, shape)
    still = None if displacement is None else undisturbed_radius(x, displacement[finite], shape)
    return Measurement(
        front=front,
        zeta=zeta,
        spread=max(zeta.values()) - min(zeta.values()),
        height=height,
        beta=height / shape.h_i,
        area_factor=_area_factor(sections, front["front_height"], height, shape),
        undisturbed_radius=still,
        profile_x=profile_x,
        profile_y=heights.mean(axis=0),
        front_range=_ranges(found, shape),
        zeta_range=_ranges(found / shape.r_i - 1.0, shape),
    )


def deposit_profile(x: Array, mass: Array, shape: ColumnShape) -> tuple[Array, Array]:
    """Bin centres and depth-integrated height (m) in bins of one cell from the wall or axis outward.

    The height is mass over density and bin area, so that it does not count loosening as material; in 3D it is the
    mean over azimuth. Each point shares its mass linearly between the two nearest bin centres, mirrored at the
    wall: in sharp bins, points that have been drawn apart by a quarter would fall one or two a bin and make the
    height of a level deposit jump by 40 %. The last bin is empty: the profile ends at zero.
    """
    profile_x, heights = profiles(cut(x, mass, shape), shape)
    return profile_x, heights.mean(axis=0)


def stop_time(time: Array, front: Array, tolerance: float) -> float | None:
    """First of the given times (s) from which on the front stays within `tolerance` (m) of its last position.

    None if that is only the last time, when nothing shows that the front has stopped.
    """
    away = np.flatnonzero(np.abs(front - front[-1:]) > tolerance)
    first = away[-1] + 1 if away.size else 0
    return float(time[first]) if first < len(time) - 1 else None


def _ranges(found: Array, shape: ColumnShape) -> dict[str, Range] | None:
    """Least and largest of the (sections, 3) values, by front definition; None in two dimensions."""
    if shape.dimension == 2:
        return None
    ends = zip(found.min(axis=0).tolist(), found.max(axis=0).tolist(), strict=True)
    return dict(zip(FRONTS, ends, strict=True))


def _area_factor(sections: list[Section], front: float, height: float, shape: ColumnShape) -> float:
    """Of the mean section."""
    volume = sum(float(own.mass.sum()) for own in sections) / len(sections) / shape.density
    box = front**2 * height / 2.0 if shape.is_round else front * height
    return volume / box if box > 0.0 else 0.0
