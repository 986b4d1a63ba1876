"""A run killed at any moment, again and again, goes on by the same command and ends with equal bits."""

from __future__ import annotations

import random
import signal
import time
from collections.abc import Callable
from pathlib import Path

from mpmcol.io.run_status import read_status
from tests.soak._runs import await_, finish, seconds, start, stop, words
from tests.support.runs import SMALL_CASES

COUNT = 200
DRAW = 4
MOST_KILLS = 3
AFTER = 0.03  # s after a file has come
COLD, COMPILATION = 50, 30.0  # of so many trials one compiles its kernels, in about so many seconds
FILES = (
    *("case.resolved.toml", "checkpoint-0.npz", "checkpoint-1.npz", "history.csv", "run.vtkhdf", "result.json"),
    *(f"snapshots/00000{k}.vtkhdf" for k in range(4)),
)


def trial(seed: int, folder: Path) -> str | None:
    """Kill a run some times, change the number of threads on the way, and let it end."""
    draw, name = random.Random(seed), list(SMALL_CASES)[seed % len(SMALL_CASES)]
    run_folder, pace, environment = folder / "run", seconds(name), {}
    if seed % COLD == COLD - 1:
        pace, environment = COMPILATION, {"MPMCOL_CACHE_DIR": str(folder / "cache")}
    for _ in range(draw.randint(1, MOST_KILLS)):
        if read_status(run_folder).name == "done":
            break
        threads = draw.randint(1, 2)
        checkpoint = draw.choice(("0.001s", "0.05s", "5min"))
        options = ["--out", str(run_folder), "--threads", str(threads), "--checkpoint", checkpoint]
        run = start([*words(name), *options], {"NUMBA_NUM_THREADS": str(threads), **environment})
        await_(run, moment(draw, run_folder, pace))
        said, _ = stop(run, signal.SIGKILL)
        if run.returncode not in (0, -signal.SIGKILL):
            return f"exit code {run.returncode} before it was killed: {said}"
    return finish(name, run_folder, draw.randint(1, 2), environment)


def moment(draw: random.Random, folder: Path, pace: float) -> Callable[[], bool]:
    """Any moment of the time that a run takes, or one soon after a file of it has come or changed."""
    if draw.random() < 0.5:
        due = time.monotonic() + draw.random() * pace
        return lambda: time.monotonic() > due
    file, wait = folder / draw.choice(FILES), draw.random() * AFTER
    before, came = changed(file), 0.0

    def soon_after() -> bool:
        nonlocal came
        if not came and changed(file) != before:
            came = time.monotonic()
        return bool(came) and time.monotonic() > came + wait

    return soon_after


def changed(path: Path) -> int:
    """When a file was last changed, ns; 0 if it is not there."""
    try:
        return path.stat().st_mtime_ns
    except OSError:
        return 0
