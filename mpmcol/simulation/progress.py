"""How far a run is: what its loops must know to go on where they were, besides points and grid."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any


@dataclass
class Course:
    """Times are in s of the simulation, `wall_s` and `cpu_s` in s of the machine."""

    stage: str = "equilibrate"
    until: float = 0.0  # equilibration: when it is looked at next
    calm: int = 0  # equilibration: looks in a row at which the column rested
    checks: int = 0  # collapse: looks since the release
    first_step: int = 0  # of the collapse
    opening: float = 0.0  # m: how far the gate is lifted
    at_rest: bool = False
    sound: int = 0  # looks since the stage began that found nothing wrong
    step_share: float = 1.0  # of time.cfl that is left after runs that went wrong with more
    retries: list[dict[str, Any]] = field(default_factory=list)  # where it went wrong, and with what it went on
    warnings: list[str] = field(default_factory=list)
    resumed: list[dict[str, Any]] = field(default_factory=list)  # steps from which it was taken up again
    wall_s: dict[str, float] = field(
        default_factory=lambda: dict.fromkeys(("compile", "equilibrate", "collapse", "output"), 0.0)
    )
    cpu_s: float = 0.0  # without compilation

    @contextmanager
    def timed(self, what: str) -> Iterator[None]:
        """Count the time that is spent inside."""
        wall, cpu = time.perf_counter(), time.process_time()
        try:
            yield
        finally:
            self.wall_s[what] += time.perf_counter() - wall
            self.cpu_s += (time.process_time() - cpu) * (what != "compile")
