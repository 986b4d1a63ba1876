"""Stationary Gaussian random fields with two correlation lengths, as functions of position.

The field is a sum of MODES cosines with random amplitudes and phases (spectral representation, Shinozuka & Deodatis
1991, doi:10.1115/1.3119501) and random wave vectors (Kraichnan 1970, doi:10.1063/1.1692799). It needs no grid: one seed
gives the same field at every spacing.
"""

from __future__ import annotations

import numpy as np

MODES = 1000  # the correlation of one realization then has an error of about 3 %
CHUNK = 1024  # points at a time, for a matrix of 8 MB


def gaussian_field(x: np.ndarray, horizontal: float, vertical: float, seed: int) -> np.ndarray:
    """Values (n,) at positions x (n, d), m, of a realization of the field with mean 0 and variance 1.

    The correlation of two points is exp(-pi (dx^2 / horizontal^2 + dy^2 / vertical^2)), in 3D with dx^2 + dz^2 in place
    of dx^2. Its integral along each direction is the correlation length, which is the scale of fluctuation of
    Vanmarcke. In 2D the field is the section z = 0 of that in 3D with the same seed.

    Args:
        horizontal, vertical: correlation lengths, m; y is vertical.
        seed: number of the realization.
    """
    rng = np.random.default_rng(seed)
    wave_vectors = rng.standard_normal((MODES, 3)) * np.sqrt(2.0 * np.pi)
    wave_vectors /= np.array([horizontal, vertical, horizontal])
    amplitudes, phases = rng.rayleigh(size=MODES) / np.sqrt(MODES), rng.uniform(0.0, 2.0 * np.pi, MODES)
    columns, values = wave_vectors[:, : x.shape[1]].T, np.empty(len(x))
    for first in range(0, len(x), CHUNK):
        part = slice(first, first + CHUNK)
        values[part] = np.cos(x[part] @ columns + phases) @ amplitudes
    return values


def lognormal_variation(field: np.ndarray, variation: float) -> np.ndarray:
    """Values over their mean, minus one (n,), of a lognormal field with this coefficient of variation.

    field: standard Gaussian field (n,). The underlying normal distribution has the variance ln(1 + variation^2).
    """
    deviation = np.sqrt(np.log1p(variation**2))
    return np.expm1(deviation * field - 0.5 * deviation**2)
