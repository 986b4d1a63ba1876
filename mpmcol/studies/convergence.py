"""Grid convergence: the value of a quantity extrapolated to zero node spacing, with its standard error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple, dataclass

import numpy as np

ORDERS = np.linspace(0.5, 2.0, 31)  # candidate orders of convergence
MIN_SPACINGS = 3
MIN_RUNS = 4  # for the order of convergence: two degrees of freedom more than a line has
NORMAL_90 = 1.645  # standard deviations to either side of the mean that hold 90 % of normally distributed values
SMALLEST_ERROR = 1e-9  # relative standard error, at least: equal results of all runs give zero
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


def converged_value(spacings: Sequence[float], values: Sequence[float]) -> ConvergedValue | None:
    """Extrapolate single runs to h = 0: q(h) = q_0 + c h^p (Richardson extrapolation, observed order).

    Runs at neighbouring spacings scatter, because a result depends on where the nodes lie; their standard deviation is
    taken as proportional to h, that of a front whose position is known to a part of a cell. A line in h^p is fitted by
    weighted least squares for each p of ORDERS. The fits are averaged with their likelihoods as weights, so that the
    standard error includes the scatter of the runs, the misfit, and the uncertainty of the order. Spacings larger than
    MAX_RATIO times the finest are left out.

    Args:
        spacings: node spacing of each run, in any unit.
        values: result of each run.

    Returns None for fewer than MIN_SPACINGS different spacings or MIN_RUNS runs.
    """
    h, q = np.asarray(spacings, dtype=float), np.asarray(values, dtype=float)
    near = h <= MAX_RATIO * h.min(initial=np.inf)
    h, q = h[near] / h[near].max(initial=0.0), q[near]
    if len(np.unique(h)) < MIN_SPACINGS or len(h) < MIN_RUNS:
        return None
    intercepts, variances, misfits = (np.array(column) for column in zip(*(_fit(h, q, p) for p in ORDERS), strict=True))
    smallest = max(misfits.min(), np.finfo(float).tiny)
    weights = (np.maximum(misfits, smallest) / smallest) ** (1.0 - len(h) / 2.0)  # likelihoods with unknown scatter
    weights /= weights.sum()
    value = float(weights @ intercepts)
    variance = weights @ (variances + (intercepts - value) ** 2)
    return ConvergedValue(value, float(np.sqrt(variance)), float(weights @ ORDERS))


def combine(refinements: Sequence[ConvergedValue]) -> ConvergedValue:
    """Average independent refinements by inverse variance; the error is at least half of the range of their values."""
    values, errors, orders = (np.array(column) for column in zip(*map(astuple, refinements), strict=True))
    weights = np.maximum(errors, SMALLEST_ERROR * np.abs(values)) ** -2.0
    share = weights / weights.sum()
    error = max(weights.sum() ** -0.5, np.ptp(values) / 2.0)
    return ConvergedValue(float(share @ values), float(error), float(share @ orders))


def _fit(h: np.ndarray, q: np.ndarray, order: float) -> tuple[float, float, float]:
    """Fit q_0 + c h^order with the weights 1 / h; return q_0, its variance and the weighted sum of squares."""
    coefficients, covariance = np.polyfit(h**order, q, 1, w=1.0 / h, cov="unscaled")
    residuals = (q - np.polyval(coefficients, h**order)) / h
    misfit = float(residuals @ residuals)
    return float(coefficients[1]), float(covariance[1, 1]) * misfit / (len(h) - 2), misfit
