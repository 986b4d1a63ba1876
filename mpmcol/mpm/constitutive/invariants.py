"""Formulas of laws whose yield surface is a cone about the axis of pressure: mean stress and shear stress sqrt(J2)."""

from __future__ import annotations

from math import sqrt
from typing import Any

import numpy as np

from mpmcol.mpm.jit import device
from mpmcol.mpm.simd import where_positive


def active_ratio(friction: float) -> float:
    """Ratio of horizontal (equal in both directions) to vertical stress at sqrt(J2) = mu p; 0 for mu >= sqrt(3)."""
    slope = sqrt(3.0) * friction
    return max(3.0 - slope, 0.0) / (3.0 + 2.0 * slope)


def invariants_of(s1: np.ndarray, s2: np.ndarray, s3: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean stress and shear stress of principal stresses."""
    squares = (s1 - s2) ** 2 + (s2 - s3) ** 2 + (s3 - s1) ** 2
    return (s1 + s2 + s3) / 3.0, np.sqrt(squares / 6.0)


@device
def return_from_tension(mean: Any, shear: Any, apex: Any, bulk: Any) -> Any:
    """The apex where the mean stress exceeds it, else the given stress.

    Returns mean and shear stress (Pa), the volumetric strain released, and the excess of the mean stress (Pa).
    """
    excess = mean - apex
    return (
        where_positive(excess, apex, mean),
        where_positive(excess, 0.0, shear),
        where_positive(excess, excess * (1.0 / bulk), 0.0),
        excess,
    )
