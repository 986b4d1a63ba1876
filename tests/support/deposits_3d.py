"""3D deposits of points on a regular lattice, for tests of the measurements."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from mpmcol.measure import ColumnShape, Measurement, measure

H = 0.005
S = H / 2
DENSITY = 2650.0
QUARTER = ColumnShape("quarter", "one-sided", r_i=0.1, h_i=0.06, spacing=H, density=DENSITY, point_size=S)
FULL = replace(QUARTER, model="full")
ROUND = replace(QUARTER, model="axisymmetric")
BOX = replace(QUARTER, section="box", depth=0.05)
CONE_RADIUS, CONE_HEIGHT = 0.2, 0.05

Inside = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]


def lattice(length: float, height: float, inside: Inside, shape: ColumnShape = QUARTER) -> np.ndarray:
    """Points with inside(radius, y, azimuth) on a lattice of spacing S."""
    along = np.arange(S / 2 - (length if shape.model == "full" else 0.0), length, S)
    grid = np.meshgrid(along, np.arange(S / 2, height, S), along, indexing="ij")
    x, y, z = (values.ravel() for values in grid)
    return np.column_stack([x, y, z])[inside(np.hypot(x, z), y, np.arctan2(z, x))]


def measured(points: np.ndarray, shape: ColumnShape = QUARTER) -> Measurement:
    return measure(points, np.full(len(points), DENSITY * S**3), None, shape)


def cylinder(shape: ColumnShape = QUARTER) -> np.ndarray:
    return lattice(shape.r_i, shape.h_i, lambda r, y, azimuth: r < shape.r_i, shape)


def cone(shape: ColumnShape = QUARTER) -> np.ndarray:
    return lattice(CONE_RADIUS, CONE_HEIGHT, lambda r, y, azimuth: y < CONE_HEIGHT * (1 - r / CONE_RADIUS), shape)


def at(radius: float, y: float, degrees: float) -> np.ndarray:
    azimuth = np.radians(degrees)
    return np.array([[radius * np.cos(azimuth), y, radius * np.sin(azimuth)]])
