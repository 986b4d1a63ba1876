"""Many steps (section 2.1.4 of the paper) per call, with the clock and the energy ledger."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from mpmcol.mpm.constitutive import ConstitutiveLaw
from mpmcol.mpm.jit import device, driver, variant
from mpmcol.mpm.kernels.grid_update import DAMPING, KINETIC_AFTER, KINETIC_BEFORE, UNBALANCED, WALLS, WEIGHT
from mpmcol.mpm.kernels.particle_update import FAULT, NO_FAULT, NODE_WORK, SPEED, TRAVEL, WORK
from mpmcol.mpm.kernels.step import make_step
from mpmcol.mpm.lanes import RECORD_SIZE
from mpmcol.mpm.settings import PAPER, Scheme
from mpmcol.mpm.shape_functions import SHAPE_FUNCTIONS
from mpmcol.mpm.simd import LANES

# clock of a run: numbers that change from step to step
TIME, DT, TRAVELLED, STEPS, CLOCK = range(5)
# ledger: sums since the start of the run (J, per metre or radian in two dimensions), and the rest of the last step
L_DAMPING, L_WALLS, L_WORK, L_NODE_WORK, L_GRID, L_KINETIC, L_UNBALANCED, LEDGER = range(8)


@device
def is_ordered(clock, reach):
    """Whether every point is less than `reach` cells away from where it was sorted."""
    return clock[TRAVELLED] < reach


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
def make_cycle(
    dimension: int, column_law: ConstitutiveLaw, base_law: ConstitutiveLaw, scheme: Scheme = PAPER
) -> Callable[..., Any]:
    """The compiled loop over steps for this dimension, these two laws and this scheme."""
    step, row = make_step(dimension, column_law, base_law, scheme), RECORD_SIZE[dimension]
    reach = SHAPE_FUNCTIONS[scheme.basis].TRAVEL_LIMIT
    lanes_moved = LANES if scheme.stress_order == "musl" else 0

    @driver
    @variant(dimension, column_law, base_law, *scheme)
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
        laws, moved = (column, base, c2_column, c2_base), np.empty(lanes_moved * (len(rows) // row))
        for _ in range(steps):
            if clock[TIME] >= end or not is_ordered(clock, reach):
                break
            dt = clock[DT]
            step(rows, grid, tiles, settings, laws, smallest_mass, dt, moved, node_report, tile_report)
            sum_nodes(node_report, ledger)
            clock[TIME] += dt
            clock[STEPS] += 1.0
            fault = sum_points(tile_report, ledger, clock, settings.cfl * grid.h)
            if fault != NO_FAULT:
                return fault
        return NO_FAULT

    return cycle
