"""The equation of motion at the nodes."""

from __future__ import annotations

import numpy as np

from mpmcol.jit import device, phase, prange
from mpmcol.state import NODE, TILE_DOUBLES, Grid, Settings, Tiles

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
    weight = abs(settings.gravity_x) + abs(settings.gravity_y)
    for k in prange(len(active)):
        before, after, damping, walls, unbalanced, mass = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for o in range(active[k], active[k] + TILE_DOUBLES, NODE):
            m, mask = nodes[o], fixed[o // NODE]
            if m <= floor:  # a mass that is not a number goes on to the points, where it is found
                nodes[o + 1 : o + NODE] = 0.0
                continue
            mass += m
            inv_m = 1.0 / m
            for axis in range(2):
                raw, f = nodes[o + 1 + axis] * inv_m, nodes[o + 4 + axis]  # Eq. 21
                if (mask >> axis) & 1:
                    v, a, drag, wall = _hold(m, raw, f, settings, dt)
                else:
                    v, a, drag, wall = _step(m, inv_m, raw, f, settings, dt)
                    unbalanced += abs(f)
                nodes[o + 1 + axis], nodes[o + 4 + axis] = v, a
                before += 0.5 * m * raw * raw
                after += 0.5 * m * v * v
                damping += drag
                walls += wall
        report[k, KINETIC_BEFORE], report[k, KINETIC_AFTER] = before, after
        report[k, DAMPING], report[k, WALLS] = damping, walls
        report[k, UNBALANCED], report[k, WEIGHT] = unbalanced, mass * weight


@device
def _step(m, inv_m, raw, f, settings, dt):
    """New velocity and acceleration of a free component, and the work of damping on it."""
    drag = settings.alpha_d * abs(f) if raw > 0.0 else (-settings.alpha_d * abs(f) if raw < 0.0 else 0.0)
    a = (f - drag) * inv_m  # Eq. 22, 23
    v = raw + dt * a  # Eq. 24
    return v, a, 0.5 * dt * drag * (raw + v), 0.0


@device
def _hold(m, raw, f, settings, dt):
    """Velocity and acceleration of a component that a wall holds, and the energy that goes into the wall."""
    kinetic = 0.5 * m * raw * raw
    if settings.wall_impulse:
        return 0.0, -raw / dt, 0.0, kinetic + 0.5 * dt * f * raw  # points move as if the node stopped in this step
    return 0.0, 0.0, 0.0, kinetic
