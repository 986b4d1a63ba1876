"""Loops over steps that note the time after every phase: the compiled step itself, and its plain twin."""

# Compiled functions take what Numba infers.
# mypy: allow-untyped-defs
# ruff: noqa: ANN001, ANN201

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from types import ModuleType
from typing import Any

from mpmcol.bench import plain_2d as plain
from mpmcol.bench.clock import seconds
from mpmcol.bench.plain_stress_2d import make_update_stress
from mpmcol.jit import driver, phase, prange
from mpmcol.kernels.cycle_2d import DT, make_update_points, sum_nodes, sum_points
from mpmcol.kernels.grid_2d import update_grid
from mpmcol.kernels.transfer_2d import clear, gather, keep_off_walls, p2g
from mpmcol.state import ROW

VECTOR_PHASES = ("clear", "p2g", "update_grid", "update_points", "sums")
PLAIN_PHASES = ("clear", "p2g", "update_grid", "g2p", "stress")


@cache
def make_vector_steps(column_law: ModuleType, base_law: ModuleType) -> Callable[..., Any]:
    """The step of `kernels.cycle_2d` with a clock reading before and after each of VECTOR_PHASES."""
    update_points = make_update_points(column_law, base_law)

    @driver
    def vector_steps(
        rows, grid, tiles, settings, column, base, c2_column, c2_base, smallest_mass, reports, clock, ledger, times
    ):
        """As many steps as `times` (n, 6) has rows.

        Reads: settings, params. Writes: rows, nodes, reports, clock, ledger, times. Eq. (13)-(36).
        """
        node_report, tile_report = reports
        for k in range(len(times)):
            dt = clock[DT]
            times[k, 0] = seconds()
            clear(grid, tiles)
            times[k, 1] = seconds()
            p2g(rows, grid, tiles, settings)
            times[k, 2] = seconds()
            update_grid(grid, tiles, settings, smallest_mass, dt, node_report)
            times[k, 3] = seconds()
            update_points(rows, grid, tiles, settings, column, base, c2_column, c2_base, dt, tile_report)
            times[k, 4] = seconds()
            sum_nodes(node_report, ledger)
            sum_points(tile_report, ledger, clock, settings.cfl * grid.h)
            times[k, 5] = seconds()

    return vector_steps


@cache
def make_plain_steps(column_law: ModuleType, base_law: ModuleType) -> Callable[..., Any]:
    """The plain loops with a clock reading before and after each of PLAIN_PHASES."""
    update_stress = make_update_stress(column_law, base_law)

    @driver
    def plain_steps(
        points, grid, tiles, settings, column, base, c2_column, c2_base, smallest_mass, reports, clock, times
    ):
        """As many steps as `times` (n, 6) has rows.

        Reads: settings, params. Writes: points, grid, reports, clock, times. Eq. (13)-(36).
        """
        node_report, tile_report = reports
        for k in range(len(times)):
            dt = clock[DT]
            times[k, 0] = seconds()
            plain.clear(grid)
            times[k, 1] = seconds()
            plain.p2g(points, grid, tiles, settings)
            times[k, 2] = seconds()
            plain.update_grid(grid, settings, smallest_mass, dt, node_report)
            times[k, 3] = seconds()
            plain.g2p(points, grid, tiles, settings, dt)
            times[k, 4] = seconds()
            update_stress(points, tiles, settings, column, base, c2_column, c2_base, dt, tile_report)
            clock[DT] = settings.cfl * grid.h / tile_report[:, 0].max()
            times[k, 5] = seconds()

    return plain_steps


@phase
def _gather_all(rows, grid, tiles, settings, dt, report):
    """G2P of all points without their stress.

    Reads: nodes. Writes: rows, report. Eq. (26)-(28).
    """
    nodes, start = grid.nodes, tiles.start
    for t in prange(len(start) - 1):
        travel = 0.0
        for p in range(start[t], start[t + 1]):
            moved, _ = gather(rows, p * ROW, nodes, grid, settings, dt)
            travel = max(travel, moved)
            keep_off_walls(rows, p * ROW, grid, settings)
        report[t, 0] = travel


@driver
def gather_alone(rows, grid, tiles, settings, dt, report, times):
    """G2P as often as `times` (n, 2) has rows, on records that nobody needs any more.

    Reads: nodes. Writes: rows, report, times. Eq. (26)-(28).
    """
    for k in range(len(times)):
        times[k, 0] = seconds()
        _gather_all(rows, grid, tiles, settings, dt, report)
        times[k, 1] = seconds()
