"""Cylindrical column by axial symmetry (Figure 4 as a model in two dimensions): x is the radius, y the axis."""

from __future__ import annotations

import numpy as np

AXISYMMETRIC = True


def volumes(areas: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Initial volumes (n,) of points of the given areas (m2) at radius x[:, 0]: m3 per radian."""
    return areas * x[:, 0]
