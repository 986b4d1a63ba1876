"""Types of the records of published experiments: power laws of the aspect ratio, digitised profiles, and scores."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, Literal

# No scatter is published for most laws. The one set that gives it (Bougouin & Lacaze 2018) has +-0.3 on
# prefactors of 2.7 and 3.7; different sets of the same quantity lie 16-33 % apart.
ASSUMED_SCATTER = "no scatter published; assumed"
RUNOUT_SCATTER = 0.10
HEIGHT_SCATTER = 0.05
# Friction angles of materials that resemble those of an experiment, degrees: from the angle of repose, or of the grains
# in simple shear, to the peak of dense grains.
DRY_SAND, GLASS_BEADS = (28.0, 40.0), (20.0, 30.0)
OUTLINE = "outline"
MAX_COHESION = 0.01  # of rho g h_i: above it, a column does not resemble one of dry grains


def mark(verified: bool) -> str:
    """Suffix of the name or comment of a value: empty if the value is verified."""
    return "" if verified else " (unverified)"


def column_kind(model: str, section: str = "cylinder") -> str:
    """Kind of column by which experiments are selected: "plane", "axisymmetric", "box" or "outline".

    A cylinder is the same column in the axisymmetric, the quarter and the full model; an outline is no rectangle.
    """
    if section == OUTLINE:
        return OUTLINE
    if model in ("quarter", "full"):
        return "axisymmetric" if section == "cylinder" else "box"
    return model


@dataclass(frozen=True)
class Piece:
    """prefactor * a**exponent on lo <= a < hi."""

    lo: float
    hi: float
    prefactor: float
    exponent: float

    def __call__(self, a: float) -> float:
        return float(self.prefactor * a**self.exponent)

    def __contains__(self, a: float) -> bool:
        return self.lo <= a < self.hi


@dataclass(frozen=True)
class Law:
    """A published piecewise power law of the aspect ratio a, by increasing a.

    Quantities: "zeta" = (r_f - r_i) / r_i, "beta" = h_f / h_i, "stop_time" = t / sqrt(h_i / g) at which the
    front stops. `scatter` is relative to the value, and `scatter_source` gives its origin. A law without pieces
    has been published but cannot be evaluated; its note gives the reason.

    `verified`: the numbers were read in the original publication or in a publication that quotes them. Unverified
    laws are marked in every table and chart, and no check passes or fails by them.
    """

    quantity: Literal["zeta", "beta", "stop_time"]
    pieces: tuple[Piece, ...]
    scatter: float
    scatter_source: str = ASSUMED_SCATTER
    note: str = ""
    verified: bool = field(kw_only=True)

    def __call__(self, a: float) -> float | None:
        """Value at a, or None outside the ranges of the law."""
        return next((piece(a) for piece in self.pieces if a in piece), None)

    def gap(self, a: float) -> str:
        """Why the law has no value at a: the gap between its pieces, or the end of its range."""
        if not self.pieces:
            return self.note
        lo = max((piece.hi for piece in self.pieces if piece.hi <= a), default=0.0)
        hi = min((piece.lo for piece in self.pieces if piece.lo > a), default=math.inf)
        if lo == 0.0:
            return f"no law for a < {hi:g}"
        return f"no law for a >= {lo:g}" if hi == math.inf else f"no law for {lo:g} <= a < {hi:g}"


@dataclass(frozen=True)
class Profile:
    """Digitised points of a final deposit: wall or axis at x = 0, base at y = 0.

    `unit` is "m", or "1" for a shape in x / r_f and y / h_f. `verified`: the points were taken from the original
    figure, or the digitised profile satisfies conservation of mass.
    """

    name: str
    x: tuple[float, ...]
    y: tuple[float, ...]
    unit: Literal["m", "1"]
    source: str
    verified: bool


@dataclass(frozen=True)
class Conditions:
    """Material, slope and layers of a column; experiments are selected by them."""

    friction_deg: float | None  # residual, of a softening material; None without a yield surface
    cohesion: float  # relative to rho g h_i
    slope_deg: float = 0.0  # of the base
    has_layers: bool = False  # of different materials
    has_walls: bool = False  # in the way of the flow


@dataclass(frozen=True)
class Experiment:
    """A published data set, with at most one law for each quantity."""

    name: str
    title: str  # author and year, then a comma and the test
    model: Literal["plane", "axisymmetric", "box", "outline"]  # kind of column, see `column_kind`
    release: Literal["one-sided", "two-sided"]
    kind: Literal["laboratory", "simulation"]
    material: str
    laws: tuple[Law, ...]
    profiles: tuple[Profile, ...] = ()
    doi: str = ""
    note: str = ""
    column: tuple[float, float] | None = None  # (r_i, h_i) in m, if only one column was tested
    friction_deg: tuple[float, float] = DRY_SAND  # of materials that resemble its own, which are without cohesion

    def law(self, quantity: str) -> Law | None:
        """The law of a quantity, or None."""
        return next((law for law in self.laws if law.quantity == quantity), None)

    def label(self, quantity: str) -> str:
        """Author and year for the legend of a chart, marked if the law of the quantity is unverified."""
        law = self.law(quantity)
        return self.citation if law is None else self.citation + mark(law.verified)

    def expected(self, quantity: str, a: float) -> tuple[float, float] | None:
        """Value of the quantity's law at a and its absolute scatter; None where there is no law."""
        law = self.law(quantity)
        value = law(a) if law else None
        return None if law is None or value is None else (value, law.scatter * value)

    def misfit(self, conditions: Conditions) -> str:
        """Why the column's material or base does not resemble that of the experiment; "" if both do."""
        lo, hi = self.friction_deg
        if conditions.has_walls:
            return "for a flow without obstacles; here walls stand in its way"
        if conditions.has_layers:
            return "for a column of one material; here it has layers"
        if conditions.slope_deg:
            return f"for a horizontal base; here it slopes by {conditions.slope_deg:g} deg"
        if conditions.cohesion > MAX_COHESION:
            return f"for grains without cohesion; here it is {conditions.cohesion:.2g} rho g h_i"
        if conditions.friction_deg is None:
            return f"for friction of {lo:g} to {hi:g} deg; this material has none"
        if not lo <= conditions.friction_deg <= hi:
            return f"for friction of {lo:g} to {hi:g} deg; here it is {conditions.friction_deg:g} deg"
        return ""

    @property
    def citation(self) -> str:
        """Author and year."""
        return self.title.partition(",")[0]

    def fits(self, r_i: float, h_i: float) -> bool:
        """Whether profiles in m can be compared: the column has the experiment's size to within 2 %."""
        return self.column is None or all(
            math.isclose(size, own, rel_tol=0.02) for size, own in zip((r_i, h_i), self.column, strict=True)
        )


@dataclass(frozen=True)
class Score:
    """One value against one law: `error` is value / expected - 1, or None with the reason in `comment`."""

    experiment: str
    quantity: str
    front_definition: str  # "" unless the quantity is measured with a front
    value: float
    expected: float | None
    error: float | None
    scatter: float
    comment: str
    verified: bool  # see `Law`

    @property
    def within_scatter(self) -> bool | None:
        """Whether the error is at most the scatter of the experiment; None where there is no law."""
        return None if self.error is None else abs(self.error) <= self.scatter

    def as_dict(self) -> dict[str, Any]:
        """All fields and `within_scatter`, for JSON."""
        return {**vars(self), "within_scatter": self.within_scatter}


@dataclass(frozen=True)
class ProfileScore:
    """A deposit against a digitised surface: RMS distance in height, and the front if the surface is in m."""

    experiment: str
    profile: str
    rms_mm: float
    front: float | None
    expected_front: float | None
    error: float | None  # front / expected_front - 1
    comment: str
    verified: bool  # see `Profile`
