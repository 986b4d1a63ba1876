"""Help is there within 0.2 s, a first step within 2 s with compiled kernels, and within 20 s, announced, without."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from tests.soak._runs import PATIENCE, QUIET, ROOT, STOPPED, cpu_time, undisturbed, words

COUNT = 20
DRAW = 1
TRIES = 3  # of which the fastest counts
HELP, WARM, COLD = 0.2, 2.0, 20.0  # s of a core
COLD_TRIALS = 5  # one of so many is cold
ANNOUNCED = "preparing kernels (compiled once, then kept)"


def trial(seed: int, folder: Path) -> str | None:
    """Time the program until it has helped, or is ready for the first step of a run."""
    undisturbed("plane")  # compiles
    told = [
        late("help", HELP, lambda k: timed(["--help"])),
        late("warm", WARM, lambda k: timed(until_ready(folder / f"{k}"))),
    ]
    if seed % COLD_TRIALS == COLD_TRIALS - 1:
        cache = {"MPMCOL_CACHE_DIR": str(folder / "cache")}
        told.append(late("cold", COLD, lambda k: timed(until_ready(folder / "cold"), cache), tries=1))
    return "; ".join(filter(None, told)) or None


def until_ready(out: Path) -> list[str]:
    """A run that ends as soon as it is ready for its first step."""
    return [*words("plane"), "--out", str(out), "--max-wall", "0.001s"]


def late(what: str, within: float, attempt: Callable[[int], float], tries: int = TRIES) -> str | None:
    """What took too long whenever it was tried."""
    best = min(attempt(k) for k in range(tries))
    return f"{what}: {best:.2f} s, not {within} s" if best > within else None


def timed(command: list[str], environment: dict[str, str] | None = None) -> float:
    """Seconds that a command takes of a core."""
    surroundings = {**os.environ, "PYTHONPATH": str(ROOT), **QUIET, **(environment or {})}
    started = cpu_time()
    done = subprocess.run(
        [sys.executable, "-m", "mpmcol", *command], env=surroundings, capture_output=True, text=True, timeout=PATIENCE
    )
    took = cpu_time() - started
    assert done.returncode in (0, STOPPED), done.stderr
    assert not environment or ANNOUNCED in done.stderr, "compilation was not announced"
    return took
