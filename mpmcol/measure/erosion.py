"""Erosion of a granular bed, and the deposit over its old surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from mpmcol.measure.front import front_by_height, profiles
from mpmcol.measure.sections import Array, split
from mpmcol.measure.shape import ColumnShape
from mpmcol.measure.undisturbed import UNDISTURBED


class Material(NamedTuple):
    """Material points of the column or of the bed."""

    x: Array  # positions, (n, 2) or (n, 3), m; the surface of the bed was at y = 0
    mass: Array  # (n,) kg; per metre of width in plane strain, per radian in axisymmetry
    displacement: Array  # since the release, as x, m


@dataclass(frozen=True)
class Erosion:
    """Part of a bed that has moved by UNDISTURBED r_i or more since the release, and the surface that is left."""

    eroded_mass: float  # kg (per metre or per radian in two dimensions, of the modelled part in three)
    eroded_depth: float  # m, below the surface of the bed at the release; at most the thickness of the bed
    surface_drop: float  # m, largest depth of the surface below that of the bed at the release
    deposit_front: float  # m, where the surface, contiguous from the pile, meets that of the bed at the release

    def reaches_floor(self, shape: ColumnShape) -> bool:
        """Whether the lowest points of the bed have moved as well, so that its thickness limits the erosion."""
        return self.eroded_depth > shape.bed - 0.5 * shape.point_size


def measure_erosion(column: Material, bed: Material, shape: ColumnShape) -> Erosion:
    """Measure the erosion of a granular bed, and the deposit over its old surface.

    The front of the deposit is where it becomes thinner than the threshold of `front_height`. It includes material of
    the bed that the flow has raised.
    """
    moved = np.linalg.norm(bed.displacement, axis=1) >= UNDISTURBED * shape.r_i
    released = (bed.x - bed.displacement)[moved, 1]
    depth = 0.5 * shape.point_size - released.min() if len(released) else 0.0
    profile_x, height = surface_over_bed(column, bed, shape)
    return Erosion(
        eroded_mass=float(bed.mass[moved].sum()),
        eroded_depth=float(min(depth, shape.bed)),  # points next to the floor may sink while the column is loaded
        surface_drop=float(-height.min(initial=0.0)),
        deposit_front=front_by_height(profile_x, height, shape),
    )


def surface_over_bed(column: Material, bed: Material, shape: ColumnShape) -> tuple[Array, Array]:
    """Height of the surface over that of the bed at the release, negative where the flow has lowered it.

    It is the thickness of the material of the column, plus the change of the thickness of the bed, each as mass over
    density and area (`deposit_profile`): compaction and dilation do not count. The volume under it is that of the
    column.

    Returns:
        bin centres and heights, (bins,), m; in 3D the mean over the sections.
    """
    mass = bed.mass * (shape.density / (shape.bed_density or shape.density))
    thickness = [
        profiles(split(x, own, shape), shape)
        for x, own in ((column.x, column.mass), (bed.x, mass), (bed.x - bed.displacement, mass))
    ]
    profile_x = max((x for x, _ in thickness), key=len)
    of_column, now, released = (
        np.pad(height.mean(axis=0), (0, len(profile_x) - height.shape[1])) for _, height in thickness
    )
    return profile_x, of_column + now - released
