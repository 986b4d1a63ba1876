"""The stages of a run: equilibrate, release, collapse until rest."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from math import log
from typing import Any

import numpy as np

from mpmcol.case import Case
from mpmcol.errors import NumericalFailure
from mpmcol.mpm.kernels import loop
from mpmcol.mpm.lanes import ID, X
from mpmcol.mpm.particles import BASE
from mpmcol.setup.model import Model, StageSetup, close_walls
from mpmcol.setup.time_step import time_step_limit
from mpmcol.simulation.failure import Fault, describe, fault_of, message
from mpmcol.simulation.monitor import View, look
from mpmcol.simulation.progress import Course
from mpmcol.simulation.recorder import Recorder

Progress = Callable[[str, float], None]  # stage, share of it that is done
Notify = Callable[[str], None]  # one line for the person who waits
Pause = Callable[[], None]  # is called between two calls of the compiled loop

CHECKS_PER_TAU = 50
REST_WINDOW = 0.2  # in tau: the column rests when it has been quiet for this long
REST_ENERGY = 1e-5  # grid kinetic energy over m g h_i
REST_FRONT = 0.1  # in h
MOST_HELD = (3, 1e-3)  # points, or this share of the column: more at the ends of the domain are no lone grains
CALM_CHECKS = 3  # checks in a row under the tolerance that end the equilibration
KEEP_CHECKS = 5  # from one state that is kept to go back to, to the next
FAR_AHEAD = 1.25  # front_max over front_connected that is told of


class Run:
    """A case on its way through its stages; every loop goes on where `course` says that it is."""

    def __init__(
        self, case: Case, model: Model, recorder: Recorder, course: Course, progress: Progress, notify: Notify
    ) -> None:
        self.case, self.model, self.recorder, self.course = case, model, recorder, course
        self.solver = recorder.solver
        self.progress, self.notify = progress, notify
        self.tau = model.discretization.fall_time(case.geometry.gravity)
        self._weight = model.column_mass * case.geometry.gravity
        self.good: deque[Any] = deque(maxlen=1)  # states in which no check found anything wrong, the latest last
        self.keep: Callable[[], None] = lambda: None  # adds the present state to them

    def go(self, pause: Pause = lambda: None) -> None:
        """All that is left, from the stage that the run is in."""
        if self.course.stage == "equilibrate":
            self._prepare("equilibrate", self.model.equilibrate)
            self._keep_one()
            self.equilibrate(pause)
            self.release()
        else:
            self._prepare("collapse", self.model.collapse)
            self._keep_one()
        self.collapse(pause)

    def equilibrate(self, pause: Pause = lambda: None) -> None:
        """Damped rest under gravity behind the closed gate, judged by the unbalanced force at the nodes."""
        words, solver, course = self.case.stages.equilibrate, self.solver, self.course
        transit = self.model.discretization.wave_time(self.model.equilibrate.column.wave_speed2)
        limit = words.max_time_factor * transit
        while course.calm < CALM_CHECKS and solver.time < limit:
            if solver.time >= course.until:
                course.until = solver.time + transit / 4.0
            self._advance(course.until, pause)
            unbalanced = solver.ledger[loop.L_UNBALANCED]
            course.calm = course.calm + 1 if unbalanced < words.tolerance else 0
            self.recorder.record("equilibrate")
            self._inspect()
            calmed = log(max(unbalanced, words.tolerance)) / log(words.tolerance)  # residuals fall exponentially
            self.progress("equilibrate", max(calmed, solver.time / limit))
        self.progress("equilibrate", 1.0)
        unbalanced = solver.ledger[loop.L_UNBALANCED]
        self._say_stage("equilibrate", f"unbalanced force {unbalanced:.1e} of the weight")
        if course.calm < CALM_CHECKS:
            self.warn(
                f"the column was not at rest after {solver.time:.3g} s (unbalanced {unbalanced:.1e}, "
                f"asked {words.tolerance:.1e}); raise stages.equilibrate.max_time_factor or damping"
            )

    def release(self) -> None:
        """Open the gate, give the column its law, and count time, energy and displacement from here."""
        solver, course = self.solver, self.course
        for row in self.recorder.rows:
            row["time"] -= solver.time
        solver.clock[loop.TIME] = 0.0
        course.stage, course.first_step = "collapse", solver.steps
        solver.tiles = None
        self._prepare("collapse", self.model.collapse)
        self._lift_gate()
        self.recorder.start_ledger()
        self.recorder.record("release")
        self.recorder.snapshot("release")
        self._say_stage("release", f"gate speed {self.case.stages.gate_speed:g} m/s")
        course.sound = 0
        self.good.clear()
        self._keep_one()

    def collapse(self, pause: Pause = lambda: None) -> None:
        """Flow until the column rests, with rows of history and snapshots on the way."""
        words, solver, course = self.case.stages.collapse, self.solver, self.course
        lifting = self.model.discretization.h_i / self.case.stages.gate_speed
        limit = words.max_time_factor * self.tau + lifting
        snapshots = self._snapshot_times(limit)
        while solver.time < limit and not (words.end == "rest" and course.at_rest):
            next_check = min((course.checks + 1) * self.tau / CHECKS_PER_TAU, limit)
            self._advance(min([next_check, *snapshots[:1]]), pause)
            if snapshots and solver.time >= snapshots[0]:
                snapshots = [t for t in snapshots if t > solver.time]
                self.recorder.snapshot("collapse")
            if solver.time >= next_check:
                course.checks += 1
                self._look(lifting)
                self.progress("collapse", solver.time / limit)
        self._close(snapshots)

    def _look(self, lifting: float) -> None:
        """What is done some times a tau: lift the gate, record, see whether all is well and whether it rests."""
        self._lift_gate()
        self.recorder.record("collapse")
        self._watch_ends()
        self.course.at_rest = self.solver.time > lifting + self.tau and self._is_quiet()
        self._inspect()

    def _close(self, missed: list[float]) -> None:
        """The last snapshot, and what is to be known of the end; `missed` are times of snapshots that never came."""
        self.progress("collapse", 1.0)
        how = "at rest" if self.course.at_rest else "ended"
        self._say_stage("collapse", f"{how} after {self.solver.time / self.tau:.2f} sqrt(h_i/g)")
        if len(held := self._held_points()):
            self.warn(
                f"the end of the domain at {self.model.discretization.length:.4g} m holds points that ran ahead "
                f"({len(held)}): front_max tells no more than that; a larger geometry.domain_length lets them run"
            )
        front = self.recorder.rows[-1]
        if front["front_max"] > FAR_AHEAD * front["front_connected"]:
            self.warn(
                f"grains ran far ahead of the flow: front_max {front['front_max']:.4g} m, front_connected "
                f"{front['front_connected']:.4g} m, front_height {front['front_height']:.4g} m; take front_height"
            )
        if missed and self.case.output.times is not None:
            self.warn(f"output.times: {len(missed)} of them came after the end at {self.solver.time:.4g} s")
        self.recorder.snapshot("rest" if self.course.at_rest else "end")

    def _prepare(self, name: str, stage: StageSetup) -> None:
        """Hand the stage's law and numbers to the solver and have its kernels ready."""
        self.solver.settings = stage.settings._replace(cfl=self.course.step_share * stage.settings.cfl)
        self.solver.bodies = (stage.column, self.model.base)
        self.solver.margin = stage.margin
        self.progress(f"{name}: preparing kernels (compiled once, then kept)", 0.0)
        with self.course.timed("compile"):
            self.solver.prepare()

    def _advance(self, end: float, pause: Pause) -> None:
        """Step to `end`; raises NumericalFailure on a point that goes wrong."""
        while self.solver.time < end:
            pause()
            with self.course.timed(self.course.stage):
                row = self.solver.advance(end)
            if row >= 0:
                self.recorder.record(self.course.stage)
                self._fail(fault_of(self.solver, row))

    def _inspect(self) -> None:
        """Stop where a check finds something wrong; keep the state now and then if none does."""
        geometry, recorder = self.case.geometry, self.recorder
        pressure = self.case.material.density * geometry.gravity * self.model.discretization.h_i
        scales = (self._weight * self.model.discretization.h_i, pressure, self.tau)
        if fault := look(View(self.solver, recorder.rows, recorder.start, *scales)):
            self._fail(fault)
        self.course.sound += 1
        if self.course.sound % KEEP_CHECKS == 0:
            self.keep()

    def _keep_one(self) -> None:
        if not self.good:
            self.keep()

    def _fail(self, fault: Fault) -> None:
        failure = describe(self.solver, self.course.stage, fault, time_step_limit(self.case))
        if fault.row is not None and not np.isfinite(failure["position"]).all() and self.good:
            rows, d = self.good[-1].arrays["rows"], self.solver.points.dimension
            (row,) = rows[rows[:, ID] == failure["point"]]
            failure["position"] = row[X : X + d].tolist()  # where it was last seen
        raise NumericalFailure(message(failure), failure)

    def _held_points(self) -> np.ndarray:
        """Rows of the column's points that the ends of the domain hold."""
        points = self.solver.points
        return np.flatnonzero(self.model.discretization.is_held(points.x) & (points.kind != BASE))

    def _watch_ends(self) -> None:
        """Lone grains may wait at the ends of the domain; the flow itself must not come there."""
        held, (least, share) = self._held_points(), MOST_HELD
        if len(held) > max(least, share * self.model.column_points):
            self._fail(fault_of(self.solver, int(held[0])))

    def _lift_gate(self) -> None:
        """Leave closed what the gate has not passed yet; an instantaneous gate is gone at once."""
        speed, discretization = self.case.stages.gate_speed, self.model.discretization
        if self.course.opening < discretization.cells_up * discretization.h:
            self.course.opening = speed * self.solver.time if np.isfinite(speed) else np.inf
            close_walls(self.model.grid, discretization, self.course.opening)

    def _is_quiet(self) -> bool:
        """For REST_WINDOW little kinetic energy at the nodes, and the front has not moved."""
        rows = self.recorder.rows[-round(REST_WINDOW * CHECKS_PER_TAU) :]
        discretization, front = self.model.discretization, [row["front_connected"] for row in rows]
        energy = max(row["grid_kinetic"] for row in rows) / (self._weight * discretization.h_i)
        return bool(energy < REST_ENERGY and max(front) - min(front) < REST_FRONT * discretization.h)

    def _snapshot_times(self, limit: float) -> list[float]:
        """Times of the snapshots that are still to come between release and rest, s."""
        asked, now = self.case.output, self.solver.time
        if asked.times is not None:
            return [t for t in asked.times if t > now]
        return [t for k in range(1, asked.snapshots) if (t := limit * k / asked.snapshots) > now]

    def warn(self, text: str) -> None:
        """Tell it now, and in the result."""
        self.course.warnings.append(text)
        self.notify(f"note: {text}")

    def _say_stage(self, stage: str, what: str) -> None:
        self.notify(f"{stage:12s} {what}, {self.solver.steps} steps, dt {self.solver.dt:.3g} s")
