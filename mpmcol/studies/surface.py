"""Difference in height between a deposit and a published surface."""

from __future__ import annotations

import numpy as np

from mpmcol.measure import Array, Measurement

STATIONS = 1001


def height_difference(deposit: Measurement, x: Array, y: Array) -> tuple[Array, Array]:
    """Return deposit minus surface (x, y), m, at equally spaced stations along the surface (STATIONS,)."""
    station = np.linspace(x[0], x[-1], STATIONS)
    height = np.interp(station, deposit.profile_x, deposit.profile_y, right=0.0)
    return station, height - np.interp(station, x, y)


def rms_difference(deposit: Measurement, x: Array, y: Array) -> float:
    """Return the root mean square of `height_difference`, m."""
    return float(np.sqrt(np.mean(height_difference(deposit, x, y)[1] ** 2)))
