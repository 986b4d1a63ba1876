"""The interval in which the error of a run lies, with its sign, from the shipped study."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import hypot, sqrt

from mpmcol.studies.convergence import NORMAL_90
from mpmcol.studies.pareto.shipped import QUANTITIES, ShippedConfiguration, shipped_configurations

CONFIDENCE = 0.9
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

    It contains the mean error of each of the cases. On either side it is wider by the scatter of a run between
    neighbouring spacings (Student's t, for the few runs that it is known from) and the uncertainty of the
    grid-converged value. Errors of a case that was not studied on such fine grids are between those on its finest grid
    and zero.
    """
    return {quantity: hull(_of_cases(quantity, variant, cells, cases)) for quantity in QUANTITIES}


def _of_cases(quantity: str, variant: str, cells: float, cases: Sequence[str]) -> Iterator[ErrorInterval]:
    studied = {case: _studied(case, variant) for case in cases}
    nearest = {case: min(own, key=lambda one: abs(one.cells / cells - 1.0)) for case, own in studied.items()}
    scatter = _scatter(quantity, [one for case, own in studied.items() for one in _about(own, nearest[case])])
    for one in nearest.values():
        width = hypot(scatter, NORMAL_90 * one.uncertainty[quantity])
        means = [one.bias[quantity], *([0.0] if one.cells < cells else [])]
        yield ErrorInterval(min(means) - width, max(means) + width)


def _studied(case: str, variant: str) -> list[ShippedConfiguration]:
    return [one for one in shipped_configurations() if one.case == case and one.variant == variant]


def _about(own: Sequence[ShippedConfiguration], nearest: ShippedConfiguration) -> list[ShippedConfiguration]:
    return [one for one in own if nearest.cells / NEIGHBOURS <= one.cells <= NEIGHBOURS * nearest.cells]


def _scatter(quantity: str, alike: Sequence[ShippedConfiguration]) -> float:
    """Half-width of the interval of a run about the mean of a configuration; each has one degree of freedom."""
    from scipy.special import stdtrit  # here, since it takes long to import

    deviation = hypot(*(one.scatter[quantity] for one in alike)) / sqrt(len(alike))
    return float(stdtrit(len(alike), 0.5 + 0.5 * CONFIDENCE)) * OF_A_RUN * deviation
