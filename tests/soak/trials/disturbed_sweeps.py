"""A sweep that is killed with or without its runs, or whose disk is full, is completed by the same command.

No finished run is repeated, all end with equal bits, and once more the command takes less than two seconds.
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
from tests.soak.commands import PATIENCE, cached_folder, child_cpu_time, complete, describe_exit, start
from tests.support.cli import set_options
from tests.support.processes import child_processes
from tests.support.sweeps import measured_table

COUNT = 60
SMALL_COUNT = 3
ARGUMENTS = [
    *("sweep", "--aspect", "1,1.5,2,2.5,3", "--jobs", "2", "--threads", "1", "--quiet"),
    *set_options(("grid.spacing=0.0194", "stages.collapse.max_time_factor=0.5", "output.snapshots=10")),
]
KILLED_SHARE, KILLED_WITHIN = 0.3, 1.5  # share of the runs, and s after their start
SWEEP_KILLED_WITHIN = 6.0  # s
SIZES = (12, 17)  # the largest file on a full disk, as powers of two
REPEAT_LIMIT = 2.0  # s


def trial(seed: int, folder: Path) -> str | None:
    """Disturb a sweep in one of three ways, and give its command twice more."""
    out = folder / "sweep"
    reference = cached_folder("sweep", lambda parent: complete_sweep(parent / "sweep")) / "sweep"
    disturb = (kill_runs, kill_sweep, fill_disk)[seed % 3]
    if failure := disturb(random.Random(seed), out):
        return failure
    before = finished_files(out)
    complete_sweep(out)
    after = finished_files(out)
    if repeated := [name for name, times in before.items() if after[name] != times]:
        return f"finished runs were repeated: {repeated}"
    if state_digests(out) != state_digests(reference) or measured_table(out) != measured_table(reference):
        return "the results differ from those of the undisturbed sweep"
    seconds = repeat_seconds(out)
    if finished_files(out) != after:
        return "the finished sweep changed files"
    return f"the finished sweep took {seconds:.2f} s" if seconds > REPEAT_LIMIT else None


def kill_runs(draw: random.Random, out: Path) -> str | None:
    """Kill some of the runs, which the sweep then resumes."""
    sweep, due = begin(out), dict[int, float]()
    while sweep.poll() is None:
        now = time.monotonic()
        for run in child_processes(sweep.pid):
            due.setdefault(run, now + (draw.random() * KILLED_WITHIN if draw.random() < KILLED_SHARE else PATIENCE))
            if now > due[run]:
                kill(run)
        time.sleep(0.01)
    return wrong_exit(sweep, 0, 1)  # 1: one run was killed in each of its attempts


def kill_sweep(draw: random.Random, out: Path) -> str | None:
    """Kill the sweep itself, and some of its runs with it; the others continue."""
    sweep = begin(out)
    try:
        sweep.wait(draw.random() * SWEEP_KILLED_WITHIN)
    except subprocess.TimeoutExpired:
        runs = child_processes(sweep.pid)
        sweep.kill()
        for run in runs:
            if draw.random() < KILLED_SHARE:
                kill(run)
    return wrong_exit(sweep, 0, -signal.SIGKILL)


def fill_disk(draw: random.Random, out: Path) -> str | None:
    """Limit the size of files."""
    size = round(2 ** draw.uniform(*SIZES))
    return wrong_exit(begin(out, partial(resource.setrlimit, resource.RLIMIT_FSIZE, (size, size))), 0, 5)


def begin(out: Path, before: partial[None] | None = None) -> subprocess.Popen[str]:
    """Start the sweep; `before` is called in its process."""
    return start([*ARGUMENTS, "--out", str(out)], before=before)


def kill(process: int) -> None:
    """Kill a process, if it still exists."""
    with suppress(ProcessLookupError):
        os.kill(process, signal.SIGKILL)


def wrong_exit(sweep: subprocess.Popen[str], *allowed: int) -> str | None:
    """Describe how a sweep ended, if not with one of these exit codes."""
    _, messages = sweep.communicate(timeout=PATIENCE)
    if sweep.returncode in allowed and "Traceback" not in messages:
        return None
    return f"{describe_exit(sweep.returncode)}: {messages}"


def complete_sweep(out: Path) -> None:
    """Give the command without disturbing it; all runs must be done afterwards."""
    code, messages = complete([*ARGUMENTS, "--out", str(out)])
    assert code == 0, f"{describe_exit(code)}: {messages}"
    assert len(finished_files(out)) == 5


def repeat_seconds(out: Path) -> float:
    """CPU time of the command once more, s."""
    started = child_cpu_time()
    complete_sweep(out)
    return child_cpu_time() - started


def finished_files(out: Path) -> dict[str, dict[str, int]]:
    """Time of the last change of each file of each finished run, ns."""
    done = [run for run in out.glob("a*-*") if read_status(run).name == "done"]
    return {run.name: {str(path): path.stat().st_mtime_ns for path in run.rglob("*.*")} for run in done}


def state_digests(out: Path) -> dict[str, str]:
    """Digest of the final state of each run."""
    return {run.name: Results(run).summary["state_sha256"] for run in sorted(out.glob("a*-*"))}
