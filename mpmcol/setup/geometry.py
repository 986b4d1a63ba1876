"""Geometries of columns, and the faces of the domain around them. A geometry is one entry of `GEOMETRIES`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mpmcol.case import Case
from mpmcol.mpm.boundary import AXIS, CONTACT, FREE, NO_SLIP, OPEN_END, ROLLER, BoundaryType, Faces

Coordinates = tuple[np.ndarray, ...]
VERTICAL = 1  # axis
ROUNDING = 5e-5  # relative change of a length above which a warning is issued: less is 0.00 %


@dataclass(frozen=True)
class Geometry:
    """Geometry of a column, as the set-up of a model needs it.

    dimension: 2, or 3 with the axis of the column at x = z = 0. symmetry: boundary at x = 0 (and z = 0 in three
    dimensions) of a model that is not full. beyond: (horizontal coordinates, r_i, half-depth) -> for each horizontal
    axis, where the gate holds that velocity component: at and beyond the surface of the column. volumes: (areas or
    volumes of the points' cells, positions x) -> their volumes, m3 (per metre in plane strain, per radian in
    axisymmetry).
    """

    dimension: int
    symmetry: BoundaryType
    beyond: Callable[[Coordinates, float, float], Coordinates]
    volumes: Callable[[np.ndarray, np.ndarray], np.ndarray]


def _beyond_width(horizontal: Coordinates, r_i: float, depth: float) -> Coordinates:
    return (horizontal[0] >= r_i,)


def _beyond_sides(horizontal: Coordinates, r_i: float, depth: float) -> Coordinates:
    x, z = horizontal
    return np.abs(x) >= r_i, np.abs(z) >= depth


def _beyond_radius(horizontal: Coordinates, r_i: float, depth: float) -> Coordinates:
    """Both components: nodes are held by component, and no material moves around the axis."""
    outside = np.hypot(*horizontal) >= r_i
    return outside, outside


def _unchanged(sizes: np.ndarray, x: np.ndarray) -> np.ndarray:
    return sizes


def _per_radian(sizes: np.ndarray, x: np.ndarray) -> np.ndarray:
    return sizes * x[:, 0]


GEOMETRIES = {
    "plane": Geometry(2, ROLLER, _beyond_width, _unchanged),  # Figure 3
    "axisymmetric": Geometry(2, AXIS, _beyond_width, _per_radian),  # Figure 4 in two dimensions: x is r, y the axis
    "cylinder": Geometry(3, ROLLER, _beyond_radius, _unchanged),  # Figure 4
    "box": Geometry(3, ROLLER, _beyond_sides, _unchanged),
}


def domain_faces(case: Case) -> Faces:
    """Boundary types of the low and high face of the domain along x, y and, in three dimensions, z."""
    geometry = GEOMETRIES[case.geometry.shape]
    floor = NO_SLIP if case.friction.floor is None else CONTACT
    low_side = OPEN_END if case.geometry.model == "full" else geometry.symmetry
    if case.friction.back_wall is not None:
        low_side = CONTACT
    return ((low_side, OPEN_END), (floor, FREE), (low_side, OPEN_END))[: geometry.dimension]


def points_per_axis(case: Case) -> int:
    """Points along each edge of a full cell."""
    return round(case.grid.points_per_cell ** (1.0 / case.geometry.dimension))
