"""The equation of motion at the nodes."""

from __future__ import annotations

import numpy as np

from mpmcol.mpm.grid import NODE, Grid, Tiles
from mpmcol.mpm.jit import device, phase, prange
from mpmcol.mpm.settings import Settings
from mpmcol.mpm.simd import fma, load, reduce_sum, splat, store, swap_halves, vector, where_positive

# what a tile of nodes reports, summed later in a fixed order
KINETIC_BEFORE, KINETIC_AFTER, DAMPING, WALLS, UNBALANCED, WEIGHT, NODE_REPORT = range(7)
# Share of the smallest point mass under which a node is left alone. It only guards 0 / 0: a spline's force and mass
# vanish together, and a node cut off by a larger floor would kick the points that just reach it.
MASS_FLOOR = 1e-20


@phase
def clear(grid: Grid, tiles: Tiles) -> None:
    """Set the nodes of all active tiles to zero.

    Reads: active. Writes: nodes. Eq. (19)-(20), initial values.
    """
    nodes, active, size = grid.nodes, tiles.active, grid.tile_doubles
    for t in prange(len(active)):
        for o in range(active[t], active[t] + size, NODE):
            store(nodes, o, splat(0.0))


@phase
def update_grid(
    grid: Grid, tiles: Tiles, settings: Settings, smallest_mass: float, dt: float, report: np.ndarray
) -> None:
    """Momentum to velocity, acceleration with damping, explicit update, walls before and after.

    Reads: nodes (m, mv, f), fixed. Writes: nodes (v~, a), report (n_active, 6). Eq. (21)-(24).
    """
    nodes, fixed, active, size = grid.nodes, grid.fixed, tiles.active, grid.tile_doubles
    floor = MASS_FLOOR * smallest_mass
    weight = abs(settings.gravity_x) + abs(settings.gravity_y) + abs(settings.gravity_z)
    momenta, nothing = vector(0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0), splat(0.0)
    per_dt = 1.0 / dt if settings.wall_impulse else 0.0  # a held node's points move as if it stopped in this step
    wall_dt = dt if settings.wall_impulse else 0.0
    for t in prange(len(active)):
        mass = 0.0
        before, after, damping, walls, unbalanced = nothing, nothing, nothing, nothing, nothing
        for o in range(active[t], active[t] + size, NODE):
            m = nodes[o]
            if m <= floor:  # a mass that is not a number goes on to the points, where it is found
                store(nodes, o, nothing)
                continue
            rates, m_i = load(nodes, o) * (1.0 / m), splat(m)
            raw, f = rates * momenta, swap_halves(rates) * momenta  # Eq. 21; f per mass
            drag = settings.alpha_d * where_positive(raw, abs(f), where_positive(-raw, -abs(f), 0.0))  # Eq. 23
            held, free_a = _held(fixed[o // NODE]), f - drag  # Eq. 22
            v = where_positive(held, 0.0, raw + dt * free_a)  # Eq. 24
            a = where_positive(held, raw * -per_dt, free_a)
            store(nodes, o, vector(m, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0) + v + swap_halves(a))
            mass += m
            before, after = fma(m_i * raw, raw, before), fma(m_i * v, v, after)
            damping = fma(m_i, where_positive(held, 0.0, drag * (raw + v)), damping)
            walls = fma(m_i, where_positive(held, raw * (raw + wall_dt * f), 0.0), walls)
            unbalanced = fma(m_i, where_positive(held, 0.0, abs(f)), unbalanced)
        report[t, KINETIC_BEFORE], report[t, KINETIC_AFTER] = 0.5 * reduce_sum(before), 0.5 * reduce_sum(after)
        report[t, DAMPING], report[t, WALLS] = 0.5 * dt * reduce_sum(damping), 0.5 * reduce_sum(walls)
        report[t, UNBALANCED], report[t, WEIGHT] = reduce_sum(unbalanced), mass * weight


@phase
def find_velocities(grid: Grid, tiles: Tiles, smallest_mass: float) -> None:
    """Momentum to velocity, at rest where walls hold it, for an update of the stress alone.

    Reads: nodes (m, mv), fixed. Writes: nodes (m, v). Eq. (21).
    """
    nodes, fixed, active, size = grid.nodes, grid.fixed, tiles.active, grid.tile_doubles
    floor = MASS_FLOOR * smallest_mass
    momenta, nothing = vector(0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0), splat(0.0)
    for t in prange(len(active)):
        for o in range(active[t], active[t] + size, NODE):
            m = nodes[o]
            if m <= floor:
                store(nodes, o, nothing)
            else:
                v = where_positive(_held(fixed[o // NODE]), 0.0, load(nodes, o) * (1.0 / m) * momenta)
                store(nodes, o, vector(m, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0) + v)


@device
def _held(mask):
    """One in the lanes of the velocity components that are held."""
    held = mask | mask >> 3
    return vector(0.0, held & 1, (held >> 1) & 1, (held >> 2) & 1, 0.0, 0.0, 0.0, 0.0)
