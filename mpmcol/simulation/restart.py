"""Keeping the state of a run while it goes, and going on from it: afterwards every bit is as without the stop.

States are kept on disk, for a run that is stopped or killed, and in memory, for one that goes wrong.
"""

from __future__ import annotations

import json
import time
from collections import deque
from copy import deepcopy
from dataclasses import asdict
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from mpmcol.case import Case
from mpmcol.case.schema import leaf_values
from mpmcol.errors import OutputError, UsageError
from mpmcol.io.checkpoint import FORMAT, Checkpoint, damaged_snapshots, read_checkpoints, write_checkpoint
from mpmcol.io.lock import Lock
from mpmcol.io.names import CHECKPOINT_FILES
from mpmcol.mpm.grid import INACTIVE, WALLS, Tiles
from mpmcol.mpm.kernels import loop
from mpmcol.provenance import code_version
from mpmcol.setup.model import Model, close_walls
from mpmcol.simulation.interrupt import StopRequest
from mpmcol.simulation.progress import Course
from mpmcol.simulation.stages import Notify, Run

INTERVAL = 300.0  # s of the machine between two checkpoints
GO_BACK = 2  # states that are kept to go back to, at KEEP_CHECKS of each other: the older one is before the trouble
MOST_HALVINGS = 4  # of the time step of a run that goes wrong
WITHOUT_A_SAY = ("title", "score.experiment")  # keys of a case that may change on the way


class Keeper:
    """Writes checkpoints of a run when they are due, and when it is asked to end."""

    def __init__(self, run: Run, stop: StopRequest, lock: Lock, interval: float, begun: Checkpoint | None) -> None:
        self._run, self._stop, self._lock, self._interval = run, stop, lock, interval
        self._serial = begun.serial if begun else 0
        self._written = time.monotonic()

    def pause(self) -> None:
        """To be called where the run is between two steps.

        Raises Stopped if it has been asked to end, OutputError if its folder is gone.
        """
        self._lock.check()
        if self._stop.asked:
            self.write()
            self._stop.heed()
        if time.monotonic() - self._written > self._interval:
            self.write()

    def write(self) -> None:
        """Write a checkpoint now; raises OutputError."""
        self._serial += 1
        write_checkpoint(self._run.recorder.folder, capture(self._run, self._serial))
        self._written = time.monotonic()


class State(NamedTuple):
    """A run between two steps."""

    meta: dict[str, Any]
    arrays: dict[str, np.ndarray]


def remember(run: Run) -> None:
    """Add a copy of the present state to those that the run can go back to."""
    meta, arrays = _present(run)
    copies = {name: arrays[name].copy() for name in ("rows", "clock", "ledger")}  # the others are never changed
    meta["recorder"]["rows"] = list(meta["recorder"]["rows"])
    run.good.append(State(meta, arrays | copies))


def capture(run: Run, serial: int) -> Checkpoint:
    """The state of a run between two steps, with those that it can go back to."""
    meta, arrays = _present(run)
    kept = run.good if run.good.maxlen == GO_BACK else ()
    for k, state in enumerate(kept):
        arrays |= {f"good-{k}-{name}": array for name, array in state.arrays.items()}
    meta = {"format": FORMAT, "identity": identity(run.case), **meta, "good": [state.meta for state in kept]}
    return Checkpoint(serial, meta, arrays)


def way_on(folder: Path) -> str:
    """What becomes of a run that cannot write any more, as a person reads it."""
    if any((folder / name).exists() for name in CHECKPOINT_FILES):
        return f"once that is mended, the same command goes on from the state that is kept in {folder}"
    return f"no state is kept in {folder}: once that is mended, the same command begins anew"


def last_state(folder: Path, notify: Notify) -> Checkpoint | None:
    """The latest state in a folder that is whole, and whose snapshots are; None if there is no whole state.

    notify: receives damage. Raises OutputError if there are states, but none has its snapshots, UsageError if they
    are of a format that this version does not know.
    """
    states, damaged = read_checkpoints(folder)
    for name in damaged:
        notify(f"note: {folder / name} is damaged; " + ("going on from the one before" if states else "beginning anew"))
    if any(state.values.get("format") != FORMAT for state in states):
        raise UsageError(f"{folder} holds an unfinished run of another version's format; --fresh begins anew")
    lost: list[str] = []
    for state in states:
        if not (lost := damaged_snapshots(folder, state)):
            return state
        notify(f"note: {folder / lost[0]} is damaged or missing, and step {step_of(state)} needs it")
    if not states:
        return None
    raise OutputError(
        f"{folder / lost[0]} is damaged or missing, and the unfinished run cannot take it again: it is of a time "
        f"before the states that are kept ({', '.join(CHECKPOINT_FILES)}); copy it back, or begin anew with --fresh"
    )


def step_of(state: Checkpoint) -> int:
    """The number of steps done."""
    return int(state.arrays["clock"][loop.STEPS])


