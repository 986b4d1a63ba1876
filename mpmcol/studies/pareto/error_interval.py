"""The interval in which the error of a run lies, with its sign, from the shipped study."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import hypot, sqrt

from mpmcol.studies.convergence import NORMAL_90
from mpmcol.studies.pareto.shipped import QUANTITIES, ShippedConfiguration, shipped_configurations

CONFIDENCE = 0.9
SAME_SPACING = 1.02  # ratio of r_i / h up to which spacings count as equal
NEIGHBOURS = 1.5  # ratio of r_i / h up to which configurations have a common scatter: those next to each other
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

    def __str__(self) -> str:
        return f"{self.low:+.1%} to {self.high:+.1%}"


def hull(intervals: Iterable[ErrorInterval]) -> ErrorInterval:
    """Return the smallest interval that contains all of these."""
    found = list(intervals)
    return ErrorInterval(min(one.low for one in found), max(one.high for one in found))


def error_intervals(variant: str, cells: float, cases: Sequence[str]) -> dict[str, ErrorInterval]:
    """Return the interval of each quantity for runs of a variant at r_i / h = cells of a column between `cases`.

    It contains the mean error of each of the cases; between two spacings that were studied, those of both, and on finer
    grids than the finest one of a case, all down to zero. On either side it is wider by the scatter of a run between
    neighbouring spacings (Student's t, for the few runs that it is known from) and the uncertainty of the
    grid-converged value.
    """
    return {quantity: hull(_of_cases(quantity, variant, cells, cases)) for quantity in QUANTITIES}


def _of_cases(quantity: str, variant: str, cells: float, cases: Sequence[str]) -> Iterator[ErrorInterval]:
    studied = [_studied(case, variant) for case in cases]
    coarser = [_coarser(own, cells) for own in studied]
    scatter = _scatter(quantity, [one for own, near in zip(studied, coarser, strict=True) for one in _about(own, near)])
    for own, near in zip(studied, coarser, strict=True):
        width = hypot(scatter, NORMAL_90 * near.uncertainty[quantity])
        means = [near.bias[quantity], *_finer(quantity, own, near, cells)]
        yield ErrorInterval(min(means) - width, max(means) + width)


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


def _about(own: Sequence[ShippedConfiguration], near: ShippedConfiguration) -> list[ShippedConfiguration]:
    return [one for one in own if near.cells / NEIGHBOURS <= one.cells <= NEIGHBOURS * near.cells]


def _scatter(quantity: str, alike: Sequence[ShippedConfiguration]) -> float:
    """Half-width of the interval of a run about the mean of a configuration; each has one degree of freedom."""
    from scipy.special import stdtrit  # here, since it takes long to import

    deviation = hypot(*(one.scatter[quantity] for one in alike)) / sqrt(len(alike))
    return float(stdtrit(len(alike), 0.5 + 0.5 * CONFIDENCE)) * OF_A_RUN * deviation
