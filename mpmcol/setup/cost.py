"""Estimate of the cost of a run: time, memory, disk."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from mpmcol.case import Case
from mpmcol.mpm.grid import NODE
from mpmcol.mpm.solver import Solver
from mpmcol.mpm.threads import set_threads
from mpmcol.setup.discretization import Discretization
from mpmcol.setup.durations import stage_durations
from mpmcol.setup.memory import memory_bytes
from mpmcol.setup.model import build_model, make_solver
from mpmcol.setup.unfit_settings import require_stiff_column

# time per point and step over that of the default method in two dimensions: `python -m scripts.peers.schemes`
THREE_DIMENSIONS = 1.6
BASIS_COST = {"quadratic": 1.0, "linear": 1.0, "cubic": 2.1}
TRANSFER_COST = {"apic": 1.6}  # others: 1
ORDER_COST = {"usl": 1.0, "usf": 1.8, "musl": 1.9}
TRIAL_SECONDS = 0.5  # of stepping, to measure the pace
SNAPSHOT_BYTES_PER_POINT = 98


@dataclass(frozen=True)
class Estimate:
    """Sizes and costs of a run."""

    points: int
    column_points: int
    nodes: int  # near material at the start
    tiles_of_group: tuple[int, ...]  # occupied tiles of each group; the tiles of a group are scattered in parallel
    dt: float  # s
    steps: int  # typical number
    most_steps: int  # for the longest durations that the case allows
    memory_bytes: int
    disk_bytes: int
    ns_per_point_step: float  # measured now
    seconds: float  # for `steps`
    most_seconds: float  # for `most_steps`
    compile_seconds: float  # to compile the kernels, or to load them from the cache
    warnings: tuple[str, ...]


def estimate(case: Case, threads: int | None = None) -> Estimate:
    """Build the model and step it for about half a second to measure its pace; no file is written.

    Raises UnfitCase if the model does not fit into memory, or if the column is too soft.
    """
    set_threads(threads)
    require_stiff_column(case)
    model = build_model(case)
    stage = model.equilibrate
    solver = make_solver(model, stage)
    started = time.perf_counter()
    solver.prepare()
    compile_seconds = time.perf_counter() - started
    dt, points = solver.dt, len(model.points)
    pace = _seconds_per_step(solver)
    assert solver.tiles is not None  # `prepare` sorts
    tiles = tuple(np.diff(solver.tiles.group_start).tolist())
    nodes = len(solver.tiles.active) * model.grid.tile_doubles // NODE

    typical, longest = durations(case, model.discretization)
    steps, most_steps = int(sum(typical) / dt), int(sum(longest) / dt)
    wanted = len(case.output.times) if case.output.times is not None else case.output.snapshots
    snapshots = 2 + min(wanted, most_steps)
    return Estimate(
        points=points,
        column_points=model.column_points,
        nodes=nodes,
        tiles_of_group=tiles,
        dt=dt,
        steps=steps,
        most_steps=most_steps,
        memory_bytes=memory_bytes(model.discretization),
        disk_bytes=snapshots * points * SNAPSHOT_BYTES_PER_POINT,
        ns_per_point_step=pace / points * 1e9,
        seconds=pace * steps,
        most_seconds=pace * most_steps,
        compile_seconds=compile_seconds,
        warnings=model.discretization.warnings,
    )


def durations(case: Case, discretization: Discretization) -> tuple[tuple[float, float], tuple[float, float]]:
    """Typical and longest durations of equilibration and collapse, s of simulated time."""
    return stage_durations(case, discretization.base)


def relative_pace(case: Case) -> float:
    """Time per point and step over that of the default method in two dimensions, roughly."""
    method = case.method
    scheme = BASIS_COST[method.basis] * TRANSFER_COST.get(method.transfer, 1.0) * ORDER_COST[method.stress_order]
    return scheme * (THREE_DIMENSIONS if case.geometry.dimension == 3 else 1.0)


def _seconds_per_step(solver: Solver) -> float:
    started = time.perf_counter()
    while time.perf_counter() - started < TRIAL_SECONDS and solver.advance(solver.time + 2000.0 * solver.dt) < 0:
        pass
    return (time.perf_counter() - started) / max(solver.steps, 1)
