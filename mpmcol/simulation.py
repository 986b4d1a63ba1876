"""A run from beginning to end: equilibrate, release, collapse, rest, result."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from math import log
from pathlib import Path
from typing import Any

import numpy as np

from mpmcol.case import Case, case_hash
from mpmcol.errors import NumericalFailure
from mpmcol.experiments import profile_scores, score
from mpmcol.faults import diagnose, message
from mpmcol.files import locked
from mpmcol.jit import set_threads
from mpmcol.kernels import cycle
from mpmcol.measure import stop_time
from mpmcol.memory import peak_memory
from mpmcol.recorder import Recorder, describe, versions
from mpmcol.results import RESULT_SCHEMA, Results, measure_snapshot, prepare_folder, write_result
from mpmcol.scene import Scene, Stage, build_scene, close_walls
from mpmcol.solver import Solver
from mpmcol.state import BASE
from mpmcol.stop import Stopped, StopRequest, stop_request

Progress = Callable[[str, float], None]  # stage, share of it that is done
Say = Callable[[str], None]  # one line for the person who waits

CHECKS_PER_TAU = 50
REST_WINDOW = 0.2  # in tau: the column rests when it has been quiet for this long
REST_ENERGY = 1e-5  # grid kinetic energy over m g h_i
REST_FRONT = 0.1  # in h
MOST_HELD = (3, 1e-3)  # points, or this share of the column: more at the ends of the domain are no lone grains
CALM_CHECKS = 3  # checks in a row under the tolerance that end the equilibration


class Run:
    """One run of a case into a folder; `outcome` is the content of result.json."""

    def __init__(
        self, case: Case, folder: Path, threads: int, fresh: bool, progress: Progress, say: Say, stop: StopRequest
    ) -> None:
        self.case, self.folder, self.threads = case, folder, threads
        self.progress, self.say, self.stop = progress, say, stop
        self.scene: Scene = build_scene(case)  # may refuse the case: before anything old is removed
        prepare_folder(folder, fresh)
        scene, stage = self.scene, self.scene.equilibrate
        self.solver = Solver(scene.points, scene.grid, stage.settings, stage.column, scene.base, scene.scheme)
        self.recorder = Recorder(case, self.scene, self.solver, folder, threads)
        self.wall_s = dict.fromkeys(("compile", "equilibrate", "collapse", "output"), 0.0)
        self._cpu_s = -time.process_time()
        self.tau = self.scene.layout.fall_time(case.geometry.gravity)
        self.collapse_steps = 0
        self.at_rest = False
        self.warnings: list[str] = []
        self._opening = 0.0  # m: how far the gate is lifted
        self._weight = self.scene.column_mass * case.geometry.gravity
        for warning in self.scene.layout.warnings:
            self._warn(warning)

    def equilibrate(self) -> None:
        """Damped rest under gravity behind the closed gate, judged by the unbalanced force at the nodes."""
        self._begin("equilibrate", self.scene.equilibrate)
        words, solver = self.case.stages.equilibrate, self.solver
        transit = self.scene.layout.wave_time(self.scene.equilibrate.column.wave_speed2)
        limit, calm = words.max_time_factor * transit, 0
        with self._timed("equilibrate"):
            while calm < CALM_CHECKS and solver.time < limit:
                self._advance("equilibrate", solver.time + transit / 4.0)
                unbalanced = solver.ledger[cycle.L_UNBALANCED]
                calm = calm + 1 if unbalanced < words.tolerance else 0
                self.recorder.record("equilibrate")
                calmed = log(max(unbalanced, words.tolerance)) / log(words.tolerance)  # residuals fall exponentially
                self.progress("equilibrate", max(calmed, solver.time / limit))
        self.progress("equilibrate", 1.0)
        self._say_stage("equilibrate", f"unbalanced force {unbalanced:.1e} of the weight")
        if calm < CALM_CHECKS:
            self._warn(
                f"the column was not at rest after {solver.time:.3g} s (unbalanced {unbalanced:.1e}, "
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
        lifting = self.scene.layout.h_i / self.case.stages.gate_speed
        limit = words.max_time_factor * self.tau + lifting
        snapshots, checks, first = self._snapshot_times(limit), 0, solver.steps
        with self._timed("collapse"):
            while solver.time < limit and not (words.end == "rest" and self.at_rest):
                next_check = min((checks + 1) * self.tau / CHECKS_PER_TAU, limit)
                self._advance("collapse", min([next_check, *snapshots[:1]]))
                self.collapse_steps = solver.steps - first
                if snapshots and solver.time >= snapshots[0]:
                    snapshots = [t for t in snapshots if t > solver.time]
                    self.recorder.snapshot("collapse")
                if solver.time >= next_check:
                    checks += 1
                    self._lift_gate()
                    self.recorder.record("collapse")
                    self._watch_ends()
                    self.progress("collapse", solver.time / limit)
                    self.at_rest = solver.time > lifting + self.tau and self._is_quiet()
        self.progress("collapse", 1.0)
        how = "at rest" if self.at_rest else "ended"
        self._say_stage("collapse", f"{how} after {solver.time / self.tau:.2f} sqrt(h_i/g)")
        if len(held := self._held_points()):
            self._warn(
                f"the end of the domain at {self.scene.layout.length:.4g} m holds points that ran ahead ({len(held)}): "
                "front_max tells no more than that; a larger geometry.domain_length lets them run"
            )
        if snapshots and self.case.output.times is not None:
            self._warn(f"output.times: {len(snapshots)} of them came after the end at {solver.time:.4g} s")
        self.recorder.snapshot("rest" if self.at_rest else "end")

    def outcome(self, status: str) -> dict[str, Any]:
        """The content of result.json for the present state."""
        solver, recorder = self.solver, self.recorder
        measured = measure_snapshot(Results(self.folder).snapshot(), recorder.shape)
        geometry = self.case.geometry
        scores = score(measured, geometry.a, geometry.model, geometry.section)
        profiles = profile_scores(
            measured.profile_x, measured.profile_y, geometry.model, geometry.r_i, geometry.h_i, geometry.section
        )
        work = max(self.collapse_steps * len(self.scene.points), 1)
        self.wall_s["output"] = recorder.seconds
        return {
            "schema": RESULT_SCHEMA,
            "status": status,
            "title": self.case.title,
            "case_hash": case_hash(self.case),
            **measured.scalars(),
            "stop_time": self._stop_time(),
            "errors": [entry.as_dict() for entry in scores],
            "profile_scores": [vars(entry) for entry in profiles],
            "at_rest": self.at_rest,
            "time": solver.time,
            "time_over_tau": solver.time / self.tau,
            "points": len(self.scene.points),
            **describe(self.scene),
            "steps": solver.steps,
            "dt": solver.dt,
            "wall_s": self.wall_s,
            "core_seconds": self._cpu_s + time.process_time(),
            "ns_per_point_step": self.wall_s["collapse"] / work * 1e9,
            "peak_memory_bytes": peak_memory(),
            "ledger": recorder.energy_ledger(),
            "worst_J": [float(J) for J in recorder.worst_J],
            "threads": self.threads,
            "versions": versions(),
            "warnings": self.warnings,
        }

    def _begin(self, name: str, stage: Stage) -> None:
        """Hand the stage's law and numbers to the solver and have its kernels ready."""
        self.solver.settings = stage.settings
        self.solver.bodies = (stage.column, self.scene.base)
        self.solver.margin = stage.margin
        self.progress(f"{name}: preparing kernels (compiled once, then kept)", 0.0)
        compiling = time.process_time()
        with self._timed("compile"):
            self.solver.prepare()
        self._cpu_s -= time.process_time() - compiling

    @contextmanager
    def _timed(self, what: str) -> Iterator[None]:
        """Add the seconds spent inside to `wall_s`, less those of the recorder."""
        started, written = time.perf_counter(), self.recorder.seconds
        try:
            yield
        finally:
            self.wall_s[what] += time.perf_counter() - started - (self.recorder.seconds - written)

    def _advance(self, stage: str, end: float) -> None:
        """Step to `end`; on a point that goes wrong, keep the last state and raise NumericalFailure.

        Raises Stopped when a signal has come.
        """
        while self.solver.time < end:
            self.stop.heed()
            row = self.solver.advance(end)
            if row >= 0:
                self.recorder.record(stage)
                self._fail(row, stage)

    def _fail(self, row: int, stage: str) -> None:
        failure = diagnose(self.solver, row, stage)
        self.recorder.snapshot("failed")
        raise NumericalFailure(message(failure), failure)

    def _held_points(self) -> np.ndarray:
        """Rows of the column's points that the ends of the domain hold."""
        points = self.solver.points
        return np.flatnonzero(self.scene.layout.is_held(points.x) & (points.kind != BASE))

    def _watch_ends(self) -> None:
        """Lone grains may wait at the ends of the domain; the flow itself must not come there."""
        held, (least, share) = self._held_points(), MOST_HELD
        if len(held) > max(least, share * self.scene.column_points):
            self._fail(int(held[0]), "collapse")

    def _lift_gate(self) -> None:
        """Leave closed what the gate has not passed yet; an instantaneous gate is gone at once."""
        speed, layout = self.case.stages.gate_speed, self.scene.layout
        if self._opening < layout.cells_up * layout.h:
            self._opening = speed * self.solver.time if np.isfinite(speed) else np.inf
            close_walls(self.scene.grid, layout, self._opening)

    def _is_quiet(self) -> bool:
        """For REST_WINDOW little kinetic energy at the nodes, and the front has not moved."""
        rows = self.recorder.rows[-round(REST_WINDOW * CHECKS_PER_TAU) :]
        layout, front = self.scene.layout, [row["front_connected"] for row in rows]
        energy = max(row["grid_kinetic"] for row in rows) / (self._weight * layout.h_i)
        return bool(energy < REST_ENERGY and max(front) - min(front) < REST_FRONT * layout.h)

    def _stop_time(self) -> float | None:
        """When the front came within a cell of its end, in tau; None unless the column came to rest."""
        flow = [row for row in self.recorder.rows if row["stage"] == "collapse"]
        if not self.at_rest:
            return None
        time, front = (np.array([row[name] for row in flow]) for name in ("time", "front_height"))
        stop = stop_time(time, front, self.scene.layout.h)
        return None if stop is None else stop / self.tau

    def _snapshot_times(self, limit: float) -> list[float]:
        """Times of the snapshots between release and rest, s."""
        asked = self.case.output
        if asked.times is not None:
            return [t for t in asked.times if t > 0.0]
        return [limit * k / asked.snapshots for k in range(1, asked.snapshots)]

    def _warn(self, text: str) -> None:
        self.warnings.append(text)
        self.say(f"note: {text}")

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

    Raises UsageError if the folder holds a finished run and `fresh` is false, or another run writes there, or the case
    does not fit; NumericalFailure if the run diverges
    (the folder then holds everything up to there), OutputError if something cannot be written; KeyboardInterrupt on
    SIGINT and SIGTERM, after a last snapshot and the result up to there, and at once on the second.
    """
    folder, used = Path(folder), set_threads(threads)
    if threads is not None and used != threads:
        say(f"note: {used} threads instead of {threads}; NUMBA_NUM_THREADS sets the most")
    with locked(folder), stop_request() as stop:
        return _run(Run(case, folder, used, fresh, progress, say, stop))


def _run(simulation: Run) -> Results:
    """All stages, with a result.json however they end."""
    folder = simulation.folder
    try:
        simulation.equilibrate()
        simulation.release()
        simulation.collapse()
        write_result(folder, simulation.outcome("done"))
    except NumericalFailure as error:
        write_result(folder, simulation.outcome("failed") | {"failure": error.failure})
        raise
    except Stopped:
        simulation.recorder.snapshot("stopped")
        write_result(folder, simulation.outcome("stopped"))
        raise KeyboardInterrupt from None
    return Results(folder)
