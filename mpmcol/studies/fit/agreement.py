"""Whether fitted values reproduce the measurements, and what their differences mean for the standard errors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np

from mpmcol.studies.convergence import NORMAL_90
from mpmcol.studies.fit.quantities import Target
from mpmcol.studies.fit.response import misfit
from mpmcol.studies.fit.search import Solution

LIMIT = 2.0  # difference, in its standard errors, up to which a measured value counts as reproduced
END = 1e-3  # of the range: distance from an end at which a value counts as the end


@dataclass(frozen=True)
class Comparison:
    """A measured quantity beside the same with the fitted values, by the response surface.

    computed, errors: (k,), k > 1 for a profile; errors: standard errors of the differences by all known causes.
    """

    target: Target
    computed: np.ndarray
    errors: np.ndarray
    chi_squared: float

    @property
    def differences(self) -> np.ndarray:
        """Computed minus measured, in standard errors (k,)."""
        return np.asarray((self.computed - self.target.values) / self.errors)

    @property
    def is_reproduced(self) -> bool:
        """Whether the differences are as large as the errors explain."""
        return self.chi_squared <= largest_misfit(len(self.computed))

    def __str__(self) -> str:
        target, unit = self.target, f" {self.target.unit}" if self.target.unit else ""
        if len(self.computed) == 1:
            return (
                f"{target.name}: measured {target.values[0]:.4g} +- {target.errors[0]:.2g}{unit}, computed "
                f"{self.computed[0]:.4g}{unit}, difference {signed(self.differences[0])} standard errors"
            )
        k = int(np.abs(self.differences).argmax())
        root = np.sqrt(np.mean((self.computed - target.values) ** 2))
        return (
            f"{target.name}: measured and computed differ by {1e3 * root:.3g} mm (root mean square), most at r = "
            f"{target.x[k]:.3g} m: measured {1e3 * target.values[k]:.3g} mm, computed {1e3 * self.computed[k]:.3g} mm, "
            f"difference {signed(self.differences[k])} standard errors"
        )

    @property
    def text(self) -> str:
        """How far the measurement is missed."""
        k = int(np.abs(self.differences).argmax())
        measured, computed, unit = self.target.values[k], self.computed[k], self.target.unit
        station = f" at r = {self.target.x[k]:.3g} m" if len(self.computed) > 1 else ""
        share = abs(computed - measured) / measured if measured else np.inf
        by = f"{share:.0%} " if np.isfinite(share) else ""
        return (
            f"{self.target.name}{station} is {computed:.4g}{f' {unit}' if unit else ''}, {by}"
            f"{'below' if computed < measured else 'above'} the measured {measured:.4g} "
            f"({abs(self.differences[k]):.1f} standard errors)"
        )


@dataclass(frozen=True)
class Agreement:
    """All measured quantities beside the computed ones.

    at_end: (n,) whether each unknown is at an end of its range. A bound that holds an unknown is no free parameter, so
    that its misfit can be tested.
    """

    comparisons: tuple[Comparison, ...]
    chi_squared: float
    at_end: np.ndarray

    @property
    def values(self) -> int:
        """Number of measured values."""
        return sum(len(one.computed) for one in self.comparisons)

    @property
    def freedom(self) -> int:
        """Measured values less unknowns inside their ranges."""
        return self.values - int((~self.at_end).sum())

    @property
    def is_reproduced(self) -> bool:
        """Whether each measurement and all of them together are reproduced within the errors.

        Without a degree of freedom a misfit remains only where no values inside the ranges lead to the measurements; it
        is tested with one.
        """
        together = self.chi_squared <= largest_misfit(max(self.freedom, 1))
        return together and all(one.is_reproduced for one in self.comparisons)

    @property
    def has_errors(self) -> bool:
        """Whether standard errors can be stated: not where a misfit is due to the ends of the ranges."""
        return self.is_reproduced or (self.values > len(self.at_end) and not self.at_end.any())

    @property
    def scale(self) -> float:
        """Factor of the standard errors, at least 1: root of chi squared per degree of freedom (Birge 1932).

        Only where there are more measured values than unknowns.
        """
        return max(sqrt(self.chi_squared / self.freedom), 1.0) if self.values > len(self.at_end) else 1.0

    @property
    def quantile(self) -> float:
        """Half of an interval of 90 % in standard errors; by Student's t if the misfit alone gives the errors."""
        if self.is_reproduced:
            return NORMAL_90
        from scipy.stats import t  # here, since it takes long to import

        return float(t.ppf(0.95, max(self.freedom, 1)))

    @property
    def statement(self) -> str:
        """What is not reproduced, and what that means; empty if all is."""
        if self.is_reproduced:
            return ""
        missed = [one for one in self.comparisons if not one.is_reproduced]
        worst = max(self.comparisons, key=lambda one: float(np.abs(one.differences).max()))
        texts = "; ".join(one.text for one in missed or [worst])
        consequence = (
            f"the standard errors are enlarged by {self.scale:.2g}, the root of chi squared per degree of freedom"
            if self.has_errors
            else "the values are the nearest ones and have no standard error; extend the ranges, or check the "
            "measurements and the rest of the case"
        )
        return f"no values in the ranges reproduce the measurements: {texts}; {consequence}"


def agreement_of(targets: Sequence[Target], solution: Solution) -> Agreement:
    """Compare the measurements with the solution."""
    total = np.asarray(sum(solution.causes.values()))
    comparisons, first = [], 0
    for target in targets:
        own = slice(first, first + len(target.values))
        difference = solution.fitted[own] - target.values
        comparisons.append(
            Comparison(target, solution.fitted[own], np.sqrt(np.diag(total)[own]), misfit(difference, total[own, own]))
        )
        first = own.stop
    at_end = (solution.shares <= END) | (solution.shares >= 1.0 - END)
    return Agreement(tuple(comparisons), solution.chi_squared, np.asarray(at_end))


def largest_misfit(freedom: int) -> float:
    """Chi squared that errors exceed as rarely as a single difference exceeds LIMIT standard errors (4.6 %)."""
    from scipy.stats import chi2  # here, since it takes long to import

    return float(chi2.isf(chi2.sf(LIMIT**2, 1), freedom))


def signed(difference: float) -> str:
    """A difference in standard errors with one decimal; zero without a minus."""
    return f"{round(float(difference), 1) + 0.0:+.1f}"
