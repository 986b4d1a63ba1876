"""Rectangular column in plane strain against a smooth wall or a plane of symmetry (Figure 3)."""

from __future__ import annotations

import numpy as np

DIMENSION = 2
AXISYMMETRIC = False


def gate(horizontal: tuple[np.ndarray, ...], radius: float, depth: float) -> tuple[np.ndarray, ...]:
    """Where x is held: at and beyond the width `radius` (m)."""
    return (horizontal[0] >= radius,)


def volumes(sizes: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Initial volumes (n,) of points of the given areas (m2): m3 per metre."""
    return sizes
