"""Keeping the state of a run while it goes, and going on from it: afterwards every bit is as without the stop."""

from __future__ import annotations

import json
import time
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from mpmcol.case import Case
from mpmcol.case.schema import leaf_values
from mpmcol.checkpoint import FORMAT, Checkpoint, lost_snapshots, read_checkpoints, write_checkpoint
from mpmcol.course import Course
from mpmcol.errors import OutputError, UsageError
from mpmcol.files import CHECKPOINT_FILES, Lock
from mpmcol.grid import ASLEEP, WALLS, Tiles
from mpmcol.kernels import cycle
from mpmcol.scene import Scene, close_walls
from mpmcol.stages import Run, Say
from mpmcol.stop import StopRequest
from mpmcol.version import code_version

INTERVAL = 300.0  # s of the machine between two checkpoints
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


def capture(run: Run, serial: int) -> Checkpoint:
    """The state of a run between two steps."""
    solver, recorder = run.solver, run.recorder
    assert solver.tiles is not None  # a run pauses only after it has prepared its kernels
    arrays = {
        "rows": solver.points.rows, "clock": solver.clock, "ledger": solver.ledger, "released": recorder.released,
        "asleep": np.flatnonzero(solver.grid.fixed & ASLEEP), **solver.tiles._asdict(),
    }  # fmt: skip
    meta = {
        "format": FORMAT, "identity": identity(run.case), "course": asdict(run.course), "recorder": recorder.memory(),
    }  # fmt: skip
    return Checkpoint(serial, meta, arrays)


def way_on(folder: Path) -> str:
    """What becomes of a run that cannot write any more, as a person reads it."""
    if any((folder / name).exists() for name in CHECKPOINT_FILES):
        return f"once that is mended, the same command goes on from the state that is kept in {folder}"
    return f"no state is kept in {folder}: once that is mended, the same command begins anew"


def last_state(folder: Path, say: Say) -> Checkpoint | None:
    """The latest state in a folder that is whole, and whose snapshots are; None if there is no whole state.

    say: is told what is damaged. Raises OutputError if there are states, but none has its snapshots, UsageError if they
    are of a format that this version does not know.
    """
    states, damaged = read_checkpoints(folder)
    for name in damaged:
        say(f"note: {folder / name} is damaged; " + ("going on from the one before" if states else "beginning anew"))
    if any(state.meta.get("format") != FORMAT for state in states):
        raise UsageError(f"{folder} holds an unfinished run of another version's format; --fresh begins anew")
    lost: list[str] = []
    for state in states:
        if not (lost := lost_snapshots(folder, state)):
            return state
        say(f"note: {folder / lost[0]} is damaged or missing, and step {step_of(state)} needs it")
    if not states:
        return None
    raise OutputError(
        f"{folder / lost[0]} is damaged or missing, and the unfinished run cannot take it again: it is of a time "
        f"before the states that are kept ({', '.join(CHECKPOINT_FILES)}); copy it back, or begin anew with --fresh"
    )


def step_of(state: Checkpoint) -> int:
    """The number of steps done."""
    return int(state.arrays["clock"][cycle.STEPS])


def require_same_points(scene: Scene, checkpoint: Checkpoint) -> None:
    """Raise UsageError if a scene has not the points of a state."""
    if scene.points.rows.shape != checkpoint.arrays["rows"].shape:
        raise UsageError("the unfinished run has other points than this case makes; --fresh starts anew")


def restore(run: Run, checkpoint: Checkpoint) -> None:
    """Put a run that has just been set up into the state of a checkpoint of the same scene."""
    solver, arrays = run.solver, checkpoint.arrays
    run.course = Course(**checkpoint.meta["course"])
    solver.points.rows[:] = arrays["rows"]
    solver.clock[:], solver.ledger[:] = arrays["clock"], arrays["ledger"]
    close_walls(solver.grid, run.scene.layout, run.course.opening)
    solver.grid.fixed[:] &= WALLS
    solver.grid.fixed[arrays["asleep"]] |= ASLEEP
    solver.list_tiles(Tiles(*(arrays[name] for name in Tiles._fields)))
    run.recorder.recall(checkpoint.meta["recorder"], arrays["released"])
    run.course.continued.append({"step": solver.steps, "version": code_version()})


def identity(case: Case) -> dict[str, Any]:
    """What decides the bits of a run: the values of its case, and the code."""
    values = {key: value for key, value in leaf_values(case).items() if key not in WITHOUT_A_SAY}
    return {"case": json.loads(json.dumps(values)), "version": code_version()}


def differences(checkpoint: Checkpoint, case: Case) -> list[str]:
    """How the run that a checkpoint is of differs from one of this case and this code, a line each."""
    there, here = checkpoint.meta["identity"], identity(case)
    old, new = there["case"], here["case"]
    told = [f"{key}: {old.get(key)} there, {new.get(key)} here" for key in old | new if old.get(key) != new.get(key)]
    if there["version"] != here["version"]:
        told.append(f"made by mpmcol {there['version']}, this is {here['version']}")
    return told
