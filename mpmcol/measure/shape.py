"""The column as released, and what part of it each model holds."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

AZIMUTHS = {"quarter": (0.0, pi / 2.0), "full": (-pi, pi)}  # rad: from where to where a 3D model goes round the axis


@dataclass(frozen=True)
class ColumnShape:
    """The column as released: what a deposit is measured against (m, kg/m3)."""

    model: str  # "plane" | "axisymmetric" | "quarter" | "full"
    release: str  # "one-sided" | "two-sided"
    r_i: float  # width, radius, or half-width of a box in x
    h_i: float
    spacing: float  # grid node spacing h
    density: float  # at release
    point_size: float  # distance between neighbouring points at the start
    section: str = "cylinder"  # of a 3D column: "cylinder" | "box"
    depth: float | None = None  # half-depth of a box in z; r_i if None

    @property
    def a(self) -> float:
        """Aspect ratio h_i / r_i."""
        return self.h_i / self.r_i

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return 3 if self.model in AZIMUTHS else 2

    @property
    def has_sectors(self) -> bool:
        """Whether there are sectors of azimuth to measure in: a cylinder in 3D."""
        return self.dimension == 3 and self.section == "cylinder"

    @property
    def is_round(self) -> bool:
        """Whether distances are radii: a cylinder, in axisymmetry or in 3D."""
        return self.model == "axisymmetric" or self.has_sectors

    @property
    def ranged(self) -> str:
        """What the sections lie along, in words."""
        return "around the axis" if self.is_round else "along x"

    @property
    def angle(self) -> float:
        """Azimuth that the model covers, rad; in 2D, where masses are per radian or per metre, 1."""
        start, end = AZIMUTHS.get(self.model, (0.0, 1.0))
        return end - start

    @property
    def sides(self) -> int:
        """Sides of x = 0 that the model holds."""
        return 2 if self.angle > pi else 1

    @property
    def half_depth(self) -> float:
        """Of a box, in z."""
        return self.r_i if self.depth is None else self.depth

    @property
    def footprint(self) -> float:
        """Area of the column's base in the model: m2, or m2 per radian, or m2 per metre of width."""
        if self.is_round:
            return self.angle * self.r_i**2 / 2.0
        quarters = self.angle / (pi / 2.0)
        return quarters * self.r_i * self.half_depth if self.dimension == 3 else self.r_i

    def potential_energy(self, gravity: float) -> float:
        """Of the column as released, above the base: J of what is modelled, per metre in plane strain, per radian in
        axisymmetry."""
        return self.density * gravity * self.footprint * self.h_i**2 / 2.0
