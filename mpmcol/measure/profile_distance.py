"""How far a deposit's shape is from another's."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mpmcol.measure import Array, Measurement

STATIONS = 2001


def stations(deposits: Sequence[Measurement]) -> Array:
    """Places (m) from wall or axis to beyond the farthest front of all deposits."""
    return np.linspace(0.0, 1.05 * max(deposit.reach for deposit in deposits), STATIONS)


def mean_height(deposits: Sequence[Measurement], x: Array) -> Array:
    """Their mean height (m) at the stations x (m)."""
    heights = [np.interp(x, deposit.profile_x, deposit.profile_y, right=0.0) for deposit in deposits]
    return np.asarray(np.mean(heights, axis=0))


def area_between(height: Array, reference: Array) -> float:
    """Area between two profiles at the same stations over the area of the second."""
    return float(np.abs(height - reference).sum() / reference.sum())
