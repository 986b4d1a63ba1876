"""How long idle threads wait for the next phase of a step before they yield their core."""

from __future__ import annotations

import math
import os


def spin_count() -> int:
    """Turns of a loop in which an idle thread waits for the next phase before it yields its core.

    A thread that has yielded starts late. On an idle machine with two cores, two threads gain 1.4 with 1,000 turns and
    1.7 with 10,000 (8 thousand points in plane strain); beside another program a step takes 0.6 ms and 1.7 ms. By
    default libgomp waits for milliseconds.
    """
    busy = os.getloadavg()[0] if hasattr(os, "getloadavg") else math.inf
    return 10_000 if busy <= 0.25 * (os.cpu_count() or 1) else 1_000
