"""The equation of motion at the nodes."""

from __future__ import annotations

import numpy as np

from mpmcol.jit import device, phase, prange
from mpmcol.state import NODE, TILE_NODES, Grid, Settings, Tiles

# what a tile of nodes reports, summed later in a fixed order
KINETIC_BEFORE, KINETIC_AFTER, DAMPING, WALLS, UNBALANCED, WEIGHT, NODE_REPORT = range(7)
# Share of the smallest point mass under which a node is left alone. It only guards 0 / 0: a spline's force and mass
# vanish together, and a node cut off by a larger floor would kick the points that just reach it.
MASS_FLOOR = 1e-20


@phase
def update_grid(
    grid: Grid, tiles: Tiles, settings: Settings, smallest_mass: float, dt: float, report: np.ndarray
) -> None:
    """Momentum to velocity, acceleration with damping, explicit update, walls before and after.

    Reads: nodes (m, mv, f), fixed. Writes: nodes (v~, a), report (n_active, 6). Eq. (21)-(24).
    """
    nodes, fixed, active = grid.nodes, grid.fixed, tiles.active
    floor = MASS_FLOOR * smallest_mass
    for k in prange(len(active)):
        for quantity in range(NODE_REPORT):
            report[k, quantity] = 0.0
        for node in range(TILE_NODES):
            o = active[k] + node * NODE
            if nodes[o] <= floor:
                nodes[o + 1 : o + NODE] = 0.0
            else:  # a mass that is not a number goes on to the points, where it is found
                _update_node(nodes, o, fixed[o // NODE], settings, dt, report, k)


@device
def _update_node(nodes, o, mask, settings, dt, report, k):
    """One node with mass; adds its energies to row `k` of the report."""
    m = nodes[o]
    inv_m = 1.0 / m
    _update_component(nodes, o + 1, mask & 1, m, inv_m, settings, dt, report, k)
    _update_component(nodes, o + 2, mask & 2, m, inv_m, settings, dt, report, k)
    report[k, WEIGHT] += m * (abs(settings.gravity_x) + abs(settings.gravity_y))
    nodes[o + 3] = 0.0
    nodes[o + 6] = 0.0


@device
def _update_component(nodes, at, is_fixed, m, inv_m, settings, dt, report, k):
    """One velocity component (`at`) and the force three lanes on."""
    raw = nodes[at] * inv_m  # Eq. 21
    kinetic = 0.5 * m * raw * raw
    report[k, KINETIC_BEFORE] += kinetic
    f = nodes[at + 3]
    if is_fixed:
        report[k, WALLS] += kinetic
        nodes[at] = 0.0
        nodes[at + 3] = 0.0
        if settings.wall_impulse:
            report[k, WALLS] += 0.5 * dt * f * raw  # points move as if the wall had stopped the node in this step
            nodes[at + 3] = -raw / dt
        return
    drag = settings.alpha_d * abs(f) if raw > 0.0 else (-settings.alpha_d * abs(f) if raw < 0.0 else 0.0)
    a = (f - drag) * inv_m  # Eq. 22, 23
    v = raw + dt * a  # Eq. 24
    report[k, KINETIC_AFTER] += 0.5 * m * v * v
    report[k, DAMPING] += 0.5 * dt * drag * (raw + v)
    report[k, UNBALANCED] += abs(f)
    nodes[at] = v
    nodes[at + 3] = a
