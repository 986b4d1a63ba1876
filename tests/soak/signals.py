"""SIGINT, SIGTERM and SIGUSR1 end a run within two seconds with exit code 75, and it goes on with equal bits."""

from __future__ import annotations

import random
import signal
from pathlib import Path

from mpmcol.io.lock import is_locked
from mpmcol.io.run_status import read_status
from mpmcol.simulation.interrupt import SIGNALS
from tests.soak._runs import STOPPED, await_, described, finish, seconds, start, stop, words
from tests.soak.kills import moment
from tests.support.runs import SMALL_CASES

COUNT = 100
DRAW = 3
WITHIN = 2.0  # s of a core


def trial(seed: int, folder: Path) -> str | None:
    """Stop a run some times with any of the signals, and let it end with another number of threads."""
    draw, name = random.Random(seed), list(SMALL_CASES)[seed % len(SMALL_CASES)]
    run_folder, pace = folder / "run", seconds(name)
    for _ in range(draw.randint(1, 3)):
        threads, number = draw.randint(1, 2), draw.choice(SIGNALS)
        command = [*words(name), "--out", str(run_folder), "--threads", str(threads)]
        run = start(command, {"NUMBA_NUM_THREADS": str(threads)})
        await_(run, moment(draw, run_folder, pace))
        begun = is_locked(run_folder)
        said, took = stop(run, number)
        done = read_status(run_folder).name == "done"
        allowed = (0, STOPPED) if begun and not done else (0, STOPPED, 130, -number)  # else there is nothing to keep
        if run.returncode not in allowed or took > WITHIN or "Traceback" in said:
            return f"{signal.Signals(number).name}: {described(run.returncode)} after {took:.2f} s: {said}"
        if done:
            break
    return finish(name, run_folder, draw.randint(1, 2))
