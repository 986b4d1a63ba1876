"""The step of the paper (section 2.1.4, update stress last), many times per call."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np

from mpmcol.grid import Grid
from mpmcol.jit import device, driver, phase, prange, variant
from mpmcol.kernels import stress_2d, stress_3d, transfer_2d, transfer_3d
from mpmcol.kernels.grid import (
    DAMPING,
    KINETIC_AFTER,
    KINETIC_BEFORE,
    UNBALANCED,
    WALLS,
    WEIGHT,
    clear,
    update_grid,
)  # fmt: skip
from mpmcol.kernels.transfer import make_p2g
from mpmcol.simd import LANES, any_positive, lane, larger, largest_lane, splat, sum_lanes, vector, where_positive
from mpmcol.state import Settings

# what a tile of points reports after G2P
SPEED, TRAVEL, WORK, NODE_WORK, FAULT, TILE_REPORT = range(6)
# clock of a run: numbers that change from step to step
TIME, DT, TRAVELLED, STEPS, CLOCK = range(5)
# ledger: sums since the start of the run (J, per metre or radian in two dimensions), and the rest of the last step
L_DAMPING, L_WALLS, L_WORK, L_NODE_WORK, L_GRID, L_KINETIC, L_UNBALANCED, LEDGER = range(8)

EDGE_CELLS = 2  # material this close to an open end of the domain stops the run
NO_FAULT = -1.0
TRANSFERS = {2: transfer_2d, 3: transfer_3d}
STRESSES = {2: stress_2d, 3: stress_3d}


class Box(NamedTuple):
    """Where material may be, m: the open ends of the domain are EDGE_CELLS beyond."""

    x_low: float
    x_high: float
    y_high: float
    z_low: float
    z_high: float


@device
def column_box(grid: Grid, settings: Settings) -> Box:
    """The box that the column must not leave."""
    edge, far = EDGE_CELLS * grid.h, np.inf
    return Box(
        grid.origin_x + edge if settings.open_low_sides else -far,
        grid.origin_x + (grid.n_x - 1) * grid.h - edge,
        grid.origin_y + (grid.n_y - 1) * grid.h - edge,
        grid.origin_z + edge if settings.open_low_sides else -far,
        grid.origin_z + (grid.n_z - 1) * grid.h - edge,
    )


def make_update_points(dimension: int, column_law: ModuleType, base_law: ModuleType) -> Callable[..., None]:
    """G2P and stress, tile by tile, with the dimension and the laws of column and base frozen in."""
    gather, limits, row = TRANSFERS[dimension].gather, TRANSFERS[dimension].limits, TRANSFERS[dimension].ROW
    column_stress = make_update_stresses(dimension, column_law)
    base_stress = make_update_stresses(dimension, base_law)

    @phase
    @variant(dimension, column_law, base_law)
    def update_points(rows, grid, tiles, settings, column, base, c2_column, c2_base, dt, report):
        """Move all points and update their stress.

        Reads: nodes (v~, a). Writes: rows, report (n_tiles, 5). Eq. (26)-(34), and c_p + |v_p| of Eq. (35)-(36).
        """
        nodes, start, split = grid.nodes, tiles.start, tiles.split
        inside, anywhere = column_box(grid, settings), Box(-np.inf, np.inf, np.inf, -np.inf, np.inf)
        bounds, inv_h = limits(grid, settings), 1.0 / grid.h
        for t in prange(len(split)):
            travel, node_work = splat(0.0), splat(0.0)
            for p in range(start[t], start[t + 1]):
                step, taken = gather(rows, p * row, nodes, grid, settings, bounds, dt)
                travel, node_work = larger(travel, abs(step)), node_work + taken
            report[t, TRAVEL] = inv_h * max(lane(travel, 4), lane(travel, 5), lane(travel, 6))
            report[t, NODE_WORK] = lane(node_work, 4) + lane(node_work, 5) + lane(node_work, 6)
            work, speed, fault = column_stress(rows, start[t], split[t], column, settings, inside, c2_column, dt)
            base_work, base_speed, base_fault = base_stress(
                rows, split[t], start[t + 1], base, settings, anywhere, c2_base, dt
            )
            report[t, WORK], report[t, SPEED] = work + base_work, max(speed, base_speed)
            report[t, FAULT] = fault if fault != NO_FAULT else base_fault

    return update_points


def make_update_stresses(dimension: int, law: ModuleType) -> Callable[..., Any]:
    """The stress update of a range of points, eight at a time."""
    update_stress, row = STRESSES[dimension].make_update_stress(law), TRANSFERS[dimension].ROW

    @device
    @variant(dimension, law)
    def update_stresses(rows, first, stop, params, settings, box, c2, dt):
        """Returns the stress work (J), the largest c_p + |v_p| (m/s), the row of the first bad point or NO_FAULT."""
        work, speed, fault = splat(0.0), splat(0.0), NO_FAULT
        for p in range(first, stop, LANES):
            count = min(stop - p, LANES)
            real = float(count) - vector(0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5)
            spent, fastest, sound = update_stress(rows, p * row, count, params, settings, box, c2, dt)
            work = work + where_positive(real, spent, 0.0)
            speed = larger(speed, where_positive(real, fastest, 0.0))
            bad = where_positive(real, 1.0 - sound, 0.0)
            if fault == NO_FAULT and any_positive(bad):
                fault = p + _first_positive(bad)
        return sum_lanes(work), largest_lane(speed), fault

    return update_stresses


@device
def _first_positive(value):
    """Number of the first lane above zero, as a real number."""
    first = vector(0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0)
    return -largest_lane(where_positive(value, -first, -float(LANES)))


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
def make_cycle(dimension: int, column_law: ModuleType, base_law: ModuleType) -> Callable[..., Any]:
    """The compiled loop over steps for this dimension and these two laws."""
    p2g = make_p2g(TRANSFERS[dimension])
    update_points = make_update_points(dimension, column_law, base_law)

    @driver
    @variant(dimension, column_law, base_law)
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
