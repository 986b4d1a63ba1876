"""When checkpoints of a run are written, and what they hold."""

from __future__ import annotations

import json
import time
from collections.abc import Mapping
from typing import Any

import numpy as np

from mpmcol.case import Case
from mpmcol.case.values import leaf_values
from mpmcol.io.checkpoint import FORMAT, Checkpoint, write_checkpoint
from mpmcol.io.lock import Lock
from mpmcol.mpm.grid import Tiles
from mpmcol.provenance import code_version
from mpmcol.simulation.interrupt import StopRequest
from mpmcol.simulation.state import RunState, Simulation

INTERVAL = 300.0  # s of wall-clock time between two checkpoints
NON_NUMERICAL_KEYS = ("title", "score.experiment")  # keys of a case that do not affect the state
ARRAYS = (
    "points",
    "clock",
    "ledger",
    "contact_sums",
    "initial_positions",
    "inactive",
)  # of a RunState, besides its tiles


class Checkpointer:
    """Writes checkpoints of a simulation to its folder: at intervals, and before the run stops on request."""

    def __init__(
        self, simulation: Simulation, stop: StopRequest, lock: Lock, interval: float, resumed_from: Checkpoint | None
    ) -> None:
        self._simulation, self._stop, self._lock, self._interval = simulation, stop, lock, interval
        self._serial = resumed_from.serial if resumed_from else 0
        self._written = time.monotonic()

    def between_steps(self) -> None:
        """Write a checkpoint if one is due or a stop was requested.

        Raises Stopped if a stop was requested, OutputError if the folder is gone.
        """
        self._lock.check()
        if self._stop.reason:
            self.write()
            self._stop.raise_if_requested()
        if time.monotonic() - self._written > self._interval:
            self.write()

    def write(self) -> None:
        """Write a checkpoint now. Raises OutputError."""
        self._serial += 1
        write_checkpoint(self._simulation.recorder.folder, make_checkpoint(self._simulation, self._serial))
        self._written = time.monotonic()


def make_checkpoint(simulation: Simulation, serial: int) -> Checkpoint:
    """A checkpoint of the present state and, for a retry, of the last valid states."""
    values, arrays = disassemble(simulation.state())
    states = [disassemble(state) for state in simulation.valid_states] if simulation.retry else []
    for k, (_, others) in enumerate(states):
        arrays |= {f"valid-{k}-{name}": array for name, array in others.items()}
    header = {"format": FORMAT, "identity": identity(simulation.case)}
    return Checkpoint(serial, {**header, **values, "valid_states": [others for others, _ in states]}, arrays)


def identity(case: Case) -> dict[str, Any]:
    """What determines the bits of a run: the values of the case, except NON_NUMERICAL_KEYS, and the code version."""
    values = {key: value for key, value in leaf_values(case).items() if key not in NON_NUMERICAL_KEYS}
    return {"case": json.loads(json.dumps(values)), "version": code_version()}


def disassemble(state: RunState) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Plain values and arrays of a state."""
    arrays = {name: getattr(state, name) for name in ARRAYS} | state.tiles._asdict()
    return {"progress": state.progress, "recorder": state.recorder}, arrays


def assemble(values: Mapping[str, Any], arrays: Mapping[str, np.ndarray]) -> RunState:
    """The state of these values and arrays."""
    return RunState(
        **{name: arrays[name] for name in ARRAYS},
        tiles=Tiles(*(arrays[name] for name in Tiles._fields)),
        progress=values["progress"],
        recorder=values["recorder"],
    )
