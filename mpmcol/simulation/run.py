"""A run from beginning to end in its folder: begun there, or taken up again where it was."""

from __future__ import annotations

from collections import deque
from functools import partial
from math import inf
from pathlib import Path
from typing import Literal

from mpmcol.case import Case
from mpmcol.errors import Interrupted, NumericalFailure, OutputError, UsageError
from mpmcol.io.atomic import remove
from mpmcol.io.checkpoint import Checkpoint
from mpmcol.io.lock import locked
from mpmcol.io.names import CHECKPOINT_FILES
from mpmcol.io.results import Results
from mpmcol.io.run_folder import prepare_folder, reopen_folder, write_result
from mpmcol.mpm.jit import set_threads
from mpmcol.mpm.solver import Solver
from mpmcol.setup.model import Model, build_model
from mpmcol.simulation.failure import message
from mpmcol.simulation.interrupt import Stopped, stop_request
from mpmcol.simulation.progress import Course
from mpmcol.simulation.recorder import Recorder
from mpmcol.simulation.restart import (
    GO_BACK,
    INTERVAL,
    MOST_HALVINGS,
    Keeper,
    differences,
    last_state,
    remember,
    require_same_points,
    restore,
    snapshot_failed,
    step_back,
    step_of,
    way_on,
)
from mpmcol.simulation.stages import Notify, Progress, Run
from mpmcol.simulation.summary import outcome


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
    progress: Progress = lambda stage, share: None,
    notify: Notify = lambda line: None,
) -> Results:
    """Run a case into a folder, or go on with its unfinished run there, and return its results.

    Args:
        threads: number of threads (default: all cores); results are the same for any.
        fresh: begin anew whatever the folder holds of a run.
        force_resume: go on even if the unfinished run is of another version of the code or of the case.
        checkpoint_seconds: time between two checkpoints, s of the machine.
        max_wall: time after which to stop as if by a signal, s of the machine.
        on_instability: "retry" goes on from the last good state with half the time step where a run goes wrong in a way
            that this may mend, at most four times.
        progress: is told the stage and the share of it that is done.
        notify: is told what happens, in one line.

    Raises:
        UsageError: the folder holds a finished run, or an unfinished one that differs, or the case does not fit.
        NumericalFailure: the run diverges; the folder then holds everything up to there.
        OutputError: something cannot be written, or another run writes there.
        Interrupted: SIGINT, SIGTERM, SIGUSR1 or `max_wall` ended it; the same call goes on with it. The second signal
            ends it at once, with KeyboardInterrupt.
    """
    if on_instability not in ("stop", "retry"):
        raise UsageError(f'on_instability = "{on_instability}": expected "stop" or "retry"')
    folder, used = Path(folder), set_threads(threads)
    if threads is not None and used != threads:
        notify(f"note: {used} threads instead of {threads}; NUMBA_NUM_THREADS sets the most")
    with stop_request(max_wall) as stop, locked(folder) as lock:
        found = None if fresh else _unfinished(case, folder, force_resume, notify)
        model = build_model(case)  # may refuse the case: before anything old is removed
        if found:
            require_same_points(model, found)
        try:
            reopen_folder(folder) if found else prepare_folder(folder, case, fresh, notify)
            simulation = set_up(case, model, folder, used, progress, notify)
            if on_instability == "retry":
                simulation.good = deque(maxlen=GO_BACK)
            if found:
                restore(simulation, found)
            return _carry_out(simulation, Keeper(simulation, stop, lock, checkpoint_seconds, found), used)
        except OutputError as error:
            lock.check()  # where the folder itself is gone, that is what went wrong
            raise OutputError(f"{error}\n{way_on(folder)}") from error


def set_up(case: Case, model: Model, folder: Path, threads: int, progress: Progress, notify: Notify) -> Run:
    """A run at its beginning."""
    stage = model.equilibrate
    solver = Solver(model.points, model.grid, stage.settings, stage.column, model.base, model.scheme)
    simulation = Run(case, model, Recorder(case, model, solver, folder, threads), Course(), progress, notify)
    simulation.keep = partial(remember, simulation)
    for warning in model.discretization.warnings:
        simulation.warn(warning)
    return simulation


def _unfinished(case: Case, folder: Path, force_resume: bool, notify: Notify) -> Checkpoint | None:
    """The state to go on from, if the folder has one."""
    found = last_state(folder, notify)
    if found is None:
        return None
    told = differences(found, case)
    if told and not force_resume:
        raise UsageError(
            f"{folder} holds an unfinished run that differs from this one:\n  "
            + "\n  ".join(told)
            + "\nuse --fresh to begin anew, --out for another folder, or --force-resume to resume it anyway"
        )
    notify(f"going on from step {step_of(found)}")
    return found


def _carry_out(simulation: Run, keeper: Keeper, threads: int) -> Results:
    """All that is left of a run, with a result.json however it ends."""
    recorder = simulation.recorder
    folder = recorder.folder

    def conclude(status: str, **more: object) -> None:
        recorder.forget_others()
        result = outcome(status, simulation.case, simulation.model, recorder, simulation.course, threads)
        write_result(folder, result | more, recorder.digests)

    try:
        _go(simulation, keeper)
        conclude("done")
    except NumericalFailure as error:
        snapshot_failed(simulation, error.failure)
        conclude("failed", failure=error.failure)
        _remove_checkpoints(folder)
        raise NumericalFailure(message(error.failure, simulation.course.retries), error.failure) from None
    except Stopped as stopped:
        recorder.snapshot("stopped")
        conclude("stopped")
        solver = simulation.solver
        raise Interrupted(
            f"stopped by {stopped} at step {solver.steps}, t = {solver.time:.4g} s, in {folder}; "
            "the same command goes on from there"
        ) from None
    _remove_checkpoints(folder)  # the run has ended
    return Results(folder)


def _go(simulation: Run, keeper: Keeper) -> None:
    """All that is left of a run; where it goes wrong, with smaller time steps if that is asked for."""
    while True:
        try:
            return simulation.go(keeper.pause)
        except NumericalFailure as error:
            if simulation.good.maxlen != GO_BACK or not step_back(simulation, error.failure):
                raise
            told = simulation.course.retries
            simulation.notify(
                f"note: {told[-1]['cause']} at step {told[-1]['step']}, t = {told[-1]['time']:.4g} s; going back to "
                f"t = {told[-1]['from_time']:.4g} s and on with time.cfl = {told[-1]['new_cfl']:g} "
                f"(retry {len(told)} of at most {MOST_HALVINGS})"
            )
            keeper.write()  # the last one is of a course that is given up, and needs its snapshots


def _remove_checkpoints(folder: Path) -> None:
    for name in CHECKPOINT_FILES:
        remove(folder / name)
