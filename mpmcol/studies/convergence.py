"""Grid convergence: the value of a quantity extrapolated to zero node spacing, with its standard error."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass

import numpy as np

ORDERS = np.linspace(0.5, 2.0, 31)  # candidate orders of convergence
MIN_SPACINGS = 3
NORMAL_90 = 1.645  # standard deviations to either side of the mean that hold 90 % of normally distributed values
MAX_RATIO = 3.05  # of a spacing to the finest one: coarser grids are not yet in the asymptotic range


@dataclass(frozen=True)
class ConvergedValue:
    """A grid-converged value with its standard error and the order of convergence."""

    value: float
    error: float
    order: float


def first_order_value(spacings: Sequence[float], values: Sequence[float]) -> ConvergedValue | None:
    """Extrapolate single runs at several spacings by the least-squares line q(h) = q_0 + c h.

    First order is that of the gap below an elastic base and of the thickness of the front. The standard error follows
    from the residuals. Spacings larger than MAX_RATIO times the finest are left out.

    Returns None for fewer than MIN_SPACINGS different spacings.
    """
    h, q = np.asarray(spacings, dtype=float), np.asarray(values, dtype=float)
    near = h <= MAX_RATIO * h.min(initial=np.inf)
    if len(np.unique(h[near])) < MIN_SPACINGS:
        return None
    from scipy.stats import linregress  # takes longer to import than all that a run needs to be judged

    line = linregress(h[near], q[near])
    return ConvergedValue(float(line.intercept), float(line.intercept_stderr), 1.0)


def converged_value(levels: Mapping[float, Sequence[float]]) -> ConvergedValue | None:
    """Extrapolate repeated runs at several spacings: q(h) = q_0 + c h^p (Richardson extrapolation, observed order).

    A line in h^p is fitted to the means of the spacings for each p of ORDERS, weighted by the standard errors of the
    means, which follow from the pooled scatter of repetitions. The fits are averaged with their likelihoods as weights.
    The standard error therefore includes the scatter of the runs and the uncertainty of the order; it is inflated by
    the misfit where no power law fits the means.

    Args:
        levels: node spacing, in any unit -> values of the repeated runs.

    Returns None for fewer than MIN_SPACINGS spacings or without scatter between repetitions.
    """
    levels = {h: values for h, values in levels.items() if values and h <= MAX_RATIO * min(levels)}
    h = np.array(sorted(levels))
    if len(h) < MIN_SPACINGS or (scatter := pooled_scatter(levels)) is None:
        return None
    means = np.array([np.mean(levels[spacing]) for spacing in h])
    errors = scatter / np.sqrt([len(levels[spacing]) for spacing in h])
    fits = [_fit(h / h.max(), means, errors, order) for order in ORDERS]
    values, variances, misfits = (np.array(column) for column in zip(*fits, strict=True))
    inflation = max(misfits.min() / (len(h) - 2), 1.0)
    weights = np.exp(-0.5 * (misfits - misfits.min()) / inflation)
    weights /= weights.sum()
    value = float(weights @ values)
    variance = weights @ (variances * inflation + (values - value) ** 2)
    return ConvergedValue(value, float(np.sqrt(variance)), float(weights @ ORDERS))


def combine(refinements: Sequence[ConvergedValue]) -> ConvergedValue:
    """Average independent refinements by inverse variance; the error is at least half of the range of their values."""
    values, errors, orders = (np.array(column) for column in zip(*map(astuple, refinements), strict=True))
    weights = errors**-2.0
    share = weights / weights.sum()
    error = max(weights.sum() ** -0.5, np.ptp(values) / 2.0)
    return ConvergedValue(float(share @ values), float(error), float(share @ orders))


def pooled_scatter(levels: Mapping[float, Sequence[float]]) -> float | None:
    """Return the pooled standard deviation within spacings; None without repetitions or without scatter."""
    freedom = sum(max(len(values) - 1, 0) for values in levels.values())
    squares = sum(float(np.var(values)) * len(values) for values in levels.values() if len(values) > 1)
    return float(np.sqrt(squares / freedom)) if freedom and squares > 0.0 else None


def _fit(h: np.ndarray, means: np.ndarray, errors: np.ndarray, order: float) -> tuple[float, float, float]:
    """Fit q_0 + c h^order by weighted least squares; return q_0, its variance and the chi-squared misfit."""
    x = h**order
    coefficients, covariance = np.polyfit(x, means, 1, w=1.0 / errors, cov="unscaled")
    residuals = (means - np.polyval(coefficients, x)) / errors
    return float(coefficients[1]), float(covariance[1, 1]), float(residuals @ residuals)
