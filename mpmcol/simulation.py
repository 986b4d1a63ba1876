"""A run from beginning to end: equilibrate, release, collapse, rest, result."""

from __future__ import annotations

import time
from collections.abc import Callable
from math import sqrt
from pathlib import Path
from typing import Any

import numpy as np

from mpmcol.case import Case, case_hash
from mpmcol.errors import NumericalFailure
from mpmcol.experiments import score
from mpmcol.faults import diagnose, message
from mpmcol.jit import set_threads
from mpmcol.kernels import cycle_2d as cycle
from mpmcol.recorder import Recorder, describe, versions
from mpmcol.results import RESULT_SCHEMA, Results, measure_snapshot, prepare_folder, write_result
from mpmcol.scene import Scene, Stage, build_scene, close_walls
from mpmcol.solver import Solver

Progress = Callable[[str, float], None]  # stage, share of it that is done
Say = Callable[[str], None]  # one line for the person who waits

CHECKS_PER_TAU = 50
REST_WINDOW = 0.2  # in tau: the column rests when it has been quiet for this long
REST_ENERGY = 1e-5  # grid kinetic energy over m g h_i
REST_FRONT = 0.1  # in h
CALM_CHECKS = 3  # checks in a row under the tolerance that end the equilibration


class Run:
    """One run of a case into a folder; `outcome` is the content of result.json."""

    def __init__(self, case: Case, folder: Path, threads: int, progress: Progress, say: Say) -> None:
        self.case, self.folder, self.threads = case, folder, threads
        self.progress, self.say = progress, say
        self.scene: Scene = build_scene(case)
        for warning in self.scene.layout.warnings:
            say(f"note: {warning}")
        stage = self.scene.equilibrate
        self.solver = Solver(self.scene.points, self.scene.grid, stage.settings, stage.column, self.scene.base)
        self.recorder = Recorder(case, self.scene, self.solver, folder, threads)
        self.wall_s = dict.fromkeys(("compile", "equilibrate", "collapse", "output"), 0.0)
        self.tau = sqrt(self.scene.layout.h_i / case.geometry.gravity)
        self.collapse_steps = 0
        self.at_rest = False

    def equilibrate(self) -> None:
        """Damped rest under gravity behind the closed gate, judged by the unbalanced force at the nodes."""
        self._begin("equilibrate", self.scene.equilibrate)
        words, solver, layout = self.case.stages.equilibrate, self.solver, self.scene.layout
        transit = 4.0 * (layout.h_i + layout.base) / self.scene.equilibrate.column.wave_speed2**0.5
        limit, calm, started = words.max_time_factor * transit, 0, time.perf_counter()
        while calm < CALM_CHECKS and solver.time < limit:
            self._advance("equilibrate", solver.time + transit / 4.0)
            unbalanced = solver.ledger[cycle.L_UNBALANCED]
            calm = calm + 1 if unbalanced < words.tolerance else 0
            self.recorder.record("equilibrate")
            self.progress("equilibrate", solver.time / limit)
        self.wall_s["equilibrate"] = time.perf_counter() - started
        self._say_stage("equilibrate", f"unbalanced force {unbalanced:.1e} of the weight")
        if calm < CALM_CHECKS:
            self.say(
                f"warning: the column was not at rest after {solver.time:.3g} s (unbalanced {unbalanced:.1e}, "
                f"asked {words.tolerance:.1e}); raise stages.equilibrate.max_time_factor or damping"
            )

    def release(self) -> None:
        """Open the gate, give the column its law, and count time, energy and displacement from here."""
        solver = self.solver
        for row in self.recorder.rows:
            row["time"] -= solver.time
        solver.clock[cycle.TIME] = 0.0
        self._begin("collapse", self.scene.collapse)
        self._lift_gate()
        self.recorder.start_ledger()
        self.recorder.record("release")
        self.recorder.snapshot("release")
        self._say_stage("release", f"gate speed {self.case.stages.gate_speed:g} m/s")

    def collapse(self) -> None:
        """Flow until the column rests, with rows of history and snapshots on the way."""
        words, solver = self.case.stages.collapse, self.solver
        limit = words.max_time_factor * self.tau
        snapshots = self._snapshot_times(limit)
        started, output, first = time.perf_counter(), self.recorder.seconds, solver.steps
        try:
            for check in range(1, int(np.ceil(words.max_time_factor * CHECKS_PER_TAU)) + 1):
                self._advance("collapse", min(check * self.tau / CHECKS_PER_TAU, limit))
                self._lift_gate()
                self.recorder.record("collapse")
                self.progress("collapse", solver.time / limit)
                self.at_rest = self._is_at_rest()
                if words.end == "rest" and self.at_rest:
                    break
                if snapshots and solver.time >= snapshots[0]:
                    snapshots.pop(0)
                    self.recorder.snapshot("collapse")
        finally:
            self.collapse_steps = solver.steps - first
            self.wall_s["output"] = self.recorder.seconds
            self.wall_s["collapse"] = time.perf_counter() - started - (self.recorder.seconds - output)
        self._say_stage(
            "collapse",
            f"{'at rest' if self.at_rest else 'ended'} after {solver.time / self.tau:.2f} sqrt(h_i/g)",
        )
        self.recorder.snapshot("rest")

    def outcome(self, status: str) -> dict[str, Any]:
        """The content of result.json for the present state."""
        solver, layout, recorder = self.solver, self.scene.layout, self.recorder
        measured = measure_snapshot(Results(self.folder).snapshot(), recorder.shape)
        scores = score(measured, self.case.geometry.a, self.case.geometry.model)
        work = max(self.collapse_steps * len(self.scene.points), 1)
        return {
            "schema": RESULT_SCHEMA,
            "status": status,
            "title": self.case.title,
            "case_hash": case_hash(self.case),
            **measured.scalars(),
            "errors": [entry.as_dict() for entry in scores],
            "at_rest": self.at_rest,
            "time": solver.time,
            "time_over_tau": solver.time / self.tau,
            "points": len(self.scene.points),
            **describe(self.scene),
            "steps": solver.steps,
            "dt": solver.dt,
            "wall_s": self.wall_s,
            "ns_per_point_step": self.wall_s["collapse"] / work * 1e9,
            "ledger": recorder.energy_ledger(),
            "worst_J": [float(J) for J in recorder.worst_J],
            "threads": self.threads,
            "versions": versions(),
            "warnings": list(layout.warnings),
        }

    def _begin(self, name: str, stage: Stage) -> None:
        """Hand the stage's law and numbers to the solver and have its kernels ready."""
        self.solver.settings = stage.settings
        self.solver.bodies = (stage.column, self.scene.base)
        started = time.perf_counter()
        self.progress(f"{name}: preparing kernels (compiled once, then kept)", 0.0)
        self.solver.prepare()
        self.wall_s["compile"] += time.perf_counter() - started

    def _advance(self, stage: str, end: float) -> None:
        """Step to `end`; on a point that goes wrong, keep the last state and raise NumericalFailure."""
        while self.solver.time < end:
            row = self.solver.advance(end)
            if row >= 0:
                failure = diagnose(self.solver, row, stage)
                self.recorder.record(stage)
                self.recorder.snapshot("failed")
                raise NumericalFailure(message(failure), failure)

    def _lift_gate(self) -> None:
        """Leave closed what the gate has not passed yet; an instantaneous gate is gone from the start."""
        speed, layout = self.case.stages.gate_speed, self.scene.layout
        if np.isinf(speed):
            opening = np.inf
        else:
            opening = speed * self.solver.time
        if opening < layout.cells_y * layout.h or self.solver.time == 0.0:
            close_walls(self.scene.grid, layout, opening)

    def _is_at_rest(self) -> bool:
        """Quiet for REST_WINDOW: little kinetic energy at the nodes, and the front has not moved."""
        window = round(REST_WINDOW * CHECKS_PER_TAU)
        rows = self.recorder.rows[-window:]
        if len(rows) < window or rows[0]["stage"] != "collapse":
            return False
        layout, weight = self.scene.layout, self._column_weight()
        moving = max(row["grid_kinetic"] for row in rows) > REST_ENERGY * weight * layout.h_i
        front = [row["front_connected"] for row in rows]
        return not moving and max(front) - min(front) < REST_FRONT * layout.h

    def _column_weight(self) -> float:
        column = self.scene.points.kind == 0
        return float(self.scene.points.m[column].sum() * self.case.geometry.gravity)

    def _snapshot_times(self, limit: float) -> list[float]:
        """Times of the snapshots between release and rest, s."""
        asked = self.case.output
        if asked.times is not None:
            return [t for t in asked.times if t > 0.0]
        return [limit * k / asked.snapshots for k in range(1, asked.snapshots)]

    def _say_stage(self, stage: str, what: str) -> None:
        self.say(f"{stage:12s} {what}, {self.solver.steps} steps, dt {self.solver.dt:.3g} s")


def run(
    case: Case,
    folder: Path | str,
    *,
    threads: int | None = None,
    fresh: bool = False,
    progress: Progress = lambda stage, share: None,
    say: Say = lambda line: None,
) -> Results:
    """Run a case into a folder and return its results.

    Raises UsageError if the folder holds a finished run and `fresh` is false, NumericalFailure if the run diverges
    (the folder then holds everything up to there), OutputError if something cannot be written.
    """
    folder = Path(folder)
    prepare_folder(folder, fresh)
    simulation = Run(case, folder, set_threads(threads), progress, say)
    try:
        simulation.equilibrate()
        simulation.release()
        simulation.collapse()
        write_result(folder, simulation.outcome("done"))
    except NumericalFailure as error:
        write_result(folder, simulation.outcome("failed") | {"failure": error.failure})
        raise
    except KeyboardInterrupt:
        simulation.recorder.snapshot("stopped")
        write_result(folder, simulation.outcome("stopped"))
        raise
    return Results(folder)
