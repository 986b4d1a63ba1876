"""Mutable progress of a run, saved in its checkpoints."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any


@dataclass
class RunProgress:
    """Stage reached and counters of the loops; `wall_s` and `cpu_s` are wall-clock and processor time."""

    stage: str = "equilibrate"
    next_check: float = 0.0  # s: time of the next check during equilibration
    converged_checks: int = 0  # consecutive checks during equilibration with the unbalanced force below the tolerance
    checks: int = 0  # checks since the release
    release_step: int = 0
    gate_opening: float = 0.0  # m: height that the lower edge of the gate has reached; inf without a gate
    at_rest: bool = False
    valid_checks: int = 0  # checks of the present stage that found no failure
    cfl_factor: float = 1.0  # factor of time.cfl, halved by each retry
    retries: list[dict[str, Any]] = field(default_factory=list)  # a record of each failure that was retried
    warnings: list[str] = field(default_factory=list)
    resumed: list[dict[str, Any]] = field(default_factory=list)  # step and version of each resumption
    wall_s: dict[str, float] = field(
        default_factory=lambda: dict.fromkeys(("compile", "equilibrate", "collapse", "output"), 0.0)
    )
    cpu_s: float = 0.0  # without compilation

    @contextmanager
    def timed(self, part: str) -> Iterator[None]:
        """Add the time spent in the context to `wall_s[part]`."""
        wall, cpu = time.perf_counter(), time.process_time()
        try:
            yield
        finally:
            self.wall_s[part] += time.perf_counter() - wall
            self.cpu_s += (time.process_time() - cpu) * (part != "compile")
