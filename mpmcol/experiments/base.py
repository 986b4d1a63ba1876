"""Types of the records of published experiments: power laws of the aspect ratio, digitised profiles, and scores."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import chain
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
# Speed of the gate, over sqrt(g h_i), from which on the release counts as sudden: Sarlin et al. 2021,
# doi:10.1103/PhysRevE.104.064904.
QUICK_RELEASE = 0.4
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
    experiment: str  # name of the data set in which it was published


@dataclass(frozen=True)
class Conditions:
    """Material, base, side walls and release of a column; experiments are selected by them."""

    friction_deg: float | None  # residual, of a softening material; None without a yield surface
    cohesion: float  # relative to rho g h_i
    slope_deg: float = 0.0  # of the base
    has_layers: bool = False  # of different materials
    has_walls: bool = False  # in the way of the flow
    has_bed: bool = False  # the base is granular
    floor_friction: float = math.inf  # coefficient; inf: no slip
    channel_width: float = math.inf  # m, between side walls with friction
    friction_variation: float = 0.0  # coefficient of variation of tan(phi), of a random field
    release_speed: float = math.inf  # of the gate, relative to sqrt(g h_i); 0: there is no gate

    @property
    def slides(self) -> bool:
        """Whether the floor bears less shear than the material, which mobilises sin(phi) in plane strain."""
        return self.floor_friction < math.sin(math.radians(self.friction_deg or 0.0))


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
    channel_width: float | None = None  # m, between its side walls; None: without, or not known

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
        """Why the conditions of a column do not resemble those of the experiment; "" if they do."""
        return next(chain(self._other_set_up(conditions), self._other_material(conditions)), "")

    def _other_set_up(self, here: Conditions) -> Iterator[str]:
        if here.has_walls:
            yield "for a flow without obstacles; here walls stand in its way"
        if here.has_layers:
            yield "for a column of one material; here it has layers"
        if here.has_bed:
            yield "for a firm base; here the flow can erode it"
        if here.slope_deg:
            yield f"for a horizontal base; here it slopes by {here.slope_deg:g} deg"
        if here.slides:
            yield f"for a rough base; here the material slides over it, friction {here.floor_friction:.2g}"
        if here.channel_width < (self.channel_width or math.inf):
            own = "without side walls" if self.channel_width is None else f"{1e3 * self.channel_width:g} mm wide"
            yield f"for a channel {own}; here side walls {1e3 * here.channel_width:g} mm apart have friction"
        if here.release_speed == 0.0:
            yield "for a column behind a gate until the release; here it stands free"
        elif here.release_speed < QUICK_RELEASE:
            yield f"for a sudden release; here the gate moves at {here.release_speed:.2g} sqrt(g h_i)"

    def _other_material(self, here: Conditions) -> Iterator[str]:
        lo, hi = self.friction_deg
        if here.cohesion > MAX_COHESION:
            yield f"for grains without cohesion; here it is {here.cohesion:.2g} rho g h_i"
        if here.friction_deg is None:
            yield f"for friction of {lo:g} to {hi:g} deg; this material has none"
        elif not lo <= here.friction_deg <= hi:
            yield f"for friction of {lo:g} to {hi:g} deg; here it is {here.friction_deg:g} deg"
        if here.friction_variation:
            yield f"for uniform material; here the friction varies by {100.0 * here.friction_variation:.3g} %"

    def applies(self, a: float, conditions: Conditions | None = None) -> bool:
        """Whether a column of aspect ratio a, in these conditions if given, can be compared with a law."""
        return not (conditions and self.misfit(conditions)) and any(law(a) is not None for law in self.laws)

    @property
    def citation(self) -> str:
        """Author and year."""
        return self.title.partition(",")[0]

    def fits(self, r_i: float, h_i: float) -> bool:
        """Whether profiles in m can be compared: the column has the experiment's size to within 2 %."""
        return self.column is None or all(
            math.isclose(size, own, rel_tol=0.02) for size, own in zip((r_i, h_i), self.column, strict=True)
        )


def without_laws(reason: str) -> Experiment:
    """What stands for an experiment where none can be compared; its title is the reason."""
    return Experiment("none", reason, "outline", "two-sided", "laboratory", "", ())


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
