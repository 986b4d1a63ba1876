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
    axis, where the gate holds that velocity component: at and beyond the surface of the column. outward: horizontal
    coordinates -> the component along each horizontal axis of the normal of the gate there. perimeter: (r_i,
    half-depth) -> length of the gate along the base, m (per metre, per radian; in three dimensions that of a quarter).
    volumes: (areas or volumes of the points' cells, positions x) -> their volumes, m3 (per metre in plane strain, per
    radian in axisymmetry).
    """

    dimension: int
    symmetry: BoundaryType
    beyond: Callable[[Coordinates, float, float], Coordinates]
    outward: Callable[[Coordinates], Coordinates]
    perimeter: Callable[[float, float], float]
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


def _along_x(horizontal: Coordinates) -> Coordinates:
    return (np.ones_like(horizontal[0]),)


def _radial(horizontal: Coordinates) -> Coordinates:
    x, z = horizontal
    r = np.maximum(np.hypot(x, z), np.finfo(float).tiny)
    return x / r, z / r


def _away_from_sides(horizontal: Coordinates) -> Coordinates:
    """Components for each axis, along which a side acts on that velocity component alone."""
    x, z = horizontal
    return np.sign(x), np.sign(z)


def _unchanged(sizes: np.ndarray, x: np.ndarray) -> np.ndarray:
    return sizes


def _per_radian(sizes: np.ndarray, x: np.ndarray) -> np.ndarray:
    return sizes * x[:, 0]


GEOMETRIES = {
    "plane": Geometry(2, ROLLER, _beyond_width, _along_x, lambda r_i, depth: 1.0, _unchanged),  # Figure 3
    # Figure 4; in two dimensions x is r, y the axis
    "axisymmetric": Geometry(2, AXIS, _beyond_width, _along_x, lambda r_i, depth: r_i, _per_radian),
    "cylinder": Geometry(
        3, ROLLER, _beyond_radius, _radial, lambda r_i, depth: 0.5 * np.pi * r_i, _unchanged
    ),  # Figure 4
    "box": Geometry(3, ROLLER, _beyond_sides, _away_from_sides, lambda r_i, depth: r_i + depth, _unchanged),
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
