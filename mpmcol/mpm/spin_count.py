"""How long idle threads wait for the next phase of a step before they yield their core."""

from __future__ import annotations

import os
import time
from pathlib import Path

LONG, SHORT = 10_000, 1_000
_LOAD = Path("/proc/loadavg")  # its fourth field is the number of running threads over that of all
_SAMPLES, _INTERVAL = 3, 0.002  # s


def spin_count() -> int:
    """Turns of a loop in which an idle thread waits for the next phase before it yields its core.

    A thread that has yielded starts late. On an idle machine with two cores, two threads gain 1.4 with 1,000 turns and
    1.7 with 10,000 (8 thousand points in plane strain); beside another program a step takes 0.6 ms and 1.7 ms. By
    default libgomp waits for milliseconds.
    """
    return LONG if threads_running() <= 0.25 * (os.cpu_count() or 1) else SHORT


def threads_running() -> float:
    """Threads of other programs that compute at present, without those that run for a moment only.

    The load average still counts programs that ended a minute ago; it is used where the system tells no more.
    """
    try:
        return min(_other_threads() for _ in range(_SAMPLES))
    except (OSError, ValueError, IndexError):
        return os.getloadavg()[0] if hasattr(os, "getloadavg") else float("inf")


def _other_threads() -> int:
    time.sleep(_INTERVAL)
    return int(_LOAD.read_text("ascii").split()[3].partition("/")[0]) - 1  # this one is running
