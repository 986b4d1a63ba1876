"""Difference in height between a deposit and a published surface."""

from __future__ import annotations

import numpy as np

STATIONS = 1001  # equally spaced, so that the spacing of the digitised points has no influence


def height_difference(
    profile: tuple[np.ndarray, np.ndarray], surface: tuple[np.ndarray, np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Stations along the surface, and the height of the deposit minus that of the surface there, (STATIONS,), m.

    profile, surface: distances and heights of each, m. The deposit ends at its last distance.
    """
    station = np.linspace(surface[0][0], surface[0][-1], STATIONS)
    return station, np.interp(station, *profile, right=0.0) - np.interp(station, *surface)


def rms_difference(profile: tuple[np.ndarray, np.ndarray], surface: tuple[np.ndarray, np.ndarray]) -> float:
    """Root mean square of `height_difference`, m."""
    return float(np.sqrt(np.mean(height_difference(profile, surface)[1] ** 2)))
