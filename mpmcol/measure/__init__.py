"""Runout, height and shape of a deposit, measured on its material points.

The front has three definitions, all of which are always measured. Each locates it to about a cell at best, also where
all three agree:

* `front_max`: the farthest material point, including points in flight;
* `front_connected`: the farthest point that is connected with the pile without a gap wider than one cell;
* `front_height`: where the height of the deposit (mass per bin of width h over density), contiguous from the pile,
  falls below max(s, r_i / 100), with s the initial size of a point, at most h / 2.

Points have the size `point_size`: the edge of a point lies half of it beyond its position. A two-sided release is
measured on its half model, where r_i is the half-width of the column. In axisymmetry masses are per radian.

In 3D every section of the deposit is measured, and the results are the mean, minimum and maximum over the sections.
The sections of a cylinder are sectors of azimuth of 10 degrees, with the distance from the axis and the mass per
radian. A box is measured along x in the strip |z| < depth / 2, with masses per metre; its sections are the modelled
sides of x = 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmcol.measure.erosion import Erosion, Material, measure_erosion, surface_over_bed
from mpmcol.measure.front import FRONTS, fronts, pile_height, profiles
from mpmcol.measure.sections import Array, Section, split
from mpmcol.measure.shape import ColumnShape
from mpmcol.measure.slope import STEEPEST, friction_bias, friction_from_repose, inner_repose_angle, repose_angle
from mpmcol.measure.undisturbed import UNDISTURBED, failure_line, undisturbed_radius

__all__ = [
    "FRONTS",
    "STEEPEST",
    "UNDISTURBED",
    "Array",
    "ColumnShape",
    "Erosion",
    "Material",
    "Measurement",
    "deposit_profile",
    "failure_line",
    "friction_bias",
    "friction_from_repose",
    "fronts_and_height",
    "measure",
    "measure_erosion",
    "repose_angle",
    "stop_time",
    "surface_over_bed",
    "undisturbed_radius",
]

Range = tuple[float, float]


@dataclass(frozen=True)
class Measurement:
    """A measured deposit: lengths in m; dictionaries have the three front definitions as keys."""

    front: dict[str, float]  # mean over the sections
    zeta: dict[str, float]  # (front - r_i) / r_i
    spread: float  # max - min of zeta
    height: float  # top of the contiguous pile at the wall or axis, above the base; of an outline, anywhere
    beta: float  # height / h_i
    area_factor: float  # plane, box: V / (r_f h_f); cylinder: V / (pi r_f^2 h_f)
    repose_angle_deg: float | None  # inclination of the flank to the base, the mean of two; None if of too few cells
    undisturbed_radius: float | None  # None if no displacement was given
    profile_x: Array  # bin centres, (bins,)
    profile_y: Array  # height of each bin, (bins,): mean over the sections
    front_range: dict[str, Range] | None = None  # minimum and maximum over the sections; None in 2D
    zeta_range: dict[str, Range] | None = None
    repose_low_x_deg: float | None = None  # of the flanks toward smaller and larger x, if there are two
    repose_high_x_deg: float | None = None

    @property
    def profile(self) -> tuple[Array, Array]:
        """Bin centres and heights (bins,), m."""
        return self.profile_x, self.profile_y

    @property
    def max_distance(self) -> float:
        """Distance of the farthest point of all sections from the wall or axis, m."""
        return self.front_range["front_max"][1] if self.front_range else self.front["front_max"]

    def scalars(self) -> dict[str, Any]:
        """All values but the profile, for JSON; in 3D each front is a mapping of mean, min and max."""
        values = {name: value for name, value in vars(self).items() if not name.startswith("profile")}
        for name in ("front", "zeta"):
            if (ranges := values.pop(f"{name}_range")) is not None:
                values[name] = {
                    front: {"mean": mean, "min": ranges[front][0], "max": ranges[front][1]}
                    for front, mean in values[name].items()
                }
        return values


def measure(x: Array, mass: Array, displacement: Array | None, shape: ColumnShape) -> Measurement:
    """Measure the deposit of the material points of the column.

    Args:
        x: positions, (n, 2) or (n, 3), m; points with non-finite positions are omitted. y points upward; the axis of
            a 3D column is x = z = 0.
        mass: masses, (n,), kg; per metre of width in plane strain, per radian in axisymmetry.
        displacement: displacements since release, as x, m; None if unknown.
        shape: the column as released.
    """
    finite = np.isfinite(x).all(axis=1)
    x, mass = x[finite], mass[finite]
    sections = split(x, mass, shape)
    profile_x, heights = profiles(sections, shape)
    found = _fronts_of_sections(sections, profile_x, heights, shape)
    profile_y, flanks = heights.mean(axis=0), _two_flanks(profile_x, heights, shape)
    front = _mean_fronts(found)
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
        repose_angle_deg=_mean_angle(flanks, repose_angle(profile_x, profile_y)),
        undisturbed_radius=still,
        profile_x=profile_x,
        profile_y=profile_y,
        front_range=_ranges(found, shape),
        zeta_range=_ranges(found / shape.r_i - 1.0, shape),
        repose_low_x_deg=flanks[0],
        repose_high_x_deg=flanks[1],
    )


def fronts_and_height(x: Array, mass: Array, shape: ColumnShape) -> tuple[dict[str, float], float]:
    """Front by definition and height of the deposit, m, as of `measure` for finite positions, without the rest."""
    sections = split(x, mass, shape)
    return _mean_fronts(_fronts_of_sections(sections, *profiles(sections, shape), shape)), pile_height(sections, shape)


def _fronts_of_sections(sections: Sequence[Section], x: Array, heights: Array, shape: ColumnShape) -> Array:
    """The fronts (sections, 3), m. x: bin centres, (bins,), m; heights: (sections, bins), m."""
    return np.array([fronts(own, x, height, shape) for own, height in zip(sections, heights, strict=True)])


def _mean_fronts(found: Array) -> dict[str, float]:
    return dict(zip(FRONTS, found.mean(axis=0).tolist(), strict=True))


def _two_flanks(x: Array, heights: Array, shape: ColumnShape) -> tuple[float | None, float | None]:
    """Angles of the flanks toward smaller and larger x, degrees; None unless there are two.

    x: bin centres, (bins,), m. heights: (sections, bins), m.
    """
    if shape.is_round:
        return None, None
    if len(heights) == 2:  # a box that spreads to both sides of x = 0
        high, low = (repose_angle(x, height) for height in heights)
    else:
        low, high = inner_repose_angle(x, heights.mean(axis=0)), repose_angle(x, heights.mean(axis=0))
    return (None, None) if low is None or high is None else (low, high)


def _mean_angle(flanks: tuple[float | None, float | None], single: float | None) -> float | None:
    low, high = flanks
    return single if low is None or high is None else (low + high) / 2.0


def deposit_profile(x: Array, mass: Array, shape: ColumnShape) -> tuple[Array, Array]:
    """Height profile of a deposit in bins of one cell from the wall or axis outward.

    The height of a bin is its mass over density and area, so that dilation does not count as material; in 3D it is
    the mean over the sections. The mass of a point is distributed linearly over the two nearest bin centres, with
    reflection at the wall: with sharp bins, a spacing of points stretched by a quarter would change the height of a
    level deposit by 40 % from bin to bin.

    Returns:
        bin centres and heights, (bins,), m; the last bin is empty, so that the profile ends at zero.
    """
    profile_x, heights = profiles(split(x, mass, shape), shape)
    return profile_x, heights.mean(axis=0)


def stop_time(time: Array, front: Array, tolerance: float) -> float | None:
    """Time after which the front stays within `tolerance` (m) of its last position.

    Args:
        time: times, (n,), s.
        front: position of the front, (n,), m.
        tolerance: m.

    Returns:
        the first such time, s; None if it is the last one, since the front may still move, or the first one, since the
        front has then not moved measurably.
    """
    away = np.flatnonzero(np.abs(front - front[-1:]) > tolerance)
    return float(time[away[-1] + 1]) if away.size and away[-1] + 2 < len(time) else None


def _ranges(found: Array, shape: ColumnShape) -> dict[str, Range] | None:
    """Minimum and maximum over the sections of values (sections, 3), by front definition; None in 2D."""
    if shape.dimension == 2:
        return None
    ends = zip(found.min(axis=0).tolist(), found.max(axis=0).tolist(), strict=True)
    return dict(zip(FRONTS, ends, strict=True))


def _area_factor(sections: list[Section], front: float, height: float, shape: ColumnShape) -> float:
    """Area factor of the mean section."""
    volume = sum(float(own.mass.sum()) for own in sections) / len(sections) / shape.density
    box = front**2 * height / 2.0 if shape.is_round else front * height
    return volume / box if box > 0.0 else 0.0
