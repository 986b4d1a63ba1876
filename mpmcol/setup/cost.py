"""What a run will cost, before it is started."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from mpmcol.case import Case
from mpmcol.mpm.grid import NODE
from mpmcol.mpm.jit import set_threads
from mpmcol.mpm.solver import Solver
from mpmcol.setup.discretization import Discretization
from mpmcol.setup.model import build_model

USUAL_TRANSITS = {"gravity": 7.0, "k0": 2.0}  # of a wave up and down, until a column rests behind the gate
USUAL_TAU = 5.0  # until a collapse rests
TRIAL_SECONDS = 1.0
BYTES_OF_POINT_IN_SNAPSHOT = 90


@dataclass(frozen=True)
class Estimate:
    """Sizes and costs of a run."""

    points: int
    column_points: int
    nodes: int  # that stand near material at the start
    tiles_of_group: tuple[int, ...]  # tiles that hold points, by group: those of one group are scattered in parallel
    dt: float  # s
    steps: int  # usual number
    most_steps: int  # if the case's longest durations are needed
    memory_bytes: int
    disk_bytes: int
    ns_per_point_step: float  # measured now
    seconds: float  # for the usual number of steps
    most_seconds: float
    compile_seconds: float  # to compile the kernels, or to load them if they are kept from before
    warnings: tuple[str, ...]


def estimate(case: Case, threads: int | None = None) -> Estimate:
    """Build the model and step it for about a second; writes nothing."""
    set_threads(threads)
    model = build_model(case)
    stage = model.equilibrate
    solver = Solver(model.points, model.grid, stage.settings, stage.column, model.base, model.scheme)
    started = time.perf_counter()
    solver.prepare()
    compiled = time.perf_counter() - started
    dt, points = solver.dt, len(model.points)
    pace = _seconds_per_step(solver)
    assert solver.tiles is not None  # `prepare` sorts
    tiles = tuple(np.diff(solver.tiles.group_start).tolist())
    nodes = len(solver.tiles.active) * model.grid.tile_doubles // NODE

    usual, longest = durations(case, model.discretization)
    steps, most_steps = int(sum(usual) / dt), int(sum(longest) / dt)
    snapshots = 2 + (len(case.output.times) if case.output.times is not None else case.output.snapshots)
    return Estimate(
        points=points,
        column_points=model.column_points,
        nodes=nodes,
        tiles_of_group=tiles,
        dt=dt,
        steps=steps,
        most_steps=most_steps,
        memory_bytes=model.discretization.memory_bytes,
        disk_bytes=snapshots * points * BYTES_OF_POINT_IN_SNAPSHOT,
        ns_per_point_step=pace / points * 1e9,
        seconds=pace * steps,
        most_seconds=pace * most_steps,
        compile_seconds=compiled,
        warnings=model.discretization.warnings,
    )


def durations(case: Case, discretization: Discretization) -> tuple[tuple[float, float], tuple[float, float]]:
    """How long equilibration and collapse usually last, and at most, in s of the simulation."""
    stages, tau = case.stages, discretization.fall_time(case.geometry.gravity)
    transit, lifting = discretization.wave_time(case.material.wave_speed**2), discretization.h_i / stages.gate_speed
    longest = stages.equilibrate.max_time_factor * transit, stages.collapse.max_time_factor * tau + lifting
    settling = USUAL_TRANSITS[stages.initial_stress] * transit
    usual = min(settling, longest[0]), min(USUAL_TAU * tau + lifting, longest[1])
    return usual, longest


def _seconds_per_step(solver: Solver) -> float:
    started = time.perf_counter()
    while time.perf_counter() - started < TRIAL_SECONDS and solver.advance(solver.time + 2000.0 * solver.dt) < 0:
        pass
    return (time.perf_counter() - started) / max(solver.steps, 1)
