"""Rectangular block in three dimensions, a quarter of it or all."""

from __future__ import annotations

import numpy as np

from mpmcol.setup.geometries import cylinder

DIMENSION = 3
AXISYMMETRIC = False
volumes = cylinder.volumes


def gate(horizontal: tuple[np.ndarray, ...], radius: float, depth: float) -> tuple[np.ndarray, ...]:
    """Where x is held: at and beyond the half-width `radius`; and z: at and beyond the half-depth `depth` (m)."""
    x, z = horizontal
    return np.abs(x) >= radius, np.abs(z) >= depth
