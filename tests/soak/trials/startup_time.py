"""Help appears within 0.2 s, the first step within 2 s with compiled kernels and within 20 s, announced, without."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from tests.soak.commands import ONE_THREAD, PATIENCE, ROOT, STOPPED, child_cpu_time, reference_run, run_arguments

COUNT = 20
SMALL_COUNT = 1
TRIES = 3  # of which the fastest counts
HELP, WARM, COLD = 0.2, 2.0, 20.0  # s of CPU time
COLD_EVERY = 5  # one of so many trials compiles its kernels
ANNOUNCED = "preparing kernels"


def trial(seed: int, folder: Path) -> str | None:
    """Time the help, and runs until they are ready for their first step."""
    reference_run("plane")  # compiles the kernels
    failures = [
        too_slow("help", HELP, lambda k: cpu_time(["--help"])),
        too_slow("warm", WARM, lambda k: cpu_time(until_first_step(folder / f"{k}"))),
    ]
    if seed % COLD_EVERY == COLD_EVERY - 1:
        cache = {"MPMCOL_CACHE_DIR": str(folder / "cache")}
        failures.append(too_slow("cold", COLD, lambda k: cpu_time(until_first_step(folder / "cold"), cache), tries=1))
    return "; ".join(filter(None, failures)) or None


def until_first_step(out: Path) -> list[str]:
    """The arguments of a run that stops as soon as it is ready for its first step."""
    return [*run_arguments("plane"), "--out", str(out), "--max-wall", "0.001s"]


def too_slow(name: str, limit: float, attempt: Callable[[int], float], tries: int = TRIES) -> str | None:
    """Describe what took longer than its limit in every attempt."""
    best = min(attempt(k) for k in range(tries))
    return f"{name}: {best:.2f} s, more than {limit} s" if best > limit else None


def cpu_time(arguments: list[str], environment: dict[str, str] | None = None) -> float:
    """CPU time of a command, s."""
    variables = {**os.environ, "PYTHONPATH": str(ROOT), **ONE_THREAD, **(environment or {})}
    started = child_cpu_time()
    command = [sys.executable, "-m", "mpmcol", *arguments]
    done = subprocess.run(command, env=variables, capture_output=True, text=True, timeout=PATIENCE)
    seconds = child_cpu_time() - started
    assert done.returncode in (0, STOPPED), done.stderr
    assert not environment or ANNOUNCED in done.stderr, "compilation was not announced"
    return seconds
