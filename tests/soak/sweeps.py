"""A sweep whose runs or whose own process are killed, or whose disk is full, is completed by the same command.

Nothing that was done is done again, all ends with equal bits, and once more the command takes less than two seconds.
"""

from __future__ import annotations

import os
import random
import resource
import signal
import subprocess
import time
from contextlib import suppress
from functools import partial
from pathlib import Path

from mpmcol.io.results import Results
from mpmcol.io.run_status import read_status
from tests.soak._runs import PATIENCE, carry_out, cpu_time, described, keep, start
from tests.support.processes import child_processes
from tests.support.sweeps import measured_table

COUNT = 60
DRAW = 3
COMMAND = [
    *("sweep", "--aspect", "1,1.5,2,2.5,3", "--jobs", "2", "--threads", "1", "--quiet"),
    *("--set", "grid.spacing=0.0194", "--set", "stages.collapse.max_time_factor=0.5", "--set", "output.snapshots=10"),
]
KILLED, SOON = 0.3, 1.5  # share of the runs, and s within which after their start
PARENT_WITHIN = 6.0  # s
SIZES = (12, 17)  # the largest file that a full disk takes, as powers of two
RERUN = 2.0  # s


def trial(seed: int, folder: Path) -> str | None:
    """Disturb a sweep in one of three ways, and give its command twice more."""
    out, whole = folder / "sweep", keep("sweep", lambda place: complete(place / "sweep")) / "sweep"
    disturb = (kill_runs, kill_parent, fill_disk)[seed % 3]
    if wrong := disturb(random.Random(seed), out):
        return wrong
    before = finished(out)
    complete(out)
    after = finished(out)
    if again := [name for name, times in before.items() if after[name] != times]:
        return f"done again: {again}"
    if digests(out) != digests(whole) or measured_table(out) != measured_table(whole):
        return "other results than without being disturbed"
    took = timed(out)
    if finished(out) != after:
        return "the finished sweep wrote once more"
    return f"the finished sweep took {took:.2f} s" if took > RERUN else None


def kill_runs(draw: random.Random, out: Path) -> str | None:
    """Kill some of the runs; the sweep takes them up again."""
    sweep, due = begin(out), dict[int, float]()
    while sweep.poll() is None:
        now = time.monotonic()
        for run in child_processes(sweep.pid):
            due.setdefault(run, now + (draw.random() * SOON if draw.random() < KILLED else PATIENCE))
            if now > due[run]:
                kill(run)
        time.sleep(0.01)
    return ended(sweep, 0, 1)  # 1: a run was killed whenever it was tried


def kill_parent(draw: random.Random, out: Path) -> str | None:
    """Kill the sweep itself, and some of its runs with it; the others go on alone."""
    sweep = begin(out)
    try:
        sweep.wait(draw.random() * PARENT_WITHIN)
    except subprocess.TimeoutExpired:
        runs = child_processes(sweep.pid)
        sweep.kill()
        for run in runs:
            if draw.random() < KILLED:
                kill(run)
    return ended(sweep, 0, -signal.SIGKILL)


def fill_disk(draw: random.Random, out: Path) -> str | None:
    """Let no file become larger than some size."""
    size = round(2 ** draw.uniform(*SIZES))
    return ended(begin(out, partial(resource.setrlimit, resource.RLIMIT_FSIZE, (size, size))), 0, 5)


def begin(out: Path, before: partial[None] | None = None) -> subprocess.Popen[str]:
    """Start the sweep; `before` is called in its process."""
    return start([*COMMAND, "--out", str(out)], before=before)


def kill(process: int) -> None:
    """Kill a process of ours, if it is still there."""
    with suppress(ProcessLookupError):
        os.kill(process, signal.SIGKILL)


def ended(sweep: subprocess.Popen[str], *allowed: int) -> str | None:
    """What is wrong with how a sweep ended."""
    _, said = sweep.communicate(timeout=PATIENCE)
    if sweep.returncode in allowed and "Traceback" not in said:
        return None
    return f"{described(sweep.returncode)}: {said}"


def complete(out: Path) -> None:
    """The undisturbed command; all points must be done after it."""
    code, said = carry_out([*COMMAND, "--out", str(out)])
    assert code == 0, f"{described(code)}: {said}"
    assert len(finished(out)) == 5


def timed(out: Path) -> float:
    """Seconds that the command takes of a core."""
    started = cpu_time()
    complete(out)
    return cpu_time() - started


def finished(out: Path) -> dict[str, dict[str, int]]:
    """When the files of each point that is done were last changed, ns."""
    done = [place for place in out.glob("a*-*") if read_status(place).name == "done"]
    return {place.name: {str(path): path.stat().st_mtime_ns for path in place.rglob("*.*")} for place in done}


def digests(out: Path) -> dict[str, str]:
    """The last state of each point."""
    return {place.name: Results(place).summary["state_sha256"] for place in sorted(out.glob("a*-*"))}
