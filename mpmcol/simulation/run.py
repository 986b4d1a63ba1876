"""The life cycle of a run in its folder: start or resume, complete the stages, write the result."""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from pathlib import Path
from typing import Any, Literal, ParamSpec

from mpmcol.case import Case
from mpmcol.case.title import title_of
from mpmcol.errors import Interrupted, NumericalFailure, OutputError, UsageError
from mpmcol.io.atomic import remove
from mpmcol.io.lock import locked
from mpmcol.io.names import CHECKPOINT_FILES
from mpmcol.io.results import Results
from mpmcol.io.run_folder import prepare_folder, reopen_folder, write_pressure, write_result
from mpmcol.io.run_log import run_log
from mpmcol.mpm.jit import CACHE_NOTE
from mpmcol.mpm.kernels import loop
from mpmcol.mpm.particles import Points
from mpmcol.mpm.threads import set_threads
from mpmcol.provenance import code_version
from mpmcol.setup.cores import thread_note
from mpmcol.setup.model import Model, build_model, make_solver
from mpmcol.setup.unfit_settings import require_stiff_column
from mpmcol.simulation.checkpointer import INTERVAL, Checkpointer
from mpmcol.simulation.failure import failure_message
from mpmcol.simulation.interrupt import Stopped, stop_request
from mpmcol.simulation.recorder import Recorder
from mpmcol.simulation.restart import find_checkpoint, find_finished_run, recovery_hint, require_same_points, resume
from mpmcol.simulation.retry import halve_time_step
from mpmcol.simulation.stages import Stages
from mpmcol.simulation.state import Notify, RunState, ShowProgress, Simulation, no_messages, no_progress
from mpmcol.simulation.summary import summarize

P = ParamSpec("P")


def run(
    case: Case,
    folder: Path | str,
    *,
    threads: int | None = None,
    fresh: bool = False,
    force_resume: bool = False,
    checkpoint_seconds: float = INTERVAL,
    max_wall: float = inf,
    on_instability: Literal["stop", "retry"] = "stop",
    progress: ShowProgress = no_progress,
    notify: Notify = no_messages,
) -> Results:
    """Run a case in a folder, or resume its unfinished run there, and return the results.

    If the folder holds the finished run of this case, nothing is computed.

    Args:
        threads: number of threads (default: all cores); results do not depend on it.
        fresh: restart from scratch, whatever the folder holds of a run.
        force_resume: resume an unfinished run even if it is of another version of the code or of the case.
        checkpoint_seconds: wall-clock time between two checkpoints, s.
        max_wall: wall-clock limit after which the run stops as on a signal, s.
        on_instability: "retry": after a numerical failure return to the last valid state with half the time step, if
            that can help, at most four times.
        progress: called with the stage and the fraction of it that is done.
        notify: called with each message for the user, one line.

    Raises:
        UsageError: `case` is none of `load_case`; the folder holds a run of another case, or an unfinished one that
            differs in version, or the case cannot be run; or this process was forked from one that had already
            computed.
        NumericalFailure: the run diverged; the folder holds everything up to the failure.
        OutputError: a file cannot be written, or another run writes to the folder.
        Interrupted: a signal (`mpmcol.simulation.interrupt`) or `max_wall` stopped the run; the same call resumes it. A
            second signal aborts it at once with KeyboardInterrupt. A handler that the caller has installed for the
            signal is called when the state is saved. In a thread that is not the main one, only `max_wall` stops a run.
    """
    if not isinstance(case, Case):
        raise UsageError(f"case = {case!r:.60}: expected a case of mpmcol.load_case, as in run(load_case(...), folder)")
    if on_instability not in ("stop", "retry"):
        raise UsageError(f'on_instability = "{on_instability}": expected "stop" or "retry"')
    folder = Path(folder)
    if not fresh and (finished := find_finished_run(case, folder, notify)):
        return finished
    used = set_threads(threads)
    if threads is not None and used != threads:
        notify(f"note: {used} threads instead of {threads}; set NUMBA_NUM_THREADS to allow more")
    if note := thread_note(used):
        notify(f"note: {note}")
    if CACHE_NOTE:
        notify(CACHE_NOTE)
    with stop_request(max_wall) as stop, locked(folder) as lock, run_log() as log:
        notify, progress = _both(notify, log.message), _both(progress, log.progress)
        log.message(f"mpmcol {code_version()}, {used} threads: {title_of(case)}")
        checkpoint = None if fresh else find_checkpoint(case, folder, force_resume, notify)
        require_stiff_column(case)
        model = build_model(case)  # may refuse the case: before old files are removed
        if checkpoint:
            require_same_points(model, checkpoint)
        try:
            if checkpoint:
                reopen_folder(folder)
            else:
                prepare_folder(folder, case, fresh, notify)
            log.open(folder)
            simulation = start(
                case,
                model,
                folder,
                threads=used,
                retry=on_instability == "retry",
                show_progress=progress,
                notify=notify,
            )
            if checkpoint:
                resume(simulation, checkpoint)
            _complete(simulation, Checkpointer(simulation, stop, lock, checkpoint_seconds, checkpoint))
        except OutputError as error:
            lock.check()  # if the folder itself is gone, report that
            raise OutputError(f"{error}\n{recovery_hint(folder)}") from error
        log.message("done")
    return Results(folder)


