"""Signals end a run within two seconds with exit code 75, and it resumes with equal bits."""

from __future__ import annotations

import random
import signal
from pathlib import Path

from mpmcol.io.lock import is_locked
from mpmcol.io.run_status import read_status
from mpmcol.simulation.interrupt import SIGNALS
from tests.soak.commands import STOPPED, describe_exit, finish, reference_seconds, run_arguments, start, stop, wait_for
from tests.soak.trials.killed_runs import random_moment
from tests.support.runs import SMALL_CASES

COUNT = 100
SMALL_COUNT = 3
TIME_LIMIT = 2.0  # s of CPU time


def trial(seed: int, folder: Path) -> str | None:
    """Stop a run up to three times with any of the signals, and let it end with another number of threads."""
    draw, name = random.Random(seed), list(SMALL_CASES)[seed % len(SMALL_CASES)]
    run, duration = folder / "run", reference_seconds(name)
    for _ in range(draw.randint(1, 3)):
        handled = [number for number in SIGNALS if signal.getsignal(number) is not signal.SIG_IGN]  # nohup ignores one
        threads, number = draw.randint(1, 2), draw.choice(handled)
        arguments = [*run_arguments(name), "--out", str(run), "--threads", str(threads)]
        process = start(arguments, {"NUMBA_NUM_THREADS": str(threads)})
        wait_for(process, random_moment(draw, run, duration))
        has_begun = is_locked(run)
        messages, seconds = stop(process, number)
        is_done = read_status(run).name == "done"
        # outside of the run itself there is nothing to save, and the signal ends the program
        allowed = (0, STOPPED) if has_begun and not is_done else (0, STOPPED, 130, -number)
        if process.returncode not in allowed or seconds > TIME_LIMIT or "Traceback" in messages:
            ended = describe_exit(process.returncode)
            return f"{signal.Signals(number).name}: {ended} after {seconds:.2f} s: {messages}"
        if is_done:
            break
    return finish(name, run, draw.randint(1, 2))
