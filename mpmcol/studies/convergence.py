"""The limit of a quantity for small spacings, from runs at several of them, with its uncertainty."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

ORDERS = np.linspace(0.5, 2.0, 31)  # that a scheme of this kind may have
FEWEST = 3  # spacings
FARTHEST = 3.05  # times the finest spacing: coarser ones are not yet on their way to the limit


@dataclass(frozen=True)
class Limit:
    """A value with its standard error, and the order at which runs approach it."""

    value: float
    error: float
    order: float


def find_limit(runs: Mapping[float, Sequence[float]]) -> Limit | None:
    """Richardson extrapolation q(h) = q_0 + c h^p with the observed order p, from repeated runs at each spacing h.

    The order is not chosen but weighed: for each of ORDERS a line is fitted to the means, weighted by their standard
    errors (from the scatter within spacings, pooled); the fits count by their likelihood. So the error holds the
    scatter of the runs and what is not known of the order, and it grows with the misfit where the means are on no such
    curve. None for fewer than FEWEST spacings or no repetitions.
    """
    runs = {h: values for h, values in runs.items() if values and h <= FARTHEST * min(runs)}
    spacing = np.array(sorted(runs))
    if len(spacing) < FEWEST or (scatter := _pooled_scatter(runs)) is None:
        return None
    means = np.array([np.mean(runs[h]) for h in spacing])
    errors = scatter / np.sqrt([len(runs[h]) for h in spacing])
    fits = [_fit(spacing / spacing.max(), means, errors, order) for order in ORDERS]
    values, variances, misfits = (np.array(column) for column in zip(*fits, strict=True))
    inflation = max(misfits.min() / (len(spacing) - 2), 1.0)
    weights = np.exp(-0.5 * (misfits - misfits.min()) / inflation)
    weights /= weights.sum()
    value = float(weights @ values)
    variance = weights @ (variances * inflation + (values - value) ** 2)
    return Limit(value, float(np.sqrt(variance)), float(weights @ ORDERS))


def combine(first: Limit, second: Limit) -> Limit:
    """One limit from two independent refinements; its error is at least half of what they differ by."""
    weights = np.array([first.error, second.error]) ** -2.0
    share = weights / weights.sum()
    value = float(share @ (first.value, second.value))
    error = max(float(weights.sum() ** -0.5), abs(first.value - second.value) / 2.0)
    return Limit(value, error, float(share @ (first.order, second.order)))


def _pooled_scatter(runs: Mapping[float, Sequence[float]]) -> float | None:
    """Standard deviation of runs about the mean of their spacing; None if no spacing is repeated or none scatters."""
    freedom = sum(max(len(values) - 1, 0) for values in runs.values())
    squares = sum(float(np.var(values)) * len(values) for values in runs.values() if len(values) > 1)
    return float(np.sqrt(squares / freedom)) if freedom and squares > 0.0 else None


def _fit(h: np.ndarray, means: np.ndarray, errors: np.ndarray, order: float) -> tuple[float, float, float]:
    """Weighted least squares of q_0 + c h^order: q_0, its variance, and the squared misfit over the errors."""
    matrix = np.stack((np.ones_like(h), h**order), axis=1) / errors[:, None]
    inverse = np.linalg.inv(matrix.T @ matrix)
    fit = inverse @ matrix.T @ (means / errors)
    residual = means / errors - matrix @ fit
    return float(fit[0]), float(inverse[0, 0]), float(residual @ residual)
