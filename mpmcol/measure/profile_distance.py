"""Distance between the height profiles of deposits."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mpmcol.measure import Array, Measurement

STATIONS = 2001


def stations(deposits: Sequence[Measurement]) -> Array:
    """Equally spaced stations from the wall or axis to beyond the farthest front of all deposits, m."""
    return np.linspace(0.0, 1.05 * max(deposit.max_distance for deposit in deposits), STATIONS)


def mean_height(deposits: Sequence[Measurement], x: Array) -> Array:
    """Mean height of the deposits at the stations x, m."""
    heights = [np.interp(x, deposit.profile_x, deposit.profile_y, right=0.0) for deposit in deposits]
    return np.asarray(np.mean(heights, axis=0))


def area_between(height: Array, reference: Array) -> float:
    """Area between two profiles at the same stations, relative to the area of the second."""
    return float(np.abs(height - reference).sum() / reference.sum())
