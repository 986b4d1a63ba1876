"""The interval in which the error of a run lies, with its sign, from the shipped study."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import hypot, sqrt

from mpmcol.errors import UsageError
from mpmcol.studies.convergence import NORMAL_90
from mpmcol.studies.pareto.score import BETA
from mpmcol.studies.pareto.shipped import (
    QUANTITIES,
    ColumnParameters,
    NeighbouringColumn,
    ShippedConfiguration,
    neighbouring_columns,
    shipped_configurations,
)

CONFIDENCE = 0.9
SAME_SPACING = 1.02  # ratio of r_i / h up to which spacings count as equal
NEIGHBOURS = 1.5  # ratio of r_i / h up to which configurations have a common scatter: those next to each other
RATIO_ERROR = 0.25  # of the ratio of errors at two friction angles, relative
LARGEST_RATIO = 2.0  # of these errors: those of fine grids are small, and their ratio is not known
HEIGHT_RESOLUTION = 0.25  # cells: half the distance of the points, with which a height is known, with four in a cell
OF_A_RUN = sqrt(1.5)  # scatter of a run about the mean of the two of a configuration, in that of one run


@dataclass(frozen=True)
class ErrorInterval:
    """Interval of 90 % of the relative error e of a run: its value is 1 + e times the grid-converged one, e > -1."""

    low: float
    high: float

    @property
    def factor(self) -> float:
        """Grid-converged over computed value: the middle of its interval."""
        return 0.5 * (1.0 / (1.0 + self.low) + 1.0 / (1.0 + self.high))

    @property
    def relative(self) -> float:
        """Half-width of the interval of the grid-converged value, relative to its middle."""
        return 0.5 * (1.0 / (1.0 + self.low) - 1.0 / (1.0 + self.high)) / self.factor

    def at_least(self, half_width: float) -> ErrorInterval:
        """The interval, or one about its middle with this half-width if it is narrower."""
        middle = 0.5 * (self.low + self.high)
        return ErrorInterval(min(self.low, middle - half_width), max(self.high, middle + half_width))

    def __str__(self) -> str:
        return f"{self.low:+.1%} to {self.high:+.1%}"


def hull(intervals: Iterable[ErrorInterval]) -> ErrorInterval:
    """Return the smallest interval that contains all of these."""
    found = list(intervals)
    return ErrorInterval(min(one.low for one in found), max(one.high for one in found))


def error_intervals(variant: str, cells: float, column: ColumnParameters) -> dict[str, ErrorInterval]:
    """Return the interval of each quantity for runs of a variant at r_i / h = cells of a column.

    It contains the mean errors of the neighbouring columns; between two spacings that were studied, those of both, and
    on finer grids than the finest one of a case, all down to zero. On either side it is wider by the scatter of a run
    between neighbouring spacings (Student's t, for the few runs that it is known from), the uncertainty of the
    grid-converged value and, where the error was not studied at this aspect ratio with this friction, that of the ratio
    of errors at the two friction angles. That of the height is at least HEIGHT_RESOLUTION wide on either side: errors
    that happen to vanish on a grid are not known better.

    Neighbouring columns of which this variant was not studied are left out.

    Raises UsageError if the study has no columns of this kind, or none with this variant.
    """
    neighbours = [one for one in neighbouring_columns(column) if all(_studied(case, variant) for case in one if case)]
    if not neighbours:
        raise UsageError(f'the study has no runs of "{variant}" for columns like this one; use --accuracy')
    found = {quantity: hull(_of_columns(quantity, variant, cells, neighbours)) for quantity in QUANTITIES}
    return found | {BETA: found[BETA].at_least(HEIGHT_RESOLUTION / (cells * column.a))}


def _of_columns(
    quantity: str, variant: str, cells: float, neighbours: Sequence[NeighbouringColumn]
) -> Iterator[ErrorInterval]:
    cases = dict.fromkeys(case for one in neighbours for case in (one.case, one.friction) if case)
    scatter = _scatter(quantity, [one for case in cases for one in _about(_studied(case, variant), cells)])
    for one in neighbours:
        near = _coarser(_studied(one.case, variant), cells)
        means = _means(quantity, variant, cells, one.case)
        width = hypot(scatter, NORMAL_90 * near.uncertainty[quantity])
        if one.friction and one.common:
            ratio = _ratio(*(_means(quantity, variant, cells, case)[0] for case in (one.friction, one.common)))
            means = [ratio * mean for mean in means]
            width = hypot(width, RATIO_ERROR * means[0])
        yield ErrorInterval(min(means) - width, max(means) + width)


def _ratio(error: float, common: float) -> float:
    """Ratio of two errors, between zero and LARGEST_RATIO."""
    return min(max(error / common, 0.0), LARGEST_RATIO) if common else LARGEST_RATIO


def _means(quantity: str, variant: str, cells: float, case: str) -> list[float]:
    """Mean errors of a case at this spacing, or at those on either side of it."""
    own = _studied(case, variant)
    near = _coarser(own, cells)
    return [near.bias[quantity], *_finer(quantity, own, near, cells)]


def _studied(case: str, variant: str) -> list[ShippedConfiguration]:
    return [one for one in shipped_configurations() if one.case == case and one.variant == variant]


def _coarser(own: Sequence[ShippedConfiguration], cells: float) -> ShippedConfiguration:
    """The configuration with equal spacing or the next coarser one; the coarsest if there is none."""
    coarser = [one for one in own if one.cells <= SAME_SPACING * cells]
    return max(coarser, key=lambda one: one.cells) if coarser else min(own, key=lambda one: one.cells)


def _finer(quantity: str, own: Sequence[ShippedConfiguration], near: ShippedConfiguration, cells: float) -> list[float]:
    """The mean error on the next finer grid, or zero beyond the finest; none if the spacing itself was studied."""
    if cells <= SAME_SPACING * near.cells:
        return []
    finer = [one for one in own if one.cells > cells]
    return [min(finer, key=lambda one: one.cells).bias[quantity] if finer else 0.0]


def _about(own: Sequence[ShippedConfiguration], cells: float) -> list[ShippedConfiguration]:
    near = _coarser(own, cells)
    return [one for one in own if near.cells / NEIGHBOURS <= one.cells <= NEIGHBOURS * near.cells]


def _scatter(quantity: str, alike: Sequence[ShippedConfiguration]) -> float:
    """Half-width of the interval of a run about the mean of a configuration; each has one degree of freedom."""
    from scipy.special import stdtrit  # here, since it takes long to import

    deviation = hypot(*(one.scatter[quantity] for one in alike)) / sqrt(len(alike))
    return float(stdtrit(len(alike), 0.5 + 0.5 * CONFIDENCE)) * OF_A_RUN * deviation
