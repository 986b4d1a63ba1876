"""Equation of motion at the nodes."""

from __future__ import annotations

import numpy as np

from mpmcol.mpm.boundary import CONTACT_BIT, constrain, held_components, reaction_factors
from mpmcol.mpm.contact import Contacts, slide_on_walls, touch_walls
from mpmcol.mpm.grid import NODE, Grid, Tiles
from mpmcol.mpm.jit import device, phase, prange, subroutine
from mpmcol.mpm.lanes import Q
from mpmcol.mpm.settings import Settings
from mpmcol.mpm.simd import fma, load, reduce_sum, splat, store, swap_halves, vector, where_positive

# sums over a tile of nodes, added later in a fixed order
KINETIC_BEFORE, KINETIC_AFTER, DAMPING, WALLS, STRESS_WORK, UNBALANCED, WEIGHT, NODE_REPORT = range(8)
# Nodes of less than this share of the smallest point mass are skipped, only to prevent 0 / 0: force and mass of a
# B-spline vanish together, and a larger threshold would cause spurious forces on points at the edge of a support.
MASS_FLOOR = 1e-20


@phase
def clear(grid: Grid, tiles: Tiles) -> None:
    """Set the nodes of all active tiles to zero.

    Reads: active. Writes: nodes. Eq. (19)-(20), initial values.
    """
    nodes, active, size = grid.nodes, tiles.active, grid.tile_doubles
    for t in prange(len(active)):
        clear_tile(nodes, active[t], size)


@device
def clear_tile(nodes: np.ndarray, first: int, size: int) -> None:
    """Set the nodes of a tile of `size` doubles to zero."""
    for o in range(first, first + size, NODE):
        store(nodes, o, splat(0.0))


@phase
def update_grid(
    grid: Grid,
    spare: np.ndarray,
    contacts: Contacts,
    tiles: Tiles,
    settings: Settings,
    smallest_mass: float,
    dt: float,
    report: np.ndarray,
) -> None:
    """Velocity and acceleration from momentum and force, with damping and boundary conditions.

    The same tiles of `spare`, the nodes of the next step, are set to zero, unless it is empty.
    Reads: nodes (m, mv, f, m q), fixed, contacts. Writes: nodes (v~, a, q), spare, sums of contacts,
    report (n_active, 7). Eq. (21)-(24).
    """
    active, floor = tiles.active, MASS_FLOOR * smallest_mass
    for t in prange(len(active)):
        if len(spare) > 0:
            clear_tile(spare, active[t], grid.tile_doubles)
        update_tile(active[t], grid, contacts, settings, floor, dt, report[t])


@subroutine
def update_tile(
    first: int, grid: Grid, contacts: Contacts, settings: Settings, floor: float, dt: float, report: np.ndarray
) -> None:
    """The same for the tile of nodes whose first is at address `first`; nodes of mass up to `floor` (kg) are skipped.

    Reads: nodes (m, mv, f, m q), fixed, contacts. Writes: nodes (v~, a, q), sums of contacts, report (7,).
    Eq. (21)-(24).
    """
    nodes, fixed, slot = grid.nodes, grid.fixed, contacts.slot
    weight = abs(settings.gravity_x) + abs(settings.gravity_y) + abs(settings.gravity_z)
    vectors, zero = vector(0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0), splat(0.0)
    factors, mass = reaction_factors(settings, dt), 0.0
    gravity = vector(0.0, settings.gravity_x, settings.gravity_y, settings.gravity_z, 0.0, 0.0, 0.0, 0.0)
    before, after, damping, walls, stress_work, unbalanced = zero, zero, zero, zero, zero, zero
    for o in range(first, first + grid.tile_doubles, NODE):
        m = nodes[o]
        if m <= floor:  # false for NaN, which the check of the points then finds
            store(nodes, o, zero)
            continue
        rates, m_i = load(nodes, o) * (1.0 / m), splat(m)
        raw, f = rates * vectors, swap_halves(rates) * vectors  # Eq. 21; f per mass
        drag = settings.alpha_d * where_positive(raw, abs(f), where_positive(-raw, -abs(f), 0.0))  # Eq. 23
        mask = fixed[o // NODE]
        held, v, a, wall_work = constrain(mask, raw, f, f - drag, dt, factors)  # Eq. 22, 24
        if mask & CONTACT_BIT:
            held, v, a, wall_work = touch_walls(contacts, slot[o // NODE], m, raw, f, held, v, a, wall_work, dt)
        store(nodes, o, vector(m, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, nodes[o + Q] / m) + v + swap_halves(a))
        mass += m
        before, after = fma(m_i * raw, raw, before), fma(m_i * v, v, after)
        damping = fma(m_i, where_positive(held, 0.0, drag * (raw + v)), damping)
        walls = fma(m_i, wall_work, walls)
        stress_work = fma(m_i * (gravity - f), v - (0.5 * dt) * a, stress_work)  # of the stress of the points, Eq. 13
        unbalanced = fma(m_i, where_positive(held, 0.0, abs(f)), unbalanced)
    report[KINETIC_BEFORE], report[KINETIC_AFTER] = 0.5 * reduce_sum(before), 0.5 * reduce_sum(after)
    report[DAMPING], report[WALLS] = 0.5 * dt * reduce_sum(damping), 0.5 * reduce_sum(walls)
    report[STRESS_WORK] = dt * reduce_sum(stress_work)
    report[UNBALANCED], report[WEIGHT] = reduce_sum(unbalanced), mass * weight


@phase
def find_velocities(grid: Grid, contacts: Contacts, tiles: Tiles, smallest_mass: float) -> None:
    """Velocity from momentum, zero where a boundary holds it, for a stress update without motion.

    Walls with friction act as in `update_grid`, on the velocity alone. Reads: nodes (m, mv, m q), fixed, contacts.
    Writes: nodes (m, v, q). Eq. (21).
    """
    active, floor = tiles.active, MASS_FLOOR * smallest_mass
    for t in prange(len(active)):
        find_tile_velocities(active[t], grid, contacts, floor)


@subroutine
def find_tile_velocities(first: int, grid: Grid, contacts: Contacts, floor: float) -> None:
    """The same for the tile of nodes whose first is at address `first`.

    Reads: nodes (m, mv, m q), fixed, contacts. Writes: nodes (m, v, q). Eq. (21).
    """
    nodes, fixed, slot = grid.nodes, grid.fixed, contacts.slot
    vectors, zero = vector(0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0), splat(0.0)
    for o in range(first, first + grid.tile_doubles, NODE):
        m = nodes[o]
        if m <= floor:
            store(nodes, o, zero)
        else:
            mask = fixed[o // NODE]
            v = where_positive(held_components(mask), 0.0, load(nodes, o) * (1.0 / m) * vectors)
            if mask & CONTACT_BIT:
                v = slide_on_walls(contacts, slot[o // NODE], v)
            store(nodes, o, vector(m, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, nodes[o + Q] / m) + v)
