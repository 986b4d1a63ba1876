"""The loop over time steps (section 2.1.4 of the paper), with clock and energy ledger."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from mpmcol.mpm.constitutive import ConstitutiveLaw
from mpmcol.mpm.jit import device, driver, subroutine, variant
from mpmcol.mpm.kernels.grid_update import (
    DAMPING,
    KINETIC_AFTER,
    KINETIC_BEFORE,
    STRESS_WORK,
    UNBALANCED,
    WALLS,
    WEIGHT,
)
from mpmcol.mpm.kernels.particle_update import FAULT, FILTER, LIMIT_WORK, SIDE_WORK, SPEED, TRAVEL, WORK
from mpmcol.mpm.kernels.side_walls import sum_side_work
from mpmcol.mpm.kernels.step import alternates, make_steps
from mpmcol.mpm.kernels.stress import NO_FAULT
from mpmcol.mpm.lanes import LANES, RECORD_SIZE
from mpmcol.mpm.settings import PAPER, Scheme
from mpmcol.mpm.shape_functions import SHAPE_FUNCTIONS

# clock: numbers that change from step to step; TRAVELLED is the largest travel since the last sort, in cells
TIME, DT, TRAVELLED, STEPS, CLOCK = range(5)
# ledger: sums since the start of the run, J (per metre or radian in two dimensions); kinetic energy of the nodes, J,
# and unbalanced force ratio of the last step
L_DAMPING, L_WALLS, L_WORK, L_NODE_WORK, L_GRID, L_FILTER, L_KINETIC, L_UNBALANCED, LEDGER = range(9)


@device
def is_sorted(clock, travel_limit):
    """Whether every point is less than `travel_limit` cells from where it was sorted."""
    return clock[TRAVELLED] < travel_limit


@subroutine
def sum_nodes(report, ledger):
    """Add the reports of the grid update to the ledger, in a fixed order.

    Reads: report. Writes: ledger. Eq. (21)-(24).
    """
    before, after, damping, walls, stress_work, unbalanced, weight = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(len(report)):
        before += report[k, KINETIC_BEFORE]
        after += report[k, KINETIC_AFTER]
        damping += report[k, DAMPING]
        walls += report[k, WALLS]
        stress_work += report[k, STRESS_WORK]
        unbalanced += report[k, UNBALANCED]
        weight += report[k, WEIGHT]
    ledger[L_DAMPING] += damping
    ledger[L_WALLS] += walls
    ledger[L_NODE_WORK] += stress_work
    ledger[L_GRID] += after - before
    ledger[L_KINETIC] = after
    ledger[L_UNBALANCED] = unbalanced / weight if weight > 0.0 else 0.0


@subroutine
def sum_points(report, ledger, clock, courant):
    """Add the reports of the points to ledger and clock, with the new time step; returns the first invalid point.

    courant: time.cfl times h. Reads: report. Writes: ledger, clock. Eq. (35).
    """
    speed, travel, work, limit_work, lost, fault = 0.0, 0.0, 0.0, 0.0, 0.0, NO_FAULT
    for t in range(len(report)):
        speed = max(speed, report[t, SPEED])
        travel = max(travel, report[t, TRAVEL])
        work += report[t, WORK]
        limit_work += report[t, LIMIT_WORK]
        lost += report[t, FILTER]
        if fault == NO_FAULT:
            fault = report[t, FAULT]
    ledger[L_WORK] += work
    ledger[L_NODE_WORK] += limit_work
    ledger[L_FILTER] += lost
    clock[TRAVELLED] += travel
    clock[DT] = courant / speed
    return fault


@cache
def make_time_loop(
    dimension: int, column_law: ConstitutiveLaw, base_law: ConstitutiveLaw, scheme: Scheme = PAPER
) -> Callable[..., Any]:
    """The compiled loop over time steps for this dimension, these two laws and this scheme."""
    begin, step = make_steps(dimension, column_law, base_law, scheme)
    in_turn, size = alternates(scheme), RECORD_SIZE[dimension]
    travel_limit = SHAPE_FUNCTIONS[scheme.basis].TRAVEL_LIMIT
    plane = dimension == 2
    pending_size = LANES if scheme.stress_order == "musl" else 0

    @driver
    @variant(dimension, column_law, base_law, *scheme)
    def time_loop(state, end, steps):
        """Step until `clock[TIME] >= end`, `steps` are done, points must be sorted again, or one is invalid.

        Reads: settings, bodies. Writes: rows, nodes, reports, clock, ledger. Eq. (13)-(36). Returns the row of the
        first invalid point, or -1.
        """
        clock, ledger, courant = state.clock, state.ledger, state.settings.cfl * state.grid.h
        contacts = state.contacts
        pending = np.empty(pending_size * (len(state.rows) // size))
        grid, spare, fault = state.grid, state.spare, NO_FAULT
        for k in range(steps):
            if fault != NO_FAULT or clock[TIME] >= end or not is_sorted(clock, travel_limit):
                break
            if k == 0:
                begin(state)
            elif in_turn:
                grid, spare = spare, grid
            dt = clock[DT]
            step(state, grid, spare, dt, k + 1 < steps and clock[TIME] + dt < end, pending)
            if plane and contacts.side_friction > 0.0:
                sum_side_work(state.tile_report[:, SIDE_WORK], contacts)
            sum_nodes(state.node_report, ledger)
            clock[TIME] += dt
            clock[STEPS] += 1.0
            fault = sum_points(state.tile_report, ledger, clock, courant)
        return fault

    return time_loop
