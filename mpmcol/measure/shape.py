"""The column as released, and the part of it that each model represents."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, pi, radians, sqrt

import numpy as np
from numpy.typing import NDArray

AZIMUTHS = {"quarter": (0.0, pi / 2.0), "full": (-pi, pi)}  # range of azimuth of the 3D models, rad


@dataclass(frozen=True)
class Layer:
    """A layer of the column as released: heights of its ends above the base (m) and density (kg/m3)."""

    lower: float
    upper: float
    density: float


@dataclass(frozen=True)
class Obstacle:
    """A wall that stands in the domain, in the plane of x and y: its faces and its height above the base, m."""

    low_x: float
    high_x: float
    height: float


@dataclass(frozen=True)
class ColumnShape:
    """The column as released, the reference of all measurements (m, kg/m3)."""

    model: str  # "plane" | "axisymmetric" | "quarter" | "full"
    release: str  # "one-sided" | "two-sided"
    r_i: float  # width, radius, or half-width in x of a box
    h_i: float
    spacing: float  # grid node spacing h
    density: float  # at release, of the column without its layers
    point_size: float  # distance between neighbouring points at the start
    section: str = "cylinder"  # of a 3D column: "cylinder" | "box"; "outline" of a 2D column that is no rectangle
    depth: float | None = None  # half-depth of a box in z; r_i if None
    layers: tuple[Layer, ...] = ()  # of the column
    slope_deg: float = 0.0  # inclination of the base, downward along x, degrees
    outline: tuple[tuple[float, float], ...] | None = None  # counterclockwise, m; None for a rectangle
    gate: bool = True  # whether a gate at r_i held the column
    lean: float = 0.0  # distance that its sides lean upslope per height; 0 if they are normal to the base
    obstacles: tuple[Obstacle, ...] = ()  # walls in the way of the flow
    bed: float = 0.0  # thickness of the granular or elastic base; 0 for a rigid floor
    bed_density: float | None = None  # of a granular bed; None for any other base

    @property
    def a(self) -> float:
        """Aspect ratio h_i / r_i."""
        return self.h_i / self.r_i

    def fall_time(self, gravity: float) -> float:
        """Characteristic time sqrt(h_i / g), s."""
        return sqrt(self.h_i / gravity)

    @property
    def rectangle_a(self) -> float | None:
        """Aspect ratio of a rectangle; None for an outline, which it does not describe."""
        return self.a if self.outline is None else None

    @property
    def proportions(self) -> str:
        """The aspect ratio in a text, or that the column is no rectangle."""
        if self.lean:
            return f"a = {self.a:.3g}, vertical sides"
        return f"a = {self.a:.3g}" if self.outline is None else f"outline of {len(self.outline)} points"

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return 3 if self.model in AZIMUTHS else 2

    @property
    def has_sectors(self) -> bool:
        """Whether the model has sectors of azimuth: a cylinder in 3D."""
        return self.dimension == 3 and self.section == "cylinder"

    @property
    def is_round(self) -> bool:
        """Whether distances are radii: a cylinder, axisymmetric or in 3D."""
        return self.model == "axisymmetric" or self.has_sectors

    @property
    def range_label(self) -> str:
        """Direction in which the sections differ, for tables and charts."""
        if self.slope_deg:
            return "from upslope to downslope"
        return "around the axis" if self.is_round else "along x"

    @property
    def slope_text(self) -> str:
        """The slope as an addition to a list of lengths; "" on a horizontal base."""
        return f", slope {self.slope_deg:g} deg" if self.slope_deg else ""

    @property
    def angle(self) -> float:
        """Range of azimuth of the model, rad; 1 in 2D, where masses are per radian or per metre."""
        start, end = AZIMUTHS.get(self.model, (0.0, 1.0))
        return end - start

    @property
    def sides(self) -> int:
        """Number of modelled sides of x = 0."""
        return 2 if self.angle > pi else 1

    @property
    def half_depth(self) -> float:
        """Half-depth of a box in z, m."""
        return self.r_i if self.depth is None else self.depth

    @property
    def surface(self) -> NDArray[np.float64]:
        """Line of the surface as released, (2, n), m; the closed outline of a column that is no rectangle."""
        if self.outline is None:
            top = self.r_i - self.lean * self.h_i
            return np.array([[0.0, top, self.r_i], [self.h_i, self.h_i, 0.0]])
        return np.array([*self.outline, self.outline[0]]).T

    @property
    def footprint(self) -> float:
        """Area of the base of the modelled column: m2, or m2 per radian, or m2 per metre of width."""
        if self.is_round:
            return self.angle * self.r_i**2 / 2.0
        quarters = self.angle / (pi / 2.0)
        return quarters * self.r_i * self.half_depth if self.dimension == 3 else self.r_i

    def potential_energy(self, gravity: float) -> float:
        """Potential energy of the modelled column as released, relative to a thin layer at its place on the base.

        J; per metre of width in plane strain, per radian in axisymmetry.
        """
        total = self.density * self._moment(0.0, self.h_i)
        for layer in self.layers:
            total += (layer.density - self.density) * self._moment(layer.lower, min(layer.upper, self.h_i))
        return total * gravity * cos(radians(self.slope_deg))

    def uniform_mass(self, mass: np.ndarray, material: np.ndarray) -> np.ndarray:
        """Masses (n,) that points would have with the density of the column: heights are mass over this density.

        material: 0 for the column, 2 and more for its layers, (n,).
        """
        if not self.layers:
            return mass
        densities = np.array([self.density, np.nan, *(layer.density for layer in self.layers)])
        return np.asarray(mass * (self.density / densities[material]))

    def _moment(self, lower: float, upper: float) -> float:
        """Integral of y, in axisymmetry of x y, over the part of the column between two heights."""
        if self.outline is None:
            return (upper**2 - lower**2) / 2.0 * self.footprint
        return self._moment_of_outline(*_between(self.surface, lower, upper))

    def _moment_of_outline(self, x: NDArray[np.float64], y: NDArray[np.float64]) -> float:
        """That of a closed polygon, as a sum over its edges (Green's theorem)."""
        (x, x_next), (y, y_next) = ((values[:-1], values[1:]) for values in (x, y))
        edges = (x * y_next - x_next * y) / 24.0
        if self.is_round:
            return float(np.sum(edges * (2.0 * x * y + x * y_next + x_next * y + 2.0 * x_next * y_next)))
        return float(np.sum(edges * 4.0 * (y + y_next)))


def _between(polygon: NDArray[np.float64], lower: float, upper: float) -> tuple[NDArray[np.float64], ...]:
    """The part of a closed polygon (2, n) between two heights; parts of its edges run along them and cancel."""
    x, y = polygon
    for level in (lower, upper):
        crossed = np.flatnonzero((y[:-1] - level) * (y[1:] - level) < 0.0)
        share = (level - y[crossed]) / (y[crossed + 1] - y[crossed])
        x = np.insert(x, crossed + 1, x[crossed] + share * (x[crossed + 1] - x[crossed]))
        y = np.insert(y, crossed + 1, level)
    return x, np.clip(y, lower, upper)
