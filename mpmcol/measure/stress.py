"""Quality of the stress field of a column or deposit: noise of the pressure, points without stress, locking.

The stresses of single points are compared with the weight of the material above them. The deposit is divided into
columns of cells; the weight above a point is that of all points above it in its column, over the area of the column.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mpmcol.measure.sections import Array
from mpmcol.measure.shape import ColumnShape

MOST_CELLS = 2**19  # along an axis; only points of failed runs are farther away
INSIDE = 2.0  # cells: points below this thickness of material are inside the deposit
STRESS_FREE = 1e-3  # of the weight at the foot: points with a smaller pressure are stress-free


@dataclass(frozen=True)
class StressQuality:
    """Pressures of points, as multiples of the largest weight at the foot of the deposit if not stated otherwise."""

    weight_at_foot: float  # Pa, largest of all columns of cells
    stress_free: float  # share of the points inside the deposit without stress
    pressure_p1: float  # percentiles of the pressure of all points
    pressure_p99: float
    pressure_max: float
    local_pressure_p1: float  # percentiles of the pressure over the weight above the point, inside the deposit
    local_pressure_p99: float
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
        gravity: normal to the base, m/s2.
    """
    if len(x) == 0:
        return None
    h = shape.spacing
    column = _cells(np.delete(x, 1, axis=1), h)
    above = gravity * _mass_above(column, x[:, 1], mass) / _area(x, column, shape)
    density = mass.sum() / volume.sum()
    inside = above > INSIDE * h * density * gravity
    if not inside.any():
        return None
    foot = float(above.max())
    pressure = -stress[:, :3].mean(axis=1) / foot
    difference = pressure - cell_means(x, pressure, volume, h)
    p1, p99 = np.percentile(pressure, (1.0, 99.0))
    local_p1, local_p99 = np.percentile(pressure[inside] * foot / above[inside], (1.0, 99.0))
    return StressQuality(
        weight_at_foot=foot,
        stress_free=float(np.mean(np.abs(pressure[inside]) < STRESS_FREE)),
        pressure_p1=float(p1),
        pressure_p99=float(p99),
        pressure_max=float(pressure.max()),
        local_pressure_p1=float(local_p1),
        local_pressure_p99=float(local_p99),
        scatter=float(np.sqrt(np.mean(difference[inside] ** 2))),
    )


def cell_means(x: Array, values: Array, volume: Array, spacing: float) -> Array:
    """Mean of `values` (n,), weighted by volume, over the points in the cell of each point (n,); x (n, d) in m.

    The cells are those of the grid; non-finite positions count as the origin.
    """
    members = _finite_cells(x, spacing)
    return (np.bincount(members, values * volume) / np.bincount(members, volume))[members]


def pressure_and_shear(x: Array, stress: Array, volume: Array, spacing: float) -> tuple[Array, Array]:
    """Pressure and sqrt(J2) of the cell means of `stress` (n, 6: xx yy zz xy yz xz), Pa."""
    members = _finite_cells(x, spacing)
    cell_volume = np.bincount(members, volume)
    xx, yy, zz, xy, yz, xz = (np.bincount(members, component * volume) / cell_volume for component in stress.T)
    p = -(xx + yy + zz) / 3.0
    normal2 = (xx + p) ** 2 + (yy + p) ** 2 + (zz + p) ** 2
    return p[members], np.sqrt(0.5 * normal2 + xy**2 + yz**2 + xz**2)[members]


def _finite_cells(x: Array, spacing: float) -> np.ndarray:
    return _cells(np.where(np.isfinite(x), x, 0.0), spacing)


def _cells(x: Array, spacing: float) -> np.ndarray:
    """Number of the cell of each point (n,), consecutive from 0."""
    cell = np.clip(np.floor(x / spacing), -MOST_CELLS, MOST_CELLS).astype(np.int64)
    cell -= cell.min(axis=0)
    number = np.ravel_multi_index(tuple(cell.T), tuple(cell.max(axis=0) + 1))
    return np.unique(number, return_inverse=True)[1].reshape(-1)


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
