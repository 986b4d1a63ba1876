"""Response of measured quantities to the unknowns: a quadratic surface, and least squares with it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

NEAR = 0.25  # distance, in the ranges of the unknowns, at which a run has half the weight of one at the centre
SLOPE_CHANGE = 0.5  # relative difference of slopes between grids
SMALLEST = 1e-12
STARTS = (0.25, 0.5, 0.75)  # of a search for the minimum, besides the given one


@dataclass(frozen=True)
class Surface:
    """y = c + sum over the unknowns of (b u + q u^2) for all quantities; u: unknowns from 0 to 1 in their ranges."""

    coefficients: np.ndarray  # (1 + 2 n, m)

    def value(self, u: np.ndarray) -> np.ndarray:
        """Values (m,) at u (n,)."""
        return np.asarray(_terms(u[None])[0] @ self.coefficients)

    def gradient(self, u: np.ndarray) -> np.ndarray:
        """Derivatives (m, n) at u (n,)."""
        n = len(u)
        linear, square = self.coefficients[1 : 1 + n], self.coefficients[1 + n :]
        return np.asarray((linear + 2.0 * u[:, None] * square).T)


def fit_surface(u: np.ndarray, y: np.ndarray, centre: np.ndarray) -> Surface:
    """Least squares for points u (k, n) with values y (k, m), the nearer to `centre` (n,) the more weight."""
    weight = np.sqrt(nearness(u, centre))[:, None]
    coefficients, *_ = np.linalg.lstsq(weight * _terms(u), weight * y, rcond=None)
    return Surface(coefficients)


def fit_plane(u: np.ndarray, y: np.ndarray, centre: np.ndarray) -> np.ndarray:
    """Slopes (m, n) of a plane through values y (k, m) at points u (k, n), weighted as those of a surface."""
    weight = np.sqrt(nearness(u, centre))[:, None]
    terms = np.column_stack((np.ones(len(u)), u))
    coefficients, *_ = np.linalg.lstsq(weight * terms, weight * y, rcond=None)
    return np.asarray(coefficients[1:].T)


def nearness(u: np.ndarray, centre: np.ndarray) -> np.ndarray:
    """Weights (k,) of points u (k, n) by their distance from a point."""
    distance = np.linalg.norm(u - centre, axis=1) / NEAR
    return np.asarray(1.0 / (1.0 + distance**2))


def corrected(
    surface: Surface, u: np.ndarray, y: np.ndarray, variance: np.ndarray, centre: np.ndarray
) -> tuple[Surface, float]:
    """The surface plus a plane, so that it agrees with values y (k, m) at points u (k, n); and their weight.

    A point changes the constant, and several also the slopes, as far as their differences exceed the `variance` (m,) of
    a value; slopes are expected to change by SLOPE_CHANGE of those of the surface (ridge regression). The nearer to
    `centre` (n,) the more weight.
    """
    weight = nearness(u, centre)
    middle = weight @ u / weight.sum()
    difference = y - np.array([surface.value(one) for one in u])
    constant = weight @ difference / weight.sum()
    x, slopes = u - middle, np.abs(surface.gradient(middle)).T  # (k, n), (n, m)
    change = np.zeros_like(slopes)
    for j in range(y.shape[1]):
        prior = np.diag(variance[j] / np.maximum((SLOPE_CHANGE * slopes[:, j]) ** 2, SMALLEST))
        change[:, j] = np.linalg.solve((x.T * weight) @ x + prior, (x.T * weight) @ (difference[:, j] - constant[j]))
    n, coefficients = u.shape[1], surface.coefficients.copy()
    coefficients[0] += constant - middle @ change
    coefficients[1 : 1 + n] += change
    return Surface(coefficients), float(weight.sum())


def design(n: int) -> np.ndarray:
    """Points (2 n + 1, n) that determine a surface of n unknowns: the centre, and the ends of each range."""
    points = np.full((2 * n + 1, n), 0.5)
    for k in range(n):
        points[1 + 2 * k, k], points[2 + 2 * k, k] = 0.0, 1.0
    return points


def best_point(surface: Surface, near: np.ndarray, measured: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """The unknowns u (n,) in their ranges with the least misfit to `measured` (m,); near: first start of the search."""
    from scipy.optimize import least_squares

    whiten = np.linalg.inv(np.linalg.cholesky(covariance))

    def residuals(u: np.ndarray) -> np.ndarray:
        return np.asarray(whiten @ (surface.value(u) - measured))

    def jacobian(u: np.ndarray) -> np.ndarray:
        return np.asarray(whiten @ surface.gradient(u))

    starts = [np.clip(near, 1e-6, 1.0 - 1e-6), *(np.full(len(near), one) for one in STARTS)]
    found = [least_squares(residuals, start, jacobian, bounds=(0.0, 1.0), xtol=1e-12, ftol=1e-12) for start in starts]
    return np.asarray(min(found, key=lambda one: float(one.cost)).x)


@dataclass(frozen=True)
class Precision:
    """Covariance (n, n) of the unknowns, and the parts of it by cause."""

    covariance: np.ndarray
    parts: dict[str, np.ndarray]

    @property
    def errors(self) -> np.ndarray:
        """Standard errors (n,)."""
        return np.sqrt(np.diag(self.covariance))

    def part(self, cause: str) -> np.ndarray:
        """Standard errors (n,) from one cause."""
        return np.sqrt(np.diag(self.parts[cause]))

    @property
    def correlation(self) -> np.ndarray:
        """Correlation matrix (n, n)."""
        return np.asarray(self.covariance / np.outer(self.errors, self.errors))


def precision(gradient: np.ndarray, causes: dict[str, np.ndarray]) -> Precision | None:
    """Precision of the unknowns by weighted least squares (linearised).

    gradient: derivatives (m, n) of the quantities. causes: covariance (m, m) of the quantities by cause, of independent
    causes. None if the quantities do not determine the unknowns.
    """
    weight = np.linalg.inv(sum(causes.values()))
    information = gradient.T @ weight @ gradient
    scale = np.sqrt(np.diag(information))
    if not (scale > 0.0).all() or np.linalg.cond(information / np.outer(scale, scale)) > 1.0 / np.finfo(float).eps:
        return None
    inverse = np.linalg.inv(information)
    estimator = inverse @ gradient.T @ weight
    return Precision(inverse, {cause: estimator @ own @ estimator.T for cause, own in causes.items()})


def misfit(difference: np.ndarray, covariance: np.ndarray) -> float:
    """Sum of squares of the differences (m,) in standard errors: chi squared."""
    return float(difference @ np.linalg.solve(covariance, difference))


def pooled_variance(groups: Sequence[np.ndarray]) -> np.ndarray:
    """Variance (m,) of a single run from repeated runs, each group (runs, m)."""
    freedom = sum(len(group) - 1 for group in groups)
    squares = sum(((group - group.mean(axis=0)) ** 2).sum(axis=0) for group in groups)
    return np.asarray(squares) / max(freedom, 1)


def _terms(u: np.ndarray) -> np.ndarray:
    """Terms (k, 1 + 2 n) of the surface at points u (k, n)."""
    return np.column_stack((np.ones(len(u)), u, u**2))
