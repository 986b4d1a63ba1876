"""Cylindrical column in three dimensions, a quarter of it (Figure 4) or all."""

from __future__ import annotations

import numpy as np

DIMENSION = 3
AXISYMMETRIC = False


def gate(horizontal: tuple[np.ndarray, ...], radius: float, depth: float) -> tuple[np.ndarray, ...]:
    """Where x and z are held: at and beyond the radius (m).

    Both components, not their normal part alone: a mask stands for each component, and nothing turns about the axis.
    """
    beyond = np.hypot(*horizontal) >= radius
    return beyond, beyond


def volumes(sizes: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Initial volumes (n,) of points of the given volumes: m3."""
    return sizes
