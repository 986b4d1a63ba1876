"""A simulation in progress, and copies of its state: everything that the further steps depend on."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from copy import deepcopy
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from mpmcol.case import Case
from mpmcol.mpm.boundary import inactive_nodes, set_inactive_nodes
from mpmcol.mpm.grid import Tiles
from mpmcol.mpm.kernels import loop
from mpmcol.mpm.solver import Solver
from mpmcol.setup.model import Model, initial_gate_opening, set_boundaries
from mpmcol.simulation.progress import RunProgress
from mpmcol.simulation.recorder import Recorder

ShowProgress = Callable[[str, float], None]  # stage, fraction of it that is done
Notify = Callable[[str], None]  # one line for the user


def no_progress(stage: str, fraction: float) -> None:
    """Ignore the progress of a run."""


def no_messages(line: str) -> None:
    """Ignore the messages of a run."""


STATES_FOR_RETRY = 2  # valid states kept in memory; a retry starts from the older one, which precedes the failure


@dataclass(frozen=True)
class RunState:
    """The state of a run between two steps. A run that is set to it continues with equal bits."""

    points: np.ndarray  # (n, 24 or 32) records of the material points
    clock: np.ndarray
    ledger: np.ndarray
    initial_positions: np.ndarray  # (n, d) by point id: displacements are measured from them
    contact_sums: np.ndarray  # impulses on walls and work of friction
    inactive: np.ndarray  # addresses of the nodes that inactive points hold
    tiles: Tiles
    progress: Mapping[str, Any]  # fields of RunProgress
    recorder: Mapping[str, Any]  # Recorder.memory

    @property
    def time(self) -> float:
        """Time on the clock, s."""
        return float(self.clock[loop.TIME])

    def copy(self) -> RunState:
        """A state that further steps do not change; the remaining arrays and values are never modified in place."""
        return replace(
            self,
            points=self.points.copy(),
            clock=self.clock.copy(),
            ledger=self.ledger.copy(),
            contact_sums=self.contact_sums.copy(),
            recorder={**self.recorder, "rows": list(self.recorder["rows"])},
        )


class Simulation:
    """A run in progress: model, solver, recorder and progress, with its last valid states.

    retry: whether states are kept for a retry with a smaller time step.
    """

    def __init__(
        self,
        case: Case,
        model: Model,
        recorder: Recorder,
        *,
        retry: bool = False,
        show_progress: ShowProgress = no_progress,
        notify: Notify = no_messages,
    ) -> None:
        self.case, self.model, self.recorder = case, model, recorder
        self.solver: Solver = recorder.solver
        self.progress = RunProgress(gate_opening=initial_gate_opening(case))
        self.retry = retry
        self.valid_states: deque[RunState] = deque(maxlen=STATES_FOR_RETRY if retry else 1)  # the latest is the last
        self.show_progress, self.notify = show_progress, notify

    @property
    def fall_time(self) -> float:
        """Time scale sqrt(h_i / g) of the collapse, s."""
        return self.model.discretization.fall_time(self.case.geometry.gravity)

    def warn(self, text: str) -> None:
        """Report a warning, and list it in the result."""
        self.progress.warnings.append(text)
        self.notify(f"note: {text}")

    def state(self) -> RunState:
        """The present state; its arrays are those of the solver, not copies."""
        solver = self.solver
        assert solver.tiles is not None  # the kernels have been prepared
        return RunState(
            points=solver.points.rows,
            clock=solver.clock,
            ledger=solver.ledger,
            contact_sums=solver.contacts.sums,
            initial_positions=self.recorder.initial_positions,
            inactive=inactive_nodes(solver.grid),
            tiles=solver.tiles,
            progress=asdict(self.progress),
            recorder=self.recorder.memory(),
        )

    def set_state(self, state: RunState) -> None:
        """Continue from `state`, which is not changed, of a run of the same model."""
        solver = self.solver
        self.progress = RunProgress(**deepcopy(dict(state.progress)))
        solver.points.rows[:] = state.points
        solver.clock[:], solver.ledger[:] = state.clock, state.ledger
        solver.contacts.sums[:] = state.contact_sums
        set_boundaries(solver.grid, self.model.discretization, self.progress.gate_opening)
        set_inactive_nodes(solver.grid, state.inactive)
        solver.set_tiles(state.tiles)
        self.recorder.set_memory(state.recorder, state.initial_positions)

    def keep_valid_state(self) -> None:
        """Keep a copy of the present state as the last valid one."""
        self.valid_states.append(self.state().copy())
