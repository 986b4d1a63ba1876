"""The step of the solver as plain Numba loops over separate arrays, for comparison only.

The same equations, order of points and coloured tiles: it is parallel and gives the same numbers to round-off, but it
uses an array per quantity and scalars instead of vectors. Grid arrays have three axes, the last with one node in two
dimensions.
"""

# Compiled functions take what Numba infers.
# mypy: allow-untyped-defs
# ruff: noqa: ANN001

from __future__ import annotations

from collections.abc import Callable
from math import sqrt
from typing import Any, NamedTuple

import numpy as np

from mpmcol.mpm.constitutive import ConstitutiveLaw
from mpmcol.mpm.grid import TILE, Grid, Tiles, tile_count
from mpmcol.mpm.jit import device, phase, prange, variant
from mpmcol.mpm.kernels.grid_update import MASS_FLOOR
from mpmcol.mpm.kernels.particle_update import Bodies
from mpmcol.mpm.kernels.stress import make_stress_update
from mpmcol.mpm.particles import Points
from mpmcol.mpm.settings import Settings
from mpmcol.mpm.solver import Solver


class PlainPoints(NamedTuple):
    """One C-contiguous array per quantity of the points, in the order of `Tiles`; d = 2 or 3."""

    x: np.ndarray  # (n, d)
    v: np.ndarray  # (n, d)
    L: np.ndarray  # (n, 5): xx xy yx yy zz, or (n, 9) row by row
    sigma: np.ndarray  # (n, 4): xx yy zz xy, or (n, 6): xx yy zz xy yz xz
    m: np.ndarray  # (n,)
    V0: np.ndarray  # (n,)
    J: np.ndarray  # (n,)
    opening: np.ndarray  # (n,)
    history: np.ndarray  # (n, 2)


class PlainGrid(NamedTuple):
    """Dense arrays of nodes, padded to whole tiles."""

    m: np.ndarray  # (n_x, n_y, n_z)
    v: np.ndarray  # (n_x, n_y, n_z, d): momentum, then velocity
    a: np.ndarray  # (n_x, n_y, n_z, d): force, then acceleration
    fixed: np.ndarray  # (n_x, n_y, n_z) uint8: bits 0, 1, 2 fix v_x, v_y, v_z
    first: np.ndarray  # (n_active, 3) first node of each active tile
    depth: int  # nodes of a tile along z
    origin_x: float
    origin_y: float
    origin_z: float
    h: float
    n_x: int
    n_y: int
    n_z: int


class PlainState(NamedTuple):
    """All that the plain steps read and write; see `kernels.step.State`."""

    points: PlainPoints
    grid: PlainGrid
    tiles: Tiles
    settings: Settings
    bodies: Bodies
    smallest_mass: float
    node_report: np.ndarray  # (n_active, NODE_REPORT)
    tile_report: np.ndarray  # (n_tiles, 2): largest speed, stress work
    clock: np.ndarray


def plain_state(solver: Solver) -> PlainState:
    """Copy a solver whose points have just been sorted."""
    state = solver.state()
    return PlainState(
        plain_points(solver.points), plain_grid(state.grid, state.tiles), state.tiles, state.settings, state.bodies,
        state.smallest_mass, np.zeros_like(state.node_report), np.zeros((len(state.tiles.split), 2)),
        state.clock.copy(),
    )  # fmt: skip


def plain_points(points: Points) -> PlainPoints:
    """Copy the records to separate arrays."""
    L, d = points.grad_v.reshape(-1, 9), points.dimension
    arrays = (
        points.x, points.v, L if d == 3 else L[:, [0, 1, 3, 4, 8]], points.sigma[:, : 2 * d],
        points.m, points.V0, points.J, points.opening, points.history,
    )  # fmt: skip
    return PlainPoints(*(np.array(array, order="C") for array in arrays))


