"""Loops over steps that read the clock after every phase: the step of the solver, and that of the plain loops."""

# Compiled functions take what Numba infers.
# mypy: allow-untyped-defs
# ruff: noqa: ANN001

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from mpmcol.bench.clock import seconds
from mpmcol.bench.plain_loops import common, transfer_2d, transfer_3d
from mpmcol.mpm.constitutive import ConstitutiveLaw
from mpmcol.mpm.jit import driver, make_unpack, phase, prange, variant
from mpmcol.mpm.kernels.grid_update import update_grid
from mpmcol.mpm.kernels.loop import DT, sum_nodes, sum_points
from mpmcol.mpm.kernels.particle_update import make_update_points
from mpmcol.mpm.kernels.step import make_begin
from mpmcol.mpm.kernels.transfer import make_move_points, make_p2g
from mpmcol.mpm.settings import PAPER

VECTOR_PHASES = ("update_grid", "update_points", "sums")
PLAIN_PHASES = ("clear", "p2g", "update_grid", "g2p", "stress")
PLAIN_TRANSFERS = {2: transfer_2d, 3: transfer_3d}


@cache
def make_vector_steps(dimension: int, column_law: ConstitutiveLaw, base_law: ConstitutiveLaw) -> Callable[..., Any]:
    """The step of `kernels.loop` with a clock reading before and after each of VECTOR_PHASES."""
    begin, update_points = make_begin(dimension, PAPER), make_update_points(dimension, column_law, base_law)

    @driver
    @variant(dimension, column_law, base_law)
    def vector_steps(state, times):
        """As many steps as `times` (n, 4) has rows.

        Reads: settings, bodies. Writes: rows, nodes, reports, clock, ledger, times. Eq. (13)-(36).
        """
        (
            rows,
            grid,
            spare,
            contacts,
            tiles,
            shares,
            settings,
            bodies,
            smallest_mass,
            node_report,
            tile_report,
            clock,
            ledger,
        ) = state
        column, base, c2_column, c2_base = bodies
        begin(state)
        for k in range(len(times)):
            dt = clock[DT]
            times[k, 0] = seconds()
            update_grid(grid, spare.nodes, contacts, tiles, settings, smallest_mass, dt, node_report)
            times[k, 1] = seconds()
            side_rate = dt * contacts.side_friction
            update_points(
                rows, grid, spare, tiles, shares, settings, column, base, c2_column, c2_base, dt, side_rate, True,
                tile_report,
            )  # fmt: skip
            times[k, 2] = seconds()
            sum_nodes(node_report, ledger)
            sum_points(tile_report, ledger, clock, settings.cfl * grid.h)
            times[k, 3] = seconds()
            grid, spare = spare, grid

    return vector_steps


@cache
def make_plain_steps(dimension: int, column_law: ConstitutiveLaw, base_law: ConstitutiveLaw) -> Callable[..., Any]:
    """The plain loops with a clock reading before and after each of PLAIN_PHASES."""
    update_stress = common.make_update_stress(dimension, column_law, base_law)
    p2g, g2p = PLAIN_TRANSFERS[dimension].p2g, PLAIN_TRANSFERS[dimension].g2p
    Params = column_law.PARAMS
    unpack = make_unpack(len(Params._fields))

    @driver
    @variant(dimension, column_law, base_law)
    def plain_steps(state, times):
        """As many steps as `times` (n, 6) has rows.

        Reads: settings, bodies. Writes: points, grid, reports, clock, times. Eq. (13)-(36).
        """
        points, grid, tiles, settings, bodies, smallest_mass, node_report, tile_report, clock = state
        column, base, c2_column, c2_base = bodies
        for k in range(len(times)):
            dt = clock[DT]
            times[k, 0] = seconds()
            common.clear(grid)
            times[k, 1] = seconds()
            p2g(points, grid, tiles, settings)
            times[k, 2] = seconds()
            common.update_grid(grid, settings, smallest_mass, dt, node_report)
            times[k, 3] = seconds()
            g2p(points, grid, tiles, settings, dt)
            times[k, 4] = seconds()
            update_stress(
                points, tiles, settings, Params(*unpack(column[0])), base, c2_column[0], c2_base, dt, tile_report
            )
            clock[DT] = settings.cfl * grid.h / tile_report[:, 0].max()
            times[k, 5] = seconds()

    return plain_steps


@cache
def make_transfers(dimension: int) -> Callable[..., Any]:
    """P2G and G2P of all points, each alone."""
    p2g, move_points = make_p2g(dimension, "quadratic"), make_move_points(dimension, "quadratic", affine=False)

    @phase
    @variant(dimension)
    def g2p(rows, grid, tiles, settings, dt, report):
        """Reads: nodes. Writes: rows, report. Eq. (26)-(28)."""
        start = tiles.start
        for t in prange(len(start) - 1):
            averages = np.empty(start[t + 1] - start[t])
            report[t, 0], report[t, 1] = move_points(
                rows, start[t], start[t + 1], start[t + 1], grid, settings, dt, averages, averages
            )

    @driver
    @variant(dimension)
    def transfers(state, rows, times):
        """As often as `times` (n, 3) has rows, from and to records `rows` that are not used afterwards.

        Reads: nodes. Writes: rows, spare nodes, report, times. Eq. (13)-(20), (26)-(28).
        """
        dt = state.clock[DT]
        for k in range(len(times)):
            times[k, 0] = seconds()
            p2g(rows, state.spare, state.tiles, state.shares, state.settings)
            times[k, 1] = seconds()
            g2p(rows, state.grid, state.tiles, state.settings, dt, state.tile_report)
            times[k, 2] = seconds()

    return transfers