def require_same_points(model: Model, checkpoint: Checkpoint) -> None:
    """Raise UsageError if a model has not the points of a state."""
    if model.points.rows.shape != checkpoint.arrays["rows"].shape:
        raise UsageError("the unfinished run has other points than this case makes; --fresh starts anew")


def restore(run: Run, checkpoint: Checkpoint) -> None:
    """Put a run that has just been set up into the state of a checkpoint of the same model."""
    meta, arrays = checkpoint.values, dict(checkpoint.arrays)
    for k, other in enumerate(meta["good"]):
        prefix = f"good-{k}-"
        kept = {name.removeprefix(prefix): arrays.pop(name) for name in list(arrays) if name.startswith(prefix)}
        run.good.append(State(other, kept))
    _put(run, State(dict(meta), arrays))
    run.recorder.forget_others()
    run.course.resumed.append({"step": run.solver.steps, "version": code_version()})


def step_back(run: Run, failure: dict[str, Any]) -> bool:
    """Take a run that has gone wrong back to where nothing was, with half the time step; False if that cannot help."""
    last, before = run.course, run.solver
    if not failure["smaller_step_helps"] or len(last.retries) >= MOST_HALVINGS:
        return False
    cfl = before.settings.cfl
    told = {name: failure[name] for name in ("check", "cause", "stage", "step", "time")}
    seconds, state = run.recorder.seconds, run.good[0]
    _put(run, state)
    told |= {"cfl": cfl, "new_cfl": 0.5 * cfl, "from_step": run.solver.steps, "from_time": run.solver.time}
    run.good = deque([state], GO_BACK)
    run.recorder.seconds = seconds
    course = run.course
    course.step_share, course.retries = 0.5 * last.step_share, [*last.retries, told]
    course.warnings, course.resumed, course.wall_s, course.cpu_s = (
        last.warnings, last.resumed, last.wall_s, last.cpu_s
    )  # fmt: skip
    run.solver.clock[loop.DT] *= 0.5
    return True


def snapshot_failed(run: Run, failure: dict[str, Any]) -> None:
    """Write the last state that no check complained of, unless a later snapshot is there, and then the present one."""
    recorder, solver, state = run.recorder, run.solver, run.good[-1]
    sound_until = max([state.arrays["clock"][loop.TIME], *(row["time"] for row in recorder.rows[-2:-1])])
    if not any(time >= state.arrays["clock"][loop.TIME] for time in recorder.snapshot_times):
        rows, clock = solver.points.rows.copy(), solver.clock.copy()
        solver.points.rows[:], solver.clock[:] = state.arrays["rows"], state.arrays["clock"]
        recorder.snapshot("last_valid")
        solver.points.rows[:], solver.clock[:] = rows, clock
    failure["last_valid"] = max(k for k, time in enumerate(recorder.snapshot_times) if time <= sound_until)
    recorder.snapshot("failed")


def _present(run: Run) -> State:
    solver, recorder = run.solver, run.recorder
    assert solver.tiles is not None  # a run pauses only after it has prepared its kernels
    arrays = {
        "rows": solver.points.rows, "clock": solver.clock, "ledger": solver.ledger, "released": recorder.released,
        "inactive": np.flatnonzero(solver.grid.fixed & INACTIVE), **solver.tiles._asdict(),
    }  # fmt: skip
    return State({"course": asdict(run.course), "recorder": recorder.memory()}, arrays)


def _put(run: Run, state: State) -> None:
    """Make `state`, which stays as it is, that of a run of the same model."""
    solver, (meta, arrays) = run.solver, state
    run.course = Course(**deepcopy(meta["course"]))
    solver.points.rows[:] = arrays["rows"]
    solver.clock[:], solver.ledger[:] = arrays["clock"], arrays["ledger"]
    close_walls(solver.grid, run.model.discretization, run.course.opening)
    solver.grid.fixed[:] &= WALLS
    solver.grid.fixed[arrays["inactive"]] |= INACTIVE
    solver.list_tiles(Tiles(*(arrays[name] for name in Tiles._fields)))
    run.recorder.recall(meta["recorder"] | {"rows": list(meta["recorder"]["rows"])}, arrays["released"])


def identity(case: Case) -> dict[str, Any]:
    """What decides the bits of a run: the values of its case, and the code."""
    values = {key: value for key, value in leaf_values(case).items() if key not in WITHOUT_A_SAY}
    return {"case": json.loads(json.dumps(values)), "version": code_version()}


def differences(checkpoint: Checkpoint, case: Case) -> list[str]:
    """How the run that a checkpoint is of differs from one of this case and this code, a line each."""
    there, here = checkpoint.values["identity"], identity(case)
    old, new = there["case"], here["case"]
    told = [f"{key}: {old.get(key)} there, {new.get(key)} here" for key in old | new if old.get(key) != new.get(key)]
    if there["version"] != here["version"]:
        told.append(f"made by mpmcol {there['version']}, this is {here['version']}")
    return told
