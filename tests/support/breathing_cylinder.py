"""Radial vibration of an elastic cylinder in plane strain, in closed form."""

from __future__ import annotations

import numpy as np

from mpmcol.failure_modes.toolkit import NU


def bessel(order: int, z: np.ndarray | float) -> np.ndarray:
    """J_n(z) by Bessel's integral."""
    t = (np.arange(200) + 0.5) * np.pi / 200
    return np.cos(order * t - np.multiply.outer(z, np.sin(t))).mean(axis=-1)


def breathing_root() -> float:
    """Smallest z with z J0(z) = (1 - 2 nu) / (1 - nu) J1(z): no radial stress at r = R, omega = z c_p / R."""

    def stress(z: float) -> float:
        return float(z * bessel(0, z) - (1.0 - 2.0 * NU) / (1.0 - NU) * bessel(1, z))

    low, high = 1.0, 3.0
    for _ in range(50):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if stress(middle) > 0.0 else (low, middle)
    return low
