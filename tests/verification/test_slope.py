"""An infinite slope of Mohr-Coulomb sand (phi = 33, psi = 0) on a no-slip floor.

At constant volume (psi = 0) the sand mobilises tau / sigma_n = sin(phi): it stays at rest below atan(sin 33) = 28.6
degrees and accelerates by g (sin th - sin(phi) cos th) above. The grid is periodic along x: its address table
repeats every PERIOD nodes: points outside the first period act on its nodes. Tiles with the same nodes have the same
colour, so this requires one thread. The initial stress is hydrostatic (K = 1); between 28.6 and 33 degrees the
result depends on it.
"""

from __future__ import annotations

import numpy as np
import pytest

from mpmcol.failure_modes.toolkit import (
    DENSITY,
    PHI,
    PLAIN,
    G,
    advance_steps,
    advance_to,
    by_id,
    elastic_body,
    lattice,
    points_at,
    sand_body,
)
from mpmcol.mpm.boundary import hold_components
from mpmcol.mpm.grid import TILE, Grid, allocate_grid, node_coordinates, node_records, tile_count
from mpmcol.mpm.particles import COLUMN
from mpmcol.mpm.solver import Solver

PERIOD, LAYER, H = 8, 8, 0.05
DEPTH = LAYER * H
SINE = np.sin(np.radians(PHI))


def periodic_grid() -> Grid:
    """Forty periods long, with a no-slip floor."""
    grid = allocate_grid((0.0, 0.0), H, (40 * PERIOD, LAYER + 4))
    grid.ax[:] = grid.ax[np.arange(grid.n_x) % PERIOD]
    _, y = node_coordinates(grid)
    floor = y < 0.5 * H
    hold_components(grid, floor, floor)
    return grid


class PeriodicSolver(Solver):
    """Solver that clears and updates each tile once, though points of several periods act on it."""

    def sort(self) -> None:
        super().sort()
        assert self.tiles is not None
        x, y = np.divmod(self.tiles.active // self.grid.tile_doubles, tile_count(self.grid.n_y))
        self.set_tiles(self.tiles._replace(active=np.unique(self.grid.ax[TILE * x] + self.grid.ay[TILE * y])))


def layer(degrees: float, mobilised: float) -> tuple[Solver, np.ndarray]:
    """A layer at rest with tau = `mobilised` sigma_n, and the heights of its points."""
    points = points_at(lattice((PERIOD * H, 0.0), (2 * PERIOD * H, DEPTH), H / 2), H / 2, kind=COLUMN)
    angle, depth = np.radians(degrees), DEPTH - points.x[:, 1]
    normal = DENSITY * G * np.cos(angle) * depth
    points.sigma = np.stack([-normal, -normal, -normal, mobilised * normal], axis=1)
    settings = PLAIN._replace(gravity_x=G * np.sin(angle), gravity_y=-G * np.cos(angle))
    solver = PeriodicSolver(points, periodic_grid(), settings, sand_body(), elastic_body())
    return solver, points.x[:, 1].copy()


def test_the_grid_is_periodic() -> None:
    """The layer stays uniform along x across the ends of a period."""
    solver, y = layer(36.0, SINE)
    advance_steps(solver, 200)
    assert node_records(solver.grid)[:PERIOD, :, 0].sum() == pytest.approx(solver.points.m.sum(), rel=1e-12)
    v = by_id(solver).v[:, 0].reshape(-1, len(np.unique(y)))
    assert np.ptp(v, axis=0).max() < 1e-6 * v.max()


@pytest.mark.parametrize("degrees", [20.0, 27.0, 28.0])
def test_the_layer_stays_at_rest_below_28_6_degrees(degrees: float) -> None:
    """Gravity is tilted at once: the layer accelerates, slows down and stays at rest."""
    solver, _ = layer(degrees, 0.0)
    advance_to(solver, 0.8)
    start, first = by_id(solver).x[:, 0], solver.time
    advance_to(solver, 1.0)
    points = by_id(solver)
    assert np.average(points.v[:, 0], weights=points.m) < 2e-3
    assert np.abs(points.x[:, 0] - start).max() < 2e-3 * (solver.time - first)


@pytest.mark.parametrize("degrees", [30.0, 36.0])
def test_the_layer_accelerates_above_28_6_degrees(degrees: float) -> None:
    """Measured above the sheared cell at the floor; 1.2 % above theory with eight cells, 0.7 % with sixteen."""
    solver, y = layer(degrees, SINE)
    upper, speeds, times = y > 0.5 * DEPTH, [], []
    for end in (0.2, 0.8):
        advance_to(solver, end)
        speeds.append(by_id(solver).v[upper, 0].mean())
        times.append(solver.time)
    acceleration = (speeds[1] - speeds[0]) / (times[1] - times[0])
    angle = np.radians(degrees)
    assert acceleration == pytest.approx(G * (np.sin(angle) - SINE * np.cos(angle)), rel=0.025)
    np.testing.assert_allclose(solver.points.J, 1.0, atol=1e-3)
