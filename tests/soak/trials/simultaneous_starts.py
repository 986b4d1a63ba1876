"""Runs that start at once with one empty kernel cache all succeed, and a second run in a folder is refused."""

from __future__ import annotations

import random
import subprocess
from pathlib import Path
from time import sleep

from tests.soak.commands import PATIENCE, describe_exit, difference, reference_run, run_arguments, start

COUNT = 10
SMALL_COUNT = 1
NAME = "plane"
RUNS_AT_ONCE = (2, 2, 2, 4, 2, 2, 2, 4, 2, 16)  # of the trials; each run compiles all its kernels
REFUSED = 5  # exit code


def trial(seed: int, folder: Path) -> str | None:
    """Start runs at once, and one more in the folder of the first as soon as that has begun."""
    draw, count = random.Random(seed), RUNS_AT_ONCE[seed % len(RUNS_AT_ONCE)]
    reference = reference_run(NAME)
    runs = [begin(folder, k, draw.randint(1, 2)) for k in range(count)]
    while runs[0].poll() is None and not (folder / "0" / "case.resolved.toml").exists():
        sleep(0.01)
    runs.append(begin(folder, 0, 1))
    failures = [wrong_exit(run, 0 if k < count else REFUSED) for k, run in enumerate(runs)]
    return next(filter(None, [*failures, *(difference(reference, folder / f"{k}") for k in range(count))]), None)


def begin(folder: Path, k: int, threads: int) -> subprocess.Popen[str]:
    """Start run number k."""
    environment = {"NUMBA_NUM_THREADS": str(threads), "MPMCOL_CACHE_DIR": str(folder / "cache")}
    return start([*run_arguments(NAME), "--out", str(folder / f"{k}"), "--threads", str(threads)], environment)


def wrong_exit(run: subprocess.Popen[str], code: int) -> str | None:
    """Describe how a run ended, if not with this exit code and its message."""
    _, messages = run.communicate(timeout=PATIENCE)
    is_refused = "another run is writing here" in messages
    if run.returncode == code and is_refused == (code == REFUSED):
        return None
    return f"{describe_exit(run.returncode)} instead of {code}: {messages}"
