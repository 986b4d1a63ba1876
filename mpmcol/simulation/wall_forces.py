"""Mean forces on the walls between two rows of the history, from the impulses of their nodes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from mpmcol.measure.wall_forces import AXES, column
from mpmcol.mpm.contact import Contacts, wall_impulses


class WallForces:
    """Forces on `walls`, the walls of a table of contacts in the order of their numbers; none without names."""

    def __init__(self, contacts: Contacts, walls: Sequence[str], dimension: int) -> None:
        self._contacts, self._walls, self._axes = contacts, walls, AXES[:dimension]
        self._time, self._impulses, self._forces = 0.0, np.zeros((len(walls), 3)), np.zeros((len(walls), 3))

    def start(self, time: float) -> None:
        """Start to measure at a time (s) at which the sums of impulses were set to zero."""
        self._time, self._impulses = time, np.zeros_like(self._impulses)

    def columns(self, time: float) -> dict[str, float]:
        """Columns of the history: mean forces since the previous call, or those of that call if no time has passed."""
        impulses = wall_impulses(self._contacts, len(self._walls))
        if time > self._time:
            self._forces = (impulses - self._impulses) / (time - self._time)
            self._time, self._impulses = time, impulses
        return {
            column(wall, axis): float(self._forces[number, k])
            for number, wall in enumerate(self._walls)
            for k, axis in enumerate(self._axes)
        }

    def memory(self) -> dict[str, Any]:
        """State as plain values, for a checkpoint."""
        return {"time": self._time, "impulses": self._impulses.tolist(), "forces": self._forces.tolist()}

    def set_memory(self, memory: Mapping[str, Any]) -> None:
        """Continue from a state."""
        self._time = memory["time"]
        shape = self._forces.shape
        self._impulses, self._forces = (np.reshape(memory[name], shape) for name in ("impulses", "forces"))
