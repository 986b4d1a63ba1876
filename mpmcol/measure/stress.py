"""Quality of the stress field of a column or deposit: noise of the pressure, points without stress, locking.

The stresses of single points are compared with the weight of the material above them. The deposit is divided into
columns of cells; the weight above a point is that of all points above it in its column, over the area of the column.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mpmcol.measure.sections import Array
from mpmcol.measure.shape import ColumnShape

INSIDE = 2.0  # cells: points below this thickness of material are inside the deposit
STRESS_FREE = 1e-3  # of the weight at the foot: points with a smaller pressure are stress-free


@dataclass(frozen=True)
class StressQuality:
    """Pressures of points, as multiples of the largest weight at the foot of the deposit."""

    weight_at_foot: float  # Pa, largest of all columns of cells
    stress_free: float  # share of the points inside the deposit without stress
    pressure_p1: float  # percentiles of the pressure of all points
    pressure_p99: float
    pressure_max: float
    scatter: float  # standard deviation of the pressure from the mean of its cell, inside the deposit


def stress_quality(
    x: Array, stress: Array, mass: Array, volume: Array, shape: ColumnShape, gravity: float
) -> StressQuality | None:
    """Compare the pressures of points with the weight above them; None if no point is inside the deposit.

    Args:
        x: positions, (n, 2) or (n, 3), m; y points upward.
        stress: Cauchy stresses xx yy zz ..., (n, 6), Pa, tension > 0.
        mass, volume: (n,), kg and m3 (per metre or per radian in two dimensions).
        shape: the column as released.
        gravity: m/s2.
    """
    if len(x) == 0:
        return None
    h = shape.spacing
    cell = np.floor(x / h).astype(np.int64)
    column = _number(np.delete(cell, 1, axis=1))
    above = gravity * _mass_above(column, x[:, 1], mass) / _area(x, column, shape)
    density = mass.sum() / volume.sum()
    inside = above > INSIDE * h * density * gravity
    if not inside.any():
        return None
    foot = float(above.max())
    pressure = -stress[:, :3].mean(axis=1) / foot
    members = _number(cell)
    mean = np.bincount(members, pressure * volume) / np.bincount(members, volume)
    difference = pressure - mean[members]
    p1, p99 = np.percentile(pressure, (1.0, 99.0))
    return StressQuality(
        weight_at_foot=foot,
        stress_free=float(np.mean(np.abs(pressure[inside]) < STRESS_FREE)),
        pressure_p1=float(p1),
        pressure_p99=float(p99),
        pressure_max=float(pressure.max()),
        scatter=float(np.sqrt(np.mean(difference[inside] ** 2))),
    )


def _number(cells: np.ndarray) -> np.ndarray:
    """Number the distinct rows of `cells` (n, k); returns the number of each row (n,)."""
    return np.unique(cells, axis=0, return_inverse=True)[1].reshape(-1)


def _mass_above(column: np.ndarray, y: Array, mass: Array) -> Array:
    """Mass of the points above each point in its column, with half of its own (n,)."""
    order = np.lexsort((-y, column))
    total = np.cumsum(mass[order])
    starts = np.flatnonzero(np.diff(column[order], prepend=-1))
    before = np.repeat(total[starts] - mass[order][starts], np.diff(starts, append=len(order)))
    above = np.empty_like(mass)
    above[order] = total - before - 0.5 * mass[order]
    return above


def _area(x: Array, column: np.ndarray, shape: ColumnShape) -> Array:
    """Horizontal area of the column of cells of each point (n,), m2, m2 per metre or m2 per radian."""
    h = shape.spacing
    if shape.dimension == 3:
        return np.full(len(x), h * h)
    if shape.model == "plane":
        return np.full(len(x), h)
    return (np.floor(x[:, 0] / h) + 0.5) * h * h
