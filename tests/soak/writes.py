"""Whatever moment the power fails at, what is on the disk is readable, and the same command ends with equal bits."""

from __future__ import annotations

import random
import shutil
import signal
from contextlib import suppress
from functools import cache
from math import inf
from pathlib import Path
from tempfile import TemporaryDirectory

import mpmcol
from mpmcol.errors import Interrupted, MpmcolError
from mpmcol.integrity import verify
from mpmcol.io.results import Results
from tests.soak._runs import keep
from tests.support.faulty_disk import Disk, PowerLost
from tests.support.runs import TINY, assert_equal_runs

COUNT = 2400
DRAW = 12
CASE = ("quickstart", TINY)


def trial(seed: int, folder: Path) -> str | None:
    """Let the power fail at one change of the disk, look at what is there, and give the command again."""
    draw, begin = random.Random(seed), list(BEGINNINGS)[seed % len(BEGINNINGS)]
    disk, run = Disk(folder / "run"), folder / "run"
    disk.dies_at, disk.forgets_renames = (seed // len(BEGINNINGS)) % changes(begin), draw.random() < 0.5
    fresh = BEGINNINGS[begin](run)
    try:
        with disk.inserted():
            go(run, fresh)
    except PowerLost:
        if wrong := look(run):
            return f"{begin}, change {disk.dies_at}: {wrong}"
    finished = run / "result.json"
    if fresh or not finished.exists() or Results(run).status != "done":
        go(run, fresh)
    try:
        assert_equal_runs(undisturbed(), run)
    except AssertionError as difference:
        return f"{begin}, change {disk.dies_at}: {difference}"
    return look(run)


def look(run: Path) -> str | None:
    """What cannot be read in a folder."""
    if not (run / "case.resolved.toml").exists():
        return None  # nothing was begun, or all that was is removed
    told = [str(finding) for report in verify(run) for finding in report.findings if finding.is_damage]
    results = Results(run)
    try:
        for k in range(len(results.snapshots)):
            results.measure(k)
    except MpmcolError as error:
        told.append(str(error))
    return "; ".join(told) or None


def go(run: Path, fresh: bool = False, stop_at: float = inf) -> None:
    """The run of all trials, in this process; at some share of the collapse it is asked to stop."""

    def ask(stage: str, share: float) -> None:
        if stage == "collapse" and share > stop_at:
            signal.raise_signal(signal.SIGUSR1)

    mpmcol.run(mpmcol.load_case(*CASE), run, threads=1, fresh=fresh, checkpoint_seconds=0.002, progress=ask)


def undisturbed() -> Path:
    """The run that nothing happened to."""
    return keep("writes/undisturbed", lambda folder: go(folder / "run")) / "run"


def _new(run: Path) -> bool:
    return False


def _stopped(run: Path) -> bool:
    """The folder of a run that was stopped on its way."""

    def make(folder: Path) -> None:
        with suppress(Interrupted):
            go(folder / "run", stop_at=0.3)

    shutil.copytree(keep("writes/stopped", make) / "run", run)
    return False


def _finished(run: Path) -> bool:
    """The folder of a finished run that is to be replaced."""
    shutil.copytree(undisturbed(), run)
    return True


BEGINNINGS = {"new": _new, "stopped": _stopped, "finished": _finished}


@cache
def changes(begin: str) -> int:
    """How often a run changes the disk."""
    with TemporaryDirectory() as place:
        run = Path(place) / "run"
        fresh, disk = BEGINNINGS[begin](run), Disk(run)
        with disk.inserted():
            go(run, fresh)
        return disk.changes
