"""Runs that start at once with one empty kernel cache all end right, and of two in one folder the second is refused."""

from __future__ import annotations

import random
import subprocess
from pathlib import Path
from time import sleep

from tests.soak._runs import PATIENCE, compare, described, start, undisturbed, words

COUNT = 10
DRAW = 1
NAME = "plane"
AT_ONCE = (2, 2, 2, 4, 2, 2, 2, 4, 2, 16)  # runs of the trials; each compiles everything
REFUSED = 5  # exit code


def trial(seed: int, folder: Path) -> str | None:
    """Start the runs within a moment, and one more in the folder of the first once that has begun."""
    draw, count = random.Random(seed), AT_ONCE[seed % len(AT_ONCE)]
    whole = undisturbed(NAME)
    runs = [begin(folder, k, draw.randint(1, 2)) for k in range(count)]
    while runs[0].poll() is None and not (folder / "0" / "case.resolved.toml").exists():
        sleep(0.01)
    runs.append(begin(folder, 0, 1))
    wrong = [told for k, run in enumerate(runs) if (told := ended(run, 0 if k < count else REFUSED))]
    return next(filter(None, [*wrong, *(compare(whole, folder / f"{k}") for k in range(count))]), None)


def begin(folder: Path, k: int, threads: int) -> subprocess.Popen[str]:
    """Start a run in the folder's k-th place."""
    environment = {"NUMBA_NUM_THREADS": str(threads), "MPMCOL_CACHE_DIR": str(folder / "cache")}
    return start([*words(NAME), "--out", str(folder / f"{k}"), "--threads", str(threads)], environment)


def ended(run: subprocess.Popen[str], code: int) -> str | None:
    """What is wrong with how a run ended."""
    _, said = run.communicate(timeout=PATIENCE)
    told = "another run is writing here" in said
    if run.returncode == code and told == (code == REFUSED):
        return None
    return f"{described(run.returncode)} instead of {code}: {said}"
