"""How long idle threads wait for the next phase of a step before they yield their core."""

from __future__ import annotations

import math
import os


def spin_count() -> int:
    """Turns of a loop in which an idle thread waits for the next phase before it yields its core.

    A thread that has yielded starts 50 microseconds late: on an idle machine it waits for some 0.2 ms. With other
    programs on the same cores a step would then take three times longer, and a hundred times with the milliseconds that
    libgomp waits by default.
    """
    busy = os.getloadavg()[0] if hasattr(os, "getloadavg") else math.inf
    return 10_000 if busy <= 0.25 * (os.cpu_count() or 1) else 1_000
