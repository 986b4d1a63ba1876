"""At whatever moment the power fails, the files on the disk are readable, and the same command ends with equal bits."""

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
from tests.soak.commands import cached_folder
from tests.support.faulty_disk import Disk, PowerLost
from tests.support.runs import TINY, assert_equal_runs

COUNT = 2400
SMALL_COUNT = 12
CASE = ("coarse-channel", TINY)


def trial(seed: int, folder: Path) -> str | None:
    """Let the power fail at one change of the disk, check the files, and give the command again."""
    draw, start = random.Random(seed), list(STARTS)[seed % len(STARTS)]
    disk, run = Disk(folder / "run"), folder / "run"
    disk.power_fails_at, disk.undoes_renames = (seed // len(STARTS)) % changes(start), draw.random() < 0.5
    fresh = STARTS[start](run)
    try:
        with disk.inserted():
            run_case(run, fresh)
    except PowerLost:
        if damage := find_damage(run):
            return f"{start}, change {disk.power_fails_at}: {damage}"
    if fresh or not (run / "result.json").exists() or Results(run).status != "done":
        run_case(run, fresh)
    try:
        assert_equal_runs(reference_run(), run)
    except AssertionError as difference:
        return f"{start}, change {disk.power_fails_at}: {difference}"
    return find_damage(run)


def find_damage(run: Path) -> str | None:
    """Describe what cannot be read in the folder of a run."""
    if not (run / "case.resolved.toml").exists():
        return None  # nothing was begun, or everything was removed
    found = [str(finding) for report in verify(run) for finding in report.findings if finding.is_damage]
    results = Results(run)
    try:
        for k in range(len(results.snapshots)):
            results.measure(k)
    except MpmcolError as error:
        found.append(str(error))
    return "; ".join(found) or None


def run_case(run: Path, fresh: bool = False, stop_at: float = inf) -> None:
    """Run the case of all trials in this process; stop at some share of the collapse."""

    def stop(stage: str, share: float) -> None:
        if stage == "collapse" and share > stop_at:
            signal.raise_signal(signal.SIGUSR1)

    mpmcol.run(mpmcol.load_case(*CASE), run, threads=1, fresh=fresh, checkpoint_seconds=0.002, progress=stop)


def reference_run() -> Path:
    """The folder of the undisturbed run."""
    return cached_folder("power_loss/reference", lambda folder: run_case(folder / "run")) / "run"


def _new(run: Path) -> bool:
    return False


def _stopped(run: Path) -> bool:
    """The folder of a run that was stopped in the collapse."""

    def fill(folder: Path) -> None:
        with suppress(Interrupted):
            run_case(folder / "run", stop_at=0.3)

    shutil.copytree(cached_folder("power_loss/stopped", fill) / "run", run)
    return False


def _finished(run: Path) -> bool:
    """The folder of a finished run that is to be replaced."""
    shutil.copytree(reference_run(), run)
    return True


# what is in the folder at the start -> function that makes it, and returns whether the run needs --fresh
STARTS = {"new": _new, "stopped": _stopped, "finished": _finished}


@cache
def changes(start: str) -> int:
    """Number of changes that a run makes on the disk."""
    with TemporaryDirectory() as temporary:
        run = Path(temporary) / "run"
        fresh, disk = STARTS[start](run), Disk(run)
        with disk.inserted():
            run_case(run, fresh)
        return disk.changes
