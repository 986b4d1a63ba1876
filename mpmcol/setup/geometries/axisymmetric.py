"""Cylindrical column by axial symmetry (Figure 4 as a model in two dimensions): x is the radius r, y the axis."""

from __future__ import annotations

import numpy as np

from mpmcol.setup.geometries import plane

DIMENSION = 2
AXISYMMETRIC = True
gate = plane.gate


def volumes(sizes: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Initial volumes (n,) of points of the given areas (m2) at radius x[:, 0]: m3 per radian."""
    return sizes * x[:, 0]
