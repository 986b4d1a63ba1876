"""Erosion of a granular bed: what of it the flow has moved."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mpmcol.measure.sections import Array
from mpmcol.measure.shape import ColumnShape
from mpmcol.measure.surface import UNDISTURBED


@dataclass(frozen=True)
class Erosion:
    """Part of a bed that has moved by UNDISTURBED r_i or more since the release."""

    eroded_mass: float  # kg (per metre or per radian in two dimensions, of the modelled part in three)
    eroded_depth: float  # m, below the surface of the bed at the release; at most the thickness of the bed

    def reaches_floor(self, shape: ColumnShape) -> bool:
        """Whether the lowest points of the bed have moved as well, so that its thickness limits the erosion."""
        return self.eroded_depth > shape.bed - 0.5 * shape.point_size


def measure_erosion(x: Array, mass: Array, displacement: Array, shape: ColumnShape) -> Erosion:
    """Measure the erosion of the material points of the bed.

    Args:
        x: positions, (n, 2) or (n, 3), m; the surface of the bed was at y = 0.
        mass: masses, (n,), kg (per metre or per radian in two dimensions).
        displacement: since the release, as x, m.
        shape: the column as released.
    """
    moved = np.linalg.norm(displacement, axis=1) >= UNDISTURBED * shape.r_i
    released = (x - displacement)[moved, 1]
    depth = 0.5 * shape.point_size - released.min() if len(released) else 0.0
    # points next to the floor may sink by a part of a cell while the column is loaded
    return Erosion(float(mass[moved].sum()), float(min(depth, shape.bed)))
