"""The table [geometry] of a case file: the column, its base and the domain."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import BeforeValidator

from mpmcol.case.outline import Outline, OutlinePoints, extent, is_rectangle
from mpmcol.experiments import OUTLINE
from mpmcol.units import Table, option, quantity

_OUTLINE = OutlinePoints()


def whole_cells(length: float, h: float) -> int:
    """Number of cells of size h (m) that a length (m) is rounded to, at least one."""
    return max(round(length / h), 1)


class GeometryTable(Table):
    """The column, its base and the domain."""

    model: Literal["plane", "axisymmetric", "quarter", "full"] = option(
        "plane strain, axisymmetric, or 3D: a quarter with two planes of symmetry, or the full column"
    )
    release: Literal["one-sided", "two-sided"] = option(
        "plane model: collapse to one side of a wall, or to both sides (half of the column is modelled)", "one-sided"
    )
    section: Literal["cylinder", "box"] = option(
        "quarter and full models: horizontal section of the column, circular or rectangular", "cylinder"
    )
    radius: float | None = quantity(
        "r_i: radius of a cylinder, width of a plane column (half-width if two-sided), half-width of a box; required "
        "without outline",
        "m",
        None,
        gt=0,
    )
    depth: float | None = quantity("half-depth of a box; default: radius", "m", None, gt=0)
    height: float | None = quantity("h_i: initial height of the column; alternative to aspect", "m", None, gt=0)
    aspect: float | None = quantity("a = h_i / r_i: aspect ratio of the column; alternative to height", "", None, gt=0)
    outline: Annotated[Outline | None, _OUTLINE, BeforeValidator(_OUTLINE)] = option(
        "plane and axisymmetric models: polygon of a slope, heap or trapezoid, instead of radius, height and aspect; "
        "r_i is the largest x (or radius), h_i the largest y; a path is relative to the case file",
        None,
    )
    base: Literal["elastic", "rigid", "granular"] = option(
        "elastic layer of material points (the paper), rigid floor of no-slip grid nodes, or bed of granular material "
        "on such a floor, which the flow can erode",
        "elastic",
    )
    base_thickness: float = quantity("thickness of the elastic or granular base", "m", 0.02, gt=0)
    domain_length: float | None = quantity(
        "length of the domain from the wall or axis, of which the last five cells are not usable; default: sized for "
        "the expected runout",
        "m",
        None,
        gt=0,
    )
    domain_height: float | None = quantity(
        "height of the domain above the base; default: sized for the height of the column", "m", None, gt=0
    )
    gravity: float = quantity("gravitational acceleration g", "m/s2", 9.81, gt=0)
    slope_deg: float = quantity(
        'inclination of the base, downward along x; the column stands normal to the base unless sides = "vertical"; '
        "plane one-sided and full models",
        "deg",
        0.0,
        ge=0,
        lt=90,
    )
    sides: Literal["normal", "vertical"] = option(
        "sides of a column on a slope: normal to the base, or parallel to gravity; the wall of a plane column stays "
        "normal to the base",
        "normal",
    )

    @property
    def gravity_vector(self) -> tuple[float, float, float]:
        """Acceleration along x (downslope), y (normal to the base) and z, m/s2."""
        slope = math.radians(self.slope_deg)
        return self.gravity * math.sin(slope), -self.gravity * math.cos(slope), 0.0

    @property
    def normal_gravity(self) -> float:
        """Component of g normal to the base, toward it, m/s2."""
        return -self.gravity_vector[1]

    @property
    def shape(self) -> str:
        """Name of the column's geometry (mpmcol.setup.geometry)."""
        return self.model if self.model in ("plane", "axisymmetric") else self.section

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return 2 if self.model in ("plane", "axisymmetric") else 3

    @property
    def r_i(self) -> float:
        """Initial width or radius, m; of an outline the largest x."""
        if self.outline is not None:
            return extent(self.outline)[0]
        return math.nan if self.radius is None else self.radius

    @property
    def h_i(self) -> float:
        """Initial height, m; of an outline the largest y."""
        if self.outline is not None:
            return extent(self.outline)[1]
        return self.height if self.height is not None else self.r_i * (self.aspect or math.nan)

    @property
    def a(self) -> float:
        """Aspect ratio h_i / r_i."""
        return self.aspect if self.aspect is not None else self.h_i / self.r_i

    def fitted_spacing(self, spacing: float) -> float:
        """The spacing h nearest to a given one (m) by which r_i is a whole number of cells."""
        return self.r_i / whole_cells(self.r_i, spacing)

    @property
    def lean(self) -> float:
        """Distance that vertical sides lean upslope per height above the base: x = r_i - lean y; 0 for normal ones."""
        return math.tan(math.radians(self.slope_deg)) if self.sides == "vertical" else 0.0

    @property
    def polygon(self) -> Outline | None:
        """Outline of a two-dimensional column that is not given by r_i and h_i alone, m; None for others."""
        if self.lean == 0.0 or self.dimension == 3:
            return self.outline
        r_i, h_i = self.r_i, self.h_i
        return (0.0, 0.0), (r_i, 0.0), (r_i - self.lean * h_i, h_i), (0.0, h_i)

    @property
    def is_rectangle(self) -> bool:
        """Whether the column is a rectangle in the plane of x and y, as those of the experiments."""
        return self.polygon is None or is_rectangle(self.polygon)

    @property
    def column_section(self) -> str:
        """Section of the column by which experiments are selected: "outline" if it is no rectangle."""
        return self.section if self.is_rectangle else OUTLINE
