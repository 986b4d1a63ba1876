"""The stages of a run: equilibrate, release, collapse until rest. Their setup is in `mpmcol.setup.model`."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import ceil, inf, log

import numpy as np

from mpmcol.case.slope import ENDLESS_REMEDY, case_slope_factor, endless_flow, remedy_of_motion
from mpmcol.errors import NumericalFailure
from mpmcol.mpm.kernels import loop
from mpmcol.mpm.lanes import ID, X
from mpmcol.mpm.particles import BASE
from mpmcol.setup.domain import usable
from mpmcol.setup.model import StageSetup, set_boundaries
from mpmcol.setup.time_step import time_step_limit
from mpmcol.simulation.failure import Failure, failure_message, failure_record, identify_failure, larger_domain
from mpmcol.simulation.monitor import CheckedState, find_failure
from mpmcol.simulation.quality import quality_notes
from mpmcol.simulation.state import Simulation

CHECKS_PER_FALL_TIME = 50
CHECKS_PER_TRANSIT = 4  # during equilibration: per travel of a wave up and down, twice
CONVERGED_CHECKS = 3  # consecutive checks below the tolerance that end the equilibration
USUAL_DURATION = 6.0  # of a collapse, in sqrt(h_i / g); some columns creep for longer
REST_WINDOW = 0.2  # in sqrt(h_i / g): the column is at rest when it has been quiet for this time
REST_ENERGY = 1e-5  # grid kinetic energy over m g h_i
REST_FRONT = 0.1  # in h: motion of the front
# more points of the column than this, in number and as a fraction, are part of the flow
MAX_ARRESTED_NUMBER, MAX_ARRESTED_FRACTION = 3, 1e-3
CHECKS_PER_STATE = 5  # checks between two valid states that are kept in memory
DETACHED_FRONT = 1.25  # ratio of front_max to front_connected above which a warning is issued


def do_nothing() -> None:
    """The default action between two calls of the compiled loop."""


class Stages:
    """The loops over the steps of a run; each continues where `simulation.progress` is.

    between_steps: called between two calls of the compiled loop, for example to write a checkpoint.
    """

    def __init__(self, simulation: Simulation, between_steps: Callable[[], None] = do_nothing) -> None:
        self.simulation, self.between_steps = simulation, between_steps
        self.case, self.model = simulation.case, simulation.model
        self.solver, self.recorder = simulation.solver, simulation.recorder
        self.fall_time = simulation.fall_time
        self._weight = self.model.column_mass * self.case.geometry.gravity

    def run(self) -> None:
        """Complete the run from its present stage on. Raises NumericalFailure."""
        if self.simulation.progress.stage == "equilibrate":
            self._start_stage("equilibrate", self.model.equilibrate)
            self.equilibrate()
            self.release()
        else:
            self._start_stage("collapse", self.model.collapse)
        self.collapse()

    def equilibrate(self) -> None:
        """Damped loading under gravity, behind the gate if there is one, until the unbalanced nodal force is small."""
        options, solver, progress = self.case.stages.equilibrate, self.solver, self.simulation.progress
        transit = self.model.discretization.wave_time(self.model.equilibrate.column.wave_speed2)
        limit = options.max_time_factor * transit
        self.simulation.show_progress("equilibrate", self._equilibrated(limit))
        while progress.converged_checks < CONVERGED_CHECKS and solver.time < limit:
            if solver.time >= progress.next_check:
                progress.next_check = solver.time + transit / CHECKS_PER_TRANSIT
            self._advance(progress.next_check)
            unbalanced = solver.ledger[loop.L_UNBALANCED]
            progress.converged_checks = progress.converged_checks + 1 if unbalanced < options.tolerance else 0
            self.recorder.record("equilibrate")
            self._check()
            self.simulation.show_progress("equilibrate", self._equilibrated(limit))
        self.simulation.show_progress("equilibrate", 1.0)
        unbalanced = solver.ledger[loop.L_UNBALANCED]
        self._notify_stage("equilibrate", f"unbalanced force {unbalanced:.1e} of the weight")
        if progress.converged_checks < CONVERGED_CHECKS:
            self.simulation.warn(
                f"the column was not at rest after {solver.time:.3g} s (unbalanced force {unbalanced:.1e} of the "
                f"weight, tolerance {options.tolerance:.1e}); raise stages.equilibrate.max_time_factor or damping"
            )

    def _equilibrated(self, limit: float) -> float:
        """Fraction of the equilibration that is done: residuals fall exponentially, and time ends at its limit."""
        solver, tolerance = self.solver, self.case.stages.equilibrate.tolerance
        if not solver.steps:
            return 0.0
        unbalanced = solver.ledger[loop.L_UNBALANCED]
        return max(log(max(unbalanced, tolerance)) / log(tolerance), solver.time / limit)

    def release(self) -> None:
        """Open the gate and switch to the law of the collapse; time, energy and displacement count from here."""
        solver, progress = self.solver, self.simulation.progress
        for row in self.recorder.rows:
            row["time"] -= solver.time
        solver.clock[loop.TIME] = 0.0
        progress.stage, progress.release_step, progress.valid_checks = "collapse", solver.steps, 0
        solver.tiles = None  # sort the points again, since the base may be partly inactive in the collapse
        self._prepare_solver("collapse", self.model.collapse)
        self._lift_gate()
        self.recorder.start_ledger()
        self.recorder.record("release")
        self.recorder.write_snapshot("release")
        stages = self.case.stages
        self._notify_stage("release", f"gate speed {stages.gate_speed:g} m/s" if stages.gate else "without a gate")
        self.simulation.valid_states.clear()
        self.simulation.keep_valid_state()

    def collapse(self) -> None:
        """Flow until the column is at rest, with rows of the history and snapshots at given times."""
        options, solver, progress = self.case.stages.collapse, self.solver, self.simulation.progress
        lifting_time = self.model.discretization.h_i / self.case.stages.gate_speed
        limit = options.max_time_factor * self.fall_time + lifting_time
        slow = case_slope_factor(self.case)
        usual = min(limit, USUAL_DURATION * slow * self.fall_time + lifting_time)
        times = self._snapshot_times(limit, usual)
        due = next(times, inf)
        self.simulation.show_progress("collapse", min(solver.time / usual, 1.0))
        while solver.time < limit and not (options.end == "rest" and progress.at_rest):
            next_check = min((progress.checks + 1) * self.fall_time / CHECKS_PER_FALL_TIME, limit)
            self._advance(min(next_check, due))
            if solver.time >= due:
                due = next((t for t in times if t > solver.time), inf)
                self.recorder.write_snapshot("collapse")
            if solver.time >= next_check:
                progress.checks += 1
                self._check_collapse(lifting_time)
                self.simulation.show_progress("collapse", min(solver.time / usual, 1.0))
        self._finish_collapse()

    def _check_collapse(self, lifting_time: float) -> None:
        """Lift the gate, add a row to the history, check the state, and decide whether the column is at rest."""
        self._lift_gate()
        self.recorder.record("collapse")
        self._check_domain()
        is_released = self.solver.time > lifting_time + self.fall_time
        self.simulation.progress.at_rest = is_released and self._is_quiet()
        self._check()

    def _finish_collapse(self) -> None:
        """Report the end and its warnings."""
        self.simulation.show_progress("collapse", 1.0)
        ending = "at rest" if self.simulation.progress.at_rest else "ended"
        self._notify_stage("collapse", f"{ending} after {self.solver.time / self.fall_time:.2f} sqrt(h_i/g)")
        options = self.case.stages.collapse
        if (remedy := remedy_of_motion(self.case)) and not self.simulation.progress.at_rest:
            self.simulation.warn(
                f"the column still moved at the time limit, {options.max_time_factor:g} sqrt(h_i/g): runout and height "
                f"are not final; {remedy}"
            )
        if count := len(self._arrested_points()):
            noun = "particle was" if count == 1 else "particles were"
            length, h = self.model.discretization.length, self.model.discretization.h
            self.simulation.warn(
                f"{count} {noun} arrested at the domain boundary (x = {length:.4g} m, usable up to "
                f"{usable(length, h):.4g} m): front_max is a lower bound; {larger_domain(length)}"
            )
        front = self.recorder.rows[-1]
        if front["front_max"] > DETACHED_FRONT * front["front_connected"]:
            self.simulation.warn(
                f"detached particles ahead of the flow front: front_max {front['front_max']:.4g} m, front_connected "
                f"{front['front_connected']:.4g} m, front_height {front['front_height']:.4g} m; use front_height"
            )
        for note in quality_notes(self.simulation):
            self.simulation.warn(note)
        if missed := [t for t in self.case.output.times or () if t > self.solver.time]:
            self.simulation.warn(f"output.times: {len(missed)} times are after the end at {self.solver.time:.4g} s")

    def _start_stage(self, name: str, setup: StageSetup) -> None:
        """Prepare a stage, and keep the state from which a first failure can be retried."""
        self._prepare_solver(name, setup)
        if not self.simulation.valid_states:
            self.simulation.keep_valid_state()

    def _prepare_solver(self, name: str, setup: StageSetup) -> None:
        """Set law and parameters of a stage, and compile or load its kernels."""
        progress, solver = self.simulation.progress, self.solver
        solver.settings = setup.settings._replace(cfl=progress.cfl_factor * setup.settings.cfl)
        solver.bodies = (setup.column, self.model.base, *setup.layers)
        solver.margin = setup.margin
        self.simulation.show_progress(f"{name}: preparing kernels (in the first run of a kind of case 10 to 60 s)", 0.0)
        with progress.timed("compile"):
            solver.prepare()

    def _advance(self, end: float) -> None:
        """Step to the time `end`. Raises NumericalFailure if the compiled loop stops at an invalid point."""
        progress = self.simulation.progress
        while self.solver.time < end:
            self.between_steps()
            with progress.timed(progress.stage):
                row = self.solver.advance(end)
            if row >= 0:
                self.recorder.record(progress.stage)
                self._fail(identify_failure(self.solver, row))

    def _check(self) -> None:
        """Raise NumericalFailure if a check of the whole state fails; keep every few valid states."""
        geometry, recorder, progress = self.case.geometry, self.recorder, self.simulation.progress
        h_i = self.model.discretization.h_i
        state = CheckedState(
            solver=self.solver,
            rows=recorder.rows,
            initial_energies=recorder.initial_energies,
            energy=self._weight * h_i,
            stress=self.case.material.density * geometry.gravity * h_i,
            fall_time=self.fall_time,
        )
        if failure := find_failure(state):
            self._fail(failure)
        progress.valid_checks += 1
        if progress.valid_checks % CHECKS_PER_STATE == 0:
            self.simulation.keep_valid_state()

    def _fail(self, failure: Failure) -> None:
        if failure.check == "domain" and (cause := endless_flow(self.case)):
            failure = failure._replace(likely=cause, remedy=f"{ENDLESS_REMEDY}; or {failure.remedy}")
        record = failure_record(self.solver, self.simulation.progress.stage, failure, time_step_limit(self.case))
        states = self.simulation.valid_states
        if failure.row is not None and not np.isfinite(record["position"]).all() and states:
            rows, d = states[-1].points, self.solver.points.dimension
            (row,) = rows[rows[:, ID] == record["point"]]
            record["position"] = row[X : X + d].tolist()  # the last valid position
        raise NumericalFailure(failure_message(record), record)

    def _arrested_points(self) -> np.ndarray:
        """Rows of the column's points that are arrested at the ends of the domain."""
        points = self.solver.points
        return np.flatnonzero(self.model.discretization.in_end_zone(points.x) & (points.kind != BASE))

    def _check_domain(self) -> None:
        """Single particles may be arrested at the ends of the domain; the flow itself must not reach them."""
        arrested = self._arrested_points()
        if len(arrested) > max(MAX_ARRESTED_NUMBER, MAX_ARRESTED_FRACTION * self.model.column_points):
            self._fail(identify_failure(self.solver, int(arrested[0])))

    def _lift_gate(self) -> None:
        """Set the opening of the gate to its present time; an instantaneous gate is open at once."""
        progress, speed = self.simulation.progress, self.case.stages.gate_speed
        discretization = self.model.discretization
        if progress.gate_opening < discretization.cells_up * discretization.h:
            progress.gate_opening = speed * self.solver.time if np.isfinite(speed) else np.inf
            set_boundaries(self.model.grid, discretization, progress.gate_opening)

    def _is_quiet(self) -> bool:
        """Whether grid kinetic energy and motion of the front have been small for REST_WINDOW."""
        rows = self.recorder.rows[-round(REST_WINDOW * CHECKS_PER_FALL_TIME) :]
        discretization, front = self.model.discretization, [row["front_connected"] for row in rows]
        energy = max(row["grid_kinetic"] for row in rows) / (self._weight * discretization.h_i)
        return bool(energy < REST_ENERGY and max(front) - min(front) < REST_FRONT * discretization.h)

    def _snapshot_times(self, limit: float, usual: float) -> Iterator[float]:
        """Times of the snapshots between release and rest that are still to be written, s; millions in long runs."""
        output, now = self.case.output, self.solver.time
        if output.times is not None:
            return (t for t in output.times if t > now)
        reached, count = int(output.snapshots * now / usual), ceil(output.snapshots * limit / usual)
        times = (usual * k / output.snapshots for k in range(max(reached, 1), count))
        return (t for t in times if now < t < limit)

    def _notify_stage(self, stage: str, text: str) -> None:
        self.simulation.notify(f"{stage:12s} {text}, {self.solver.steps} steps, dt {self.solver.dt:.3g} s")
