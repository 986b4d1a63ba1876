"""A run killed at any moment, any number of times, is resumed by the same command and ends with equal bits."""

from __future__ import annotations

import random
import signal
import time
from collections.abc import Callable
from pathlib import Path

from mpmcol.io.run_status import read_status
from tests.soak.commands import finish, reference_seconds, run_arguments, start, stop, wait_for
from tests.support.runs import SMALL_CASES

COUNT = 200
SMALL_COUNT = 4
MOST_KILLS = 3
DELAY = 0.03  # s after a file was written
COLD_EVERY, COMPILATION = 50, 30.0  # one of so many trials compiles its kernels, in about so many seconds
FILES = (
    *("case.resolved.toml", "checkpoint-0.npz", "checkpoint-1.npz", "history.csv", "run.vtkhdf", "result.json"),
    *(f"snapshots/00000{k}.vtkhdf" for k in range(4)),
)


def trial(seed: int, folder: Path) -> str | None:
    """Kill a run up to three times, change the number of threads in between, and let it end."""
    draw, name = random.Random(seed), list(SMALL_CASES)[seed % len(SMALL_CASES)]
    run, duration, environment = folder / "run", reference_seconds(name), {}
    if seed % COLD_EVERY == COLD_EVERY - 1:
        duration, environment = COMPILATION, {"MPMCOL_CACHE_DIR": str(folder / "cache")}
    for _ in range(draw.randint(1, MOST_KILLS)):
        if read_status(run).name == "done":
            break
        threads = draw.randint(1, 2)
        checkpoint = draw.choice(("0.001s", "0.05s", "5min"))
        options = ["--out", str(run), "--threads", str(threads), "--checkpoint", checkpoint]
        process = start([*run_arguments(name), *options], {"NUMBA_NUM_THREADS": str(threads), **environment})
        wait_for(process, random_moment(draw, run, duration))
        messages, _ = stop(process, signal.SIGKILL)
        if process.returncode not in (0, -signal.SIGKILL):
            return f"exit code {process.returncode} before it was killed: {messages}"
    return finish(name, run, draw.randint(1, 2), environment)


def random_moment(draw: random.Random, folder: Path, duration: float) -> Callable[[], bool]:
    """A condition: a random share of a run's duration has passed, or one of its files was written a moment ago."""
    if draw.random() < 0.5:
        due = time.monotonic() + draw.random() * duration
        return lambda: time.monotonic() > due
    file, delay = folder / draw.choice(FILES), draw.random() * DELAY
    before, written_at = modified(file), 0.0

    def is_due() -> bool:
        nonlocal written_at
        if not written_at and modified(file) != before:
            written_at = time.monotonic()
        return bool(written_at) and time.monotonic() > written_at + delay

    return is_due


def modified(path: Path) -> int:
    """Time of the last change of a file, ns; 0 if it does not exist."""
    try:
        return path.stat().st_mtime_ns
    except OSError:
        return 0
