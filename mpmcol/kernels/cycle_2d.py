"""The step of the paper (section 2.1.4, update stress last), many times per call."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import sqrt
from types import ModuleType
from typing import Any

from mpmcol.jit import device, driver, phase, prange
from mpmcol.kernels.grid_2d import (
    DAMPING,
    KINETIC_AFTER,
    KINETIC_BEFORE,
    UNBALANCED,
    WALLS,
    WEIGHT,
    update_grid,
)  # fmt: skip
from mpmcol.kernels.stress_2d import make_update_stress
from mpmcol.kernels.transfer_2d import clear, gather, keep_off_walls, p2g
from mpmcol.state import ROW, VX, VY, J, X, Y

# what a tile of points reports after G2P
SPEED, TRAVEL, WORK, NODE_WORK, FAULT, TILE_REPORT = range(6)
# clock of a run: numbers that change from step to step
TIME, DT, TRAVELLED, STEPS, CLOCK = range(5)
# ledger: sums since the start of the run (J per metre or radian), and the state of rest of the last step
L_DAMPING, L_WALLS, L_WORK, L_NODE_WORK, L_GRID, L_KINETIC, L_UNBALANCED, LEDGER = range(8)

J_MIN, J_MAX = 0.1, 50.0
EDGE_CELLS = 2  # material this close to an open end of the domain stops the run
NO_FAULT = -1.0


def make_update_points(column_law: ModuleType, base_law: ModuleType) -> Callable[..., None]:
    """G2P and stress, tile by tile, with the laws of column and base frozen in."""
    column_stress, base_stress = make_update_stress(column_law), make_update_stress(base_law)

    @phase
    def update_points(rows, grid, tiles, settings, column, base, c2_column, c2_base, dt, report):
        """Move all points and update their stress.

        Reads: nodes (v~, a). Writes: rows, report (n_tiles, 5). Eq. (26)-(34), and c_p + |v_p| of Eq. (35)-(36).
        """
        nodes, start, split = grid.nodes, tiles.start, tiles.split
        for t in prange(len(split)):
            speed, travel, work, node_work, fault = 0.0, 0.0, 0.0, 0.0, NO_FAULT
            for p in range(start[t], start[t + 1]):
                moved, taken = gather(rows, p * ROW, nodes, grid, settings, dt)
                travel = max(travel, moved)
                node_work += taken
                keep_off_walls(rows, p * ROW, grid, settings)
            for p in range(start[t], split[t]):
                work += column_stress(rows, p * ROW, column, settings, dt)
                fastest, is_sound = _inspect(rows, p * ROW, c2_column)
                speed = max(speed, fastest)
                if fault == NO_FAULT and not (is_sound and _is_inside(rows, p * ROW, grid)):
                    fault = p
            for p in range(split[t], start[t + 1]):
                work += base_stress(rows, p * ROW, base, settings, dt)
                fastest, is_sound = _inspect(rows, p * ROW, c2_base)
                speed = max(speed, fastest)
                if fault == NO_FAULT and not is_sound:
                    fault = p
            report[t, SPEED], report[t, TRAVEL], report[t, FAULT] = speed, travel, fault
            report[t, WORK], report[t, NODE_WORK] = work, node_work

    return update_points


@device
def _inspect(rows, o, c2):
    """Wave speed plus speed of a point, and whether it is finite and slower than its waves."""
    c2_p = c2 * rows[o + J]  # Eq. 36 at the current density
    v2 = rows[o + VX] * rows[o + VX] + rows[o + VY] * rows[o + VY]
    return sqrt(c2_p) + sqrt(v2), v2 <= c2_p and rows[o + J] >= J_MIN and rows[o + J] <= J_MAX


@device
def _is_inside(rows, o, grid):
    """Whether a point of the column is two cells away from the open ends of the domain."""
    right = grid.origin_x + (grid.n_x - 1 - EDGE_CELLS) * grid.h
    return rows[o + X] < right and rows[o + Y] < grid.origin_y + (grid.n_y - 1 - EDGE_CELLS) * grid.h


@device
def is_ordered(clock):
    """Whether every point is less than one cell away from where it was sorted."""
    return clock[TRAVELLED] < 1.0


@device
def sum_nodes(report, ledger):
    """Add the report of the grid to the ledger, in a fixed order."""
    before, after, damping, walls, unbalanced, weight = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(len(report)):
        before += report[k, KINETIC_BEFORE]
        after += report[k, KINETIC_AFTER]
        damping += report[k, DAMPING]
        walls += report[k, WALLS]
        unbalanced += report[k, UNBALANCED]
        weight += report[k, WEIGHT]
    ledger[L_DAMPING] += damping
    ledger[L_WALLS] += walls
    ledger[L_GRID] += after - before
    ledger[L_KINETIC] = after
    ledger[L_UNBALANCED] = unbalanced / weight if weight > 0.0 else 0.0


@device
def sum_points(report, ledger, clock, courant):
    """Time step of Eq. 35, travel and stress work from the report of the points; returns the first bad point."""
    speed, travel, work, node_work, fault = 0.0, 0.0, 0.0, 0.0, NO_FAULT
    for t in range(len(report)):
        speed = max(speed, report[t, SPEED])
        travel = max(travel, report[t, TRAVEL])
        work += report[t, WORK]
        node_work += report[t, NODE_WORK]
        if fault == NO_FAULT:
            fault = report[t, FAULT]
    ledger[L_WORK] += work
    ledger[L_NODE_WORK] += node_work
    clock[TRAVELLED] += travel
    clock[DT] = courant / speed
    return fault


@cache
def make_cycle(column_law: ModuleType, base_law: ModuleType) -> Callable[..., Any]:
    """The compiled loop over steps for these two laws."""
    update_points = make_update_points(column_law, base_law)

    @driver
    def cycle(
        rows,
        grid,
        tiles,
        settings,
        column,
        base,
        c2_column,
        c2_base,
        smallest_mass,
        reports,
        clock,
        ledger,
        end,
        steps,
    ):
        """Step until `clock[TIME] >= end`, `steps` are done, points are out of order, or one goes wrong.

        Reads: settings, params. Writes: rows, nodes, reports, clock, ledger. Eq. (13)-(36). Returns the row of the
        first bad point, or -1.
        """
        node_report, tile_report = reports
        for _ in range(steps):
            if clock[TIME] >= end or not is_ordered(clock):
                break
            dt = clock[DT]
            clear(grid, tiles)
            p2g(rows, grid, tiles, settings)
            update_grid(grid, tiles, settings, smallest_mass, dt, node_report)
            update_points(rows, grid, tiles, settings, column, base, c2_column, c2_base, dt, tile_report)
            sum_nodes(node_report, ledger)
            clock[TIME] += dt
            clock[STEPS] += 1.0
            fault = sum_points(tile_report, ledger, clock, settings.cfl * grid.h)
            if fault != NO_FAULT:
                return fault
        return NO_FAULT

    return cycle