def plain_grid(grid: Grid, tiles: Tiles) -> PlainGrid:
    """A dense grid with the walls and active tiles of `grid`."""
    d, depth = (3, TILE) if grid.n_z > 1 else (2, 1)
    count = (tile_count(grid.n_x), tile_count(grid.n_y), tile_count(grid.n_z))
    shape = (count[0] * TILE, count[1] * TILE, count[2] * depth)
    blocks = grid.fixed.reshape(*count, TILE, TILE, depth).transpose(0, 3, 1, 4, 2, 5)
    first = np.stack(np.unravel_index(tiles.active // grid.tile_doubles, count), axis=1) * (TILE, TILE, depth)
    return PlainGrid(
        np.zeros(shape), np.zeros((*shape, d)), np.zeros((*shape, d)), blocks.reshape(shape), first, depth,
        grid.origin_x, grid.origin_y, grid.origin_z, grid.h, grid.n_x, grid.n_y, grid.n_z,
    )  # fmt: skip


@phase
def clear(grid: PlainGrid) -> None:
    """Set the nodes of all active tiles to zero.

    Reads: first. Writes: m, v, a. Eq. (19)-(20), initial values.
    """
    m_i, v_i, a_i, first = grid.m, grid.v, grid.a, grid.first
    for t in prange(len(first)):
        for i in range(first[t, 0], first[t, 0] + TILE):
            for j in range(first[t, 1], first[t, 1] + TILE):
                for k in range(first[t, 2], first[t, 2] + grid.depth):
                    m_i[i, j, k] = 0.0
                    for c in range(v_i.shape[3]):
                        v_i[i, j, k, c] = a_i[i, j, k, c] = 0.0


@phase
def update_grid(grid: PlainGrid, settings: Settings, smallest_mass: float, dt: float, report: np.ndarray) -> None:
    """Momentum to velocity, acceleration with damping, explicit update, walls.

    Reads: grid (m, mv, f), fixed. Writes: grid (v, a), report (n_active, 6). Eq. (21)-(24).
    """
    first, floor = grid.first, MASS_FLOOR * smallest_mass
    weight = abs(settings.gravity_x) + abs(settings.gravity_y) + abs(settings.gravity_z)
    for t in prange(len(first)):
        before, after, damping, walls, unbalanced, mass = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for i in range(first[t, 0], first[t, 0] + TILE):
            for j in range(first[t, 1], first[t, 1] + TILE):
                for k in range(first[t, 2], first[t, 2] + grid.depth):
                    sums = _update_node(grid, i, j, k, settings, floor, dt)
                    before += sums[0]
                    after += sums[1]
                    damping += sums[2]
                    walls += sums[3]
                    unbalanced += sums[4]
                    mass += sums[5]
        report[t, 0], report[t, 1], report[t, 2] = before, after, damping
        report[t, 3], report[t, 4], report[t, 5] = walls, unbalanced, mass * weight


@device
def _update_node(grid, i, j, k, settings, floor, dt):
    """One node; returns its share of the report."""
    m_i, v_i, a_i = grid.m, grid.v, grid.a
    m, mask = m_i[i, j, k], grid.fixed[i, j, k]
    before, after, damping, walls, unbalanced = 0.0, 0.0, 0.0, 0.0, 0.0
    for c in range(v_i.shape[3]):
        if m <= floor:
            v_i[i, j, k, c] = a_i[i, j, k, c] = 0.0
            continue
        raw, f = v_i[i, j, k, c] / m, a_i[i, j, k, c]  # Eq. 21
        before += 0.5 * m * raw * raw
        if mask & (1 << c):
            walls += 0.5 * m * raw * raw
            v_i[i, j, k, c] = 0.0
            a_i[i, j, k, c] = -raw / dt if settings.wall_impulse else 0.0
            continue
        drag = settings.alpha_d * abs(f) * ((raw > 0.0) - (raw < 0.0))
        a = (f - drag) / m  # Eq. 22, 23
        v = raw + dt * a  # Eq. 24
        v_i[i, j, k, c], a_i[i, j, k, c] = v, a
        after += 0.5 * m * v * v
        damping += 0.5 * dt * drag * (raw + v)
        unbalanced += abs(f)
    return before, after, damping, walls, unbalanced, m if m > floor else 0.0


def make_update_stress(dimension: int, column_law: ConstitutiveLaw, base_law: ConstitutiveLaw) -> Callable[..., Any]:
    """The stress update of all points, one at a time, with the laws of column and base frozen in."""
    column_stress, base_stress = (
        _make_point_stress(dimension, make_stress_update(dimension, law)) for law in (column_law, base_law)
    )

    @phase
    @variant(dimension, column_law, base_law)
    def update_stress(points, tiles, settings, column, base, c2_column, c2_base, dt, report):
        """Volume, stress and time step of all points.

        Reads: points (L). Writes: points (sigma, J, opening, history), report (n_tiles, 2). Eq. (29)-(36).
        """
        start, split = tiles.start, tiles.split
        for t in prange(len(split)):
            speed, work = 0.0, 0.0
            for p in range(start[t], split[t]):
                work_p, speed_p = column_stress(points, p, column, settings, c2_column, dt)
                work, speed = work + work_p, max(speed, speed_p)
            for p in range(split[t], start[t + 1]):
                work_p, speed_p = base_stress(points, p, base, settings, c2_base, dt)
                work, speed = work + work_p, max(speed, speed_p)
            report[t, 0], report[t, 1] = speed, work

    return update_stress


def _make_point_stress(dimension: int, stress_update: Callable[..., Any]) -> Callable[..., Any]:
    """The stress update of one point."""

    @device
    @variant(stress_update)
    def in_plane(points, p, params, settings, c2, dt):
        """Update point `p`; returns its stress work (J) and c_p + |v_p| (m/s)."""
        v, L, sigma, J, opening, q = points.v, points.L, points.sigma, points.J, points.opening, points.history
        s, grad = (sigma[p, 0], sigma[p, 1], sigma[p, 2], sigma[p, 3]), (L[p, 0], L[p, 1], L[p, 2], L[p, 3], L[p, 4])
        t, J[p], opening[p], new, work = stress_update(
            s, grad, points.V0[p], J[p], opening[p], (q[p, 0], q[p, 1]), params, settings, dt
        )
        sigma[p, 0], sigma[p, 1], sigma[p, 2], sigma[p, 3] = t
        q[p, 0], q[p, 1] = new
        return work, sqrt(c2 * J[p]) + sqrt(v[p, 0] ** 2 + v[p, 1] ** 2)

    @device
    @variant(stress_update)
    def in_space(points, p, params, settings, c2, dt):
        """Update point `p`; returns its stress work (J) and c_p + |v_p| (m/s)."""
        v, L, sigma, J, opening, q = points.v, points.L, points.sigma, points.J, points.opening, points.history
        s = (sigma[p, 0], sigma[p, 1], sigma[p, 2], sigma[p, 3], sigma[p, 4], sigma[p, 5])
        grad = (L[p, 0], L[p, 1], L[p, 2], L[p, 3], L[p, 4], L[p, 5], L[p, 6], L[p, 7], L[p, 8])
        t, J[p], opening[p], new, work = stress_update(
            s, grad, points.V0[p], J[p], opening[p], (q[p, 0], q[p, 1]), params, settings, dt
        )
        sigma[p, 0], sigma[p, 1], sigma[p, 2], sigma[p, 3], sigma[p, 4], sigma[p, 5] = t
        q[p, 0], q[p, 1] = new
        return work, sqrt(c2 * J[p]) + sqrt(v[p, 0] ** 2 + v[p, 1] ** 2 + v[p, 2] ** 2)

    return in_plane if dimension == 2 else in_space