def _both(first: Callable[P, None], second: Callable[P, None]) -> Callable[P, None]:
    """A function that calls both."""

    def call(*args: P.args, **kwargs: P.kwargs) -> None:
        first(*args, **kwargs)
        second(*args, **kwargs)

    return call


def start(
    case: Case,
    model: Model,
    folder: Path,
    *,
    threads: int = 1,
    retry: bool = False,
    show_progress: ShowProgress = no_progress,
    notify: Notify = no_messages,
) -> Simulation:
    """A simulation at its start; its folder holds the resolved case."""
    stage = model.equilibrate
    solver = make_solver(model, stage)
    recorder = Recorder(case, model, solver, folder, threads)
    recorder.open()
    recorder.start_ledger()
    simulation = Simulation(case, model, recorder, retry=retry, show_progress=show_progress, notify=notify)
    for warning in model.discretization.warnings:
        simulation.warn(warning)
    return simulation


def _complete(simulation: Simulation, checkpointer: Checkpointer) -> None:
    """Run the remaining stages; write the final snapshot and result.json, however the run ends."""
    try:
        _run_stages(simulation, checkpointer)
    except NumericalFailure as error:
        _write_last_valid_state(simulation, error.failure)
        _write_result(simulation, "failed", snapshot="failed", failure=error.failure)
        _remove_checkpoints(simulation)
        text = failure_message(error.failure, simulation.progress.retries)
        raise NumericalFailure(text, error.failure) from None
    except Stopped as stopped:
        _write_result(simulation, "stopped", snapshot="stopped")
        solver, folder = simulation.solver, simulation.recorder.folder
        raise Interrupted(
            f"stopped by {stopped} at step {solver.steps}, t = {solver.time:.4g} s, in {folder}; "
            "repeat the command to resume"
        ) from None
    _write_result(simulation, "done", snapshot="rest" if simulation.progress.at_rest else "end")
    _remove_checkpoints(simulation)


def _run_stages(simulation: Simulation, checkpointer: Checkpointer) -> None:
    """Run the remaining stages; after a failure retry with a smaller time step if that is allowed."""
    stages = Stages(simulation, checkpointer.between_steps)
    while True:
        try:
            return stages.run()
        except NumericalFailure as error:
            if not halve_time_step(simulation, error.failure):
                raise
            checkpointer.write()  # the previous checkpoint belongs to the abandoned part and refers to its snapshots


def _write_result(simulation: Simulation, status: str, snapshot: str, **more: Any) -> None:
    """Write the final snapshot, whose stage is `snapshot`, and result.json."""
    recorder = simulation.recorder
    final = recorder.write_snapshot(snapshot)
    recorder.flush()
    recorder.remove_later_snapshots()
    write_pressure(recorder.folder, recorder.forces.pressure_rows(), recorder.shape.model)
    write_result(recorder.folder, summarize(status, simulation, final) | more, recorder.checksums)


def _write_last_valid_state(simulation: Simulation, failure: dict[str, Any]) -> None:
    """Write the last valid state as a snapshot unless there is a later valid one; note its index in the failure."""
    recorder, state = simulation.recorder, simulation.valid_states[-1]
    last_check = [row["time"] for row in recorder.rows[-2:-1]]  # the last row is of the failed state
    valid_until = max([state.time, *last_check])
    if not any(state.time <= time <= valid_until for time in recorder.snapshot_times):
        points = _points_of(state, simulation.solver.points.dimension)
        steps = int(state.clock[loop.STEPS])
        recorder.append_snapshot(recorder.snapshot_of(points, state.time, steps, "last_valid"))
    failure["last_valid"] = max(k for k, time in enumerate(recorder.snapshot_times) if time <= valid_until)


def _points_of(state: RunState, dimension: int) -> Points:
    points = Points(len(state.points), dimension)
    points.rows[:] = state.points
    return points


def _remove_checkpoints(simulation: Simulation) -> None:
    for name in CHECKPOINT_FILES:
        remove(simulation.recorder.folder / name)
