"""Shares of the inputs in a variance: Sobol indices of a response surface that is fitted to the sample."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement
from typing import Any

import numpy as np

from mpmcol.studies.uncertainty.inputs import UncertainInput
from mpmcol.studies.uncertainty.statistics import differ

RUNS_PER_TERM = 2  # least number of runs for each coefficient of a surface
SOBOL_SAMPLES = 4096
LEAST_R2 = 0.0  # cross-validated, below which a run is predicted worse than by the mean: shares are not given
RELIABLE_R2 = 0.5  # cross-validated, below which shares are given as not reliable
QUADRATIC, LINEAR = "quadratic", "linear"


@dataclass(frozen=True)
class VarianceShares:
    """Shares of the variance of a quantity, and how well the surface fits.

    The shares are the Sobol indices of the surface times its adjusted R2. Those are the indices with respect to all
    inputs and the scatter of the runs as one further, independent input.
    """

    surface: str  # QUADRATIC or LINEAR
    r2: float
    adjusted_r2: float
    cross_validated_r2: float
    first_order: dict[str, float]  # by key: share of the input alone
    total: dict[str, float]  # by key: with its interactions
    residual: float  # share of scatter, and of terms that the surface omits
    scatter: float | None  # share of scatter alone, at most the residual; None for several inputs

    @property
    def is_given(self) -> bool:
        """Whether the surface describes the runs well enough to state shares."""
        return self.cross_validated_r2 >= LEAST_R2

    @property
    def note(self) -> str:
        """What is to be known about the shares; "" if the surface describes the runs."""
        found = f"cross-validated R2 {self.cross_validated_r2:.2f}: the runs are too few, or scatter"
        if not self.is_given:
            return f"the surface does not describe the runs, and shares are not given ({found})"
        if self.cross_validated_r2 < RELIABLE_R2:
            return f"the surface describes the runs poorly, and the shares are not reliable ({found})"
        return ""


def variance_shares(inputs: Sequence[UncertainInput], x: np.ndarray, y: np.ndarray, seed: int) -> VarianceShares | None:
    """Fit a response surface by least squares and split the variance of the quantity.

    The surface is a polynomial of the standardised inputs (`Distribution.standardised`): quadratic with products if
    there are two runs for each of its (d + 1)(d + 2) / 2 coefficients, else linear if there are two for each of d + 1.
    First-order and total indices are those of Saltelli et al. 2010 (doi:10.1016/j.cpc.2009.09.018), for independent
    inputs. R2 is cross-validated by leaving out one run at a time.

    Args:
        x: values of the inputs, (n, d), in the units of the keys.
        y: values of the quantity, (n,).
        seed: of the random numbers of the indices.

    Returns:
        None without inputs, if the runs are too few for a linear surface, or if all values are equal.
    """
    if not inputs:
        return None
    z = np.column_stack([one.distribution.standardised(column) for one, column in zip(inputs, x.T, strict=True)])
    surface = next((name for name in (QUADRATIC, LINEAR) if len(y) >= RUNS_PER_TERM * _terms(z[:1], name).shape[1]), "")
    if not surface or not differ(y):
        return None
    spread = float(((y - y.mean()) ** 2).sum())
    terms = _terms(z, surface)
    inverse = np.linalg.pinv(terms)
    coefficients = inverse @ y
    residuals = y - terms @ coefficients
    leverage = (terms * inverse.T).sum(axis=1)  # diagonal of the hat matrix
    r2 = 1.0 - float((residuals**2).sum()) / spread
    adjusted = 1.0 - (1.0 - r2) * (len(y) - 1.0) / (len(y) - terms.shape[1])
    explained = max(adjusted, 0.0)
    scatter = neighbour_variance(z[:, 0], y) * (len(y) - 1.0) / spread if len(inputs) == 1 else None
    indices = _sobol(inputs, surface, coefficients, seed)
    keys = [one.key for one in inputs]
    return VarianceShares(
        surface=surface,
        r2=r2,
        adjusted_r2=adjusted,
        cross_validated_r2=1.0 - float(((residuals / (1.0 - leverage)) ** 2).sum()) / spread,
        first_order=dict(zip(keys, (explained * indices[0]).tolist(), strict=True)),
        total=dict(zip(keys, (explained * indices[1]).tolist(), strict=True)),
        residual=1.0 - explained,
        scatter=None if scatter is None else min(scatter, 1.0 - explained),
    )


def neighbour_variance(x: np.ndarray, y: np.ndarray) -> float:
    """Variance of the scatter of y (n,) about a smooth function of x (n,), n >= 3, all different.

    Each value is compared with the straight line between its neighbours (Gasser et al. 1986,
    doi:10.1093/biomet/73.3.625). Steps of the function between neighbours count as scatter.
    """
    order = np.argsort(x)
    x, y = x[order], y[order]
    before = (x[2:] - x[1:-1]) / (x[2:] - x[:-2])
    after = 1.0 - before
    difference = before * y[:-2] + after * y[2:] - y[1:-1]
    return float(np.mean(difference**2 / (before**2 + after**2 + 1.0)))


def _terms(z: np.ndarray, surface: str) -> np.ndarray:
    """Terms of a polynomial at standardised inputs, (n, terms): 1, the inputs, and their squares and products."""
    pairs = combinations_with_replacement(z.T, 2) if surface == QUADRATIC else ()
    return np.column_stack([np.ones(len(z)), *z.T, *(one * other for one, other in pairs)])


def _sobol(
    inputs: Sequence[UncertainInput], surface: str, coefficients: np.ndarray, seed: int
) -> tuple[np.ndarray, np.ndarray]:
    """First-order and total indices of a surface, each (d,) and within 0 to 1."""
    if len(inputs) == 1:
        return np.ones(1), np.ones(1)
    from scipy.stats import sobol_indices  # here, since it takes long to import

    def evaluate(z: Any) -> np.ndarray:
        return _terms(np.asarray(z).T, surface) @ coefficients

    found = sobol_indices(
        func=evaluate,
        n=SOBOL_SAMPLES,
        dists=[one.distribution.standard for one in inputs],
        rng=np.random.default_rng(seed),
    )
    first = np.clip(found.first_order, 0.0, 1.0)
    return first, np.clip(found.total_order, first, 1.0)  # they differ by random errors where there is no interaction
