"""A column at the moment of its release, in any size: about half of its points yield in the first steps."""

from __future__ import annotations

from math import sqrt

import numpy as np

from mpmcol.laws import elastic, mohr_coulomb
from mpmcol.solver import Body, Solver
from mpmcol.state import BASE, V0, Points, Settings, allocate_grid, node_coordinates, set_fixed

MODELS = ("plane", "axisymmetric")
RADIUS, HEIGHT, BASE_LENGTH, BASE_DEPTH = 0.09, 0.09, 0.27, 0.02  # m
AREA = RADIUS * HEIGHT + BASE_LENGTH * BASE_DEPTH
PER_CELL_AND_AXIS = 2
GRAVITY = 9.81
MATERIAL = mohr_coulomb.Material(
    law="mohr-coulomb", density=2650.0, youngs_modulus=10e6, poissons_ratio=0.2, friction_deg=33.0
)


def make_solver(model: str, points: int) -> Solver:
    """About `points` points in a plane or axisymmetric column over an elastic base, ready to step."""
    h = _spacing(points)
    grid = allocate_grid((0.0, -round(BASE_DEPTH / h) * h), h, (round(1.2 * BASE_LENGTH / h), round(0.15 / h)))
    x, y = node_coordinates(grid)
    right, bottom = x.max(), y.min()
    set_fixed(grid, (x == 0.0) | (x == right) | (y == bottom), y == bottom)
    settings = Settings(0.0, -GRAVITY, 0.05, 0.5, 1.0, 1.0, 0.5, True, True, True, model == "axisymmetric")
    column = Body(mohr_coulomb, mohr_coulomb.make_params(MATERIAL), MATERIAL.wave_speed**2)
    base = Body(elastic, elastic.make_params(MATERIAL), MATERIAL.wave_speed**2)
    return Solver(_make_points(h, right, bottom, settings.axisymmetric), grid, settings, column, base)


def _spacing(points: int) -> float:
    """Grid spacing that gives about so many points, m."""
    return PER_CELL_AND_AXIS * sqrt(AREA / points)


def _make_points(h: float, right: float, bottom: float, axisymmetric: bool) -> Points:
    """Column under its own weight at active yield, jittered so that neighbours do not behave alike."""
    column = _fill(h, 0.0, RADIUS, 0.0, HEIGHT)
    base = _fill(h, 0.0, min(BASE_LENGTH, right), bottom, 0.0)
    points = Points(len(column) + len(base))
    noise = np.random.default_rng(1)
    points.x[:] = np.concatenate((column, base)) + noise.uniform(-0.02, 0.02, (len(points), 2)) * h
    points.kind[len(column) :] = BASE
    area = (h / PER_CELL_AND_AXIS) ** 2
    points.rows[:, V0] = area * points.x[:, 0] if axisymmetric else area
    points.m[:] = MATERIAL.density * points.V0
    vertical = MATERIAL.density * GRAVITY * np.minimum(points.x[:, 1] - HEIGHT, 0.0)
    sideways = MATERIAL.active_pressure_ratio * vertical
    points.sigma = np.stack((sideways, vertical, sideways, *(0.0 * vertical,) * 3), axis=1)
    return points


def _fill(h: float, x0: float, x1: float, y0: float, y1: float) -> np.ndarray:
    """Points (n, 2) in the middle of the sub-cells of a box whose corner (x0, y0) stands on a node."""
    d = h / PER_CELL_AND_AXIS
    n_x, n_y = (PER_CELL_AND_AXIS * max(round((b - a) / h), 1) for a, b in ((x0, x1), (y0, y1)))
    x, y = x0 + d * (np.arange(n_x) + 0.5), y0 + d * (np.arange(n_y) + 0.5)
    return np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
