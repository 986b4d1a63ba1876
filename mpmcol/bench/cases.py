"""Benchmark cases: a column at the moment of its release, of any size; about half of its points yield at once."""

from __future__ import annotations

from math import pi

import numpy as np

from mpmcol.mpm.boundary import hold_components
from mpmcol.mpm.constitutive import elastic, mohr_coulomb
from mpmcol.mpm.grid import allocate_grid, node_coordinates
from mpmcol.mpm.particles import BASE, Points
from mpmcol.mpm.settings import Settings
from mpmcol.mpm.solver import Body, Solver

MODELS = ("plane", "axisymmetric", "quarter")
RADIUS, HEIGHT, BASE_LENGTH, BASE_DEPTH = 0.09, 0.09, 0.27, 0.02  # m
SIZE = {2: RADIUS * HEIGHT + BASE_LENGTH * BASE_DEPTH, 3: 0.25 * pi * RADIUS**2 * HEIGHT + BASE_LENGTH**2 * BASE_DEPTH}
PER_CELL_AND_AXIS = 2
GRAVITY = 9.81
MATERIAL = mohr_coulomb.Material(
    law="mohr-coulomb", density=2650.0, youngs_modulus=10e6, poissons_ratio=0.2, friction_deg=33.0
)


def make_solver(model: str, points: int, per_axis: int = PER_CELL_AND_AXIS) -> Solver:
    """A plane, axisymmetric or quarter column of about `points` points over an elastic base, `per_axis` in a cell."""
    d = 3 if model == "quarter" else 2
    h = per_axis * (SIZE[d] / points) ** (1.0 / d)
    across, up = round(1.2 * BASE_LENGTH / h), round(0.15 / h)
    grid = allocate_grid((0.0, -round(BASE_DEPTH / h) * h, 0.0)[:d], h, (across, up, across)[:d])
    x, y, *z = node_coordinates(grid)
    bottom = y == y.min()
    walls = [(x == 0.0) | (x == x.max()) | bottom, bottom, *((c == 0.0) | (c == c.max()) | bottom for c in z)]
    hold_components(grid, *walls)
    settings = Settings(gravity_y=-GRAVITY, alpha_d=0.05, axisymmetric=model == "axisymmetric")
    column = Body(mohr_coulomb, mohr_coulomb.make_params(MATERIAL), MATERIAL.wave_speed**2)
    base = Body(elastic, elastic.make_params(MATERIAL), MATERIAL.wave_speed**2)
    return Solver(_make_points(d, h, per_axis, float(y.min()), settings.axisymmetric), grid, settings, column, base)


def _make_points(d: int, h: float, per_axis: int, bottom: float, axisymmetric: bool) -> Points:
    """Column under its own weight at active yield; positions are perturbed so that neighbours differ."""
    column = _fill(h, per_axis, ((0.0, RADIUS), (0.0, HEIGHT), (0.0, RADIUS))[:d])
    column = column[np.hypot(column[:, 0], column[:, 2]) < RADIUS] if d == 3 else column
    base = _fill(h, per_axis, ((0.0, BASE_LENGTH), (bottom, 0.0), (0.0, BASE_LENGTH))[:d])
    points = Points(len(column) + len(base), d)
    noise = np.random.default_rng(1)
    points.x[:] = np.concatenate((column, base)) + noise.uniform(-0.02, 0.02, (len(points), d)) * h
    points.kind[len(column) :] = BASE
    points.V0[:] = (h / per_axis) ** d * (points.x[:, 0] if axisymmetric else 1.0)
    points.m[:] = MATERIAL.density * points.V0
    vertical = MATERIAL.density * GRAVITY * np.minimum(points.x[:, 1] - HEIGHT, 0.0)
    sideways = MATERIAL.active_pressure_ratio * vertical
    points.sigma = np.stack((sideways, vertical, sideways, *(0.0 * vertical,) * 3), axis=1)
    return points


def _fill(h: float, per_axis: int, sides: tuple[tuple[float, float], ...]) -> np.ndarray:
    """Points (n, d) at the centres of the sub-cells of a box whose lower corner is a node."""
    step = h / per_axis
    axes = [a + step * (np.arange(per_axis * max(round((b - a) / h), 1)) + 0.5) for a, b in sides]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(sides))
