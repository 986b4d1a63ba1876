"""On a full, failing or vanished disk a run ends with code 5 and a message; after repair the same command resumes."""

from __future__ import annotations

import errno
import os
import random
import shutil
import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from mpmcol.io.results import Results
from tests.soak.trials.power_loss import CASE, changes, find_damage, reference_run
from tests.support.cli import invoke, set_options
from tests.support.faulty_disk import Disk
from tests.support.runs import assert_equal_runs

COUNT = 200
SMALL_COUNT = 8
SIZES = 20
SMALLEST = 8192  # bytes
PAGE = 4096
ERRORS = (errno.EROFS, errno.EIO, errno.EDQUOT, errno.EACCES)


def trial(seed: int, folder: Path) -> str | None:
    """Run on a disk that is too small, or that fails during the run; then repair the disk and run again."""
    draw, faults = random.Random(seed), list(FAULTS.values())
    return faults[seed % len(faults)](seed // len(faults), draw, folder)


def full(step: int, draw: random.Random, folder: Path) -> str | None:
    """A disk too small for the run, of one of twenty sizes; a real file system where it may be mounted."""
    size = SMALLEST + int((step % SIZES) / (SIZES - 1) * 1.3 * bytes_needed())
    if may_mount():
        with mounted(folder, size) as enlarge:
            return run_repair_rerun(folder / "run", "No space left on device; free some space", enlarge, None)
    disk = Disk(folder / "run")
    disk.capacity = size
    return run_on(disk, "No space left on device; free some space")


def refusing(step: int, draw: random.Random, folder: Path) -> str | None:
    """A disk that becomes read-only or fails during the run."""
    disk = Disk(folder / "run")
    disk.error, disk.error_from = ERRORS[step % len(ERRORS)], draw.randrange(changes("new"))
    return run_on(disk, f"cannot be written: {os.strerror(disk.error)}; ")


def vanishing(step: int, draw: random.Random, folder: Path) -> str | None:
    """A folder that is deleted or moved during the run; a moved run resumes in its new folder."""
    run, moved, disk = folder / "run", folder / "moved", Disk(folder / "run")
    disk.callback_at = draw.randrange(2, changes("new") * 3 // 4)
    disk.callback = (lambda: shutil.rmtree(run)) if step % 2 else (lambda: run.rename(moved))  # type: ignore[assignment]
    failure = run_on(disk, "was removed or replaced during the run", moved)
    return f"change {disk.callback_at}: {failure}" if failure else None


FAULTS = {"full": full, "refusing": refusing, "vanishing": vanishing}


def run_on(disk: Disk, message: str, moved: Path | None = None) -> str | None:
    """As `run_repair_rerun`, on a simulated disk."""
    with disk.inserted():
        return run_repair_rerun(disk.folder, message, lambda: repair(disk), moved)


def repair(disk: Disk) -> None:
    """Let the disk work again."""
    disk.capacity, disk.error, disk.callback_at = None, 0, -1


def run_repair_rerun(run: Path, message: str, repair_disk: Callable[[], object], moved: Path | None) -> str | None:
    """Run until the disk fails, check message and files, repair the disk, and run again; return the failure, if any."""
    code, output = command(run)
    if code not in (0, 5) or "Traceback" in output:
        return f"exit code {code}: {output}"
    if code == 5 and message not in output:
        return f"the message does not state the cause: {output}"
    repair_disk()
    run = moved if moved is not None and moved.exists() else run
    if damage := find_damage(run):
        return f"after the fault: {damage}"
    if code == 5:
        if "repeat the command" not in output and (run / "case.resolved.toml").exists():
            return f"the message does not state how to resume: {output}"
        code, output = command(run)
        if code:
            return f"the resumed run ended with exit code {code}: {output}"
    try:
        assert_equal_runs(reference_run(), run)
    except AssertionError as difference:
        return f"other bits: {difference}"
    return find_damage(run) or (None if Results(run).status == "done" else "the run is not done")


def command(run: Path) -> tuple[int, str]:
    """Exit code and output of the command."""
    source, values = CASE
    done = invoke("run", source, *set_options(values), "--checkpoint", "0.002s", "--threads", "1", "--out", run)
    return done.exit_code, done.output


@cache
def bytes_needed() -> int:
    """Size of a finished run and of its two checkpoints."""
    return 2 * sum(path.stat().st_size for path in reference_run().rglob("*"))


@cache
def may_mount() -> bool:
    """Whether this process may mount a file system."""
    with TemporaryDirectory() as temporary:
        try:
            with mounted(Path(temporary), PAGE):
                return True
        except (OSError, subprocess.CalledProcessError):
            return False


@contextmanager
def mounted(folder: Path, size: int) -> Iterator[Callable[[], object]]:
    """Mount a small file system on a folder; yields the function that enlarges it."""

    def mount(options: str) -> None:
        subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", str(folder)], check=True, capture_output=True)

    mount(f"size={-(-size // PAGE) * PAGE}")
    try:
        yield lambda: mount("remount,size=100m")
    finally:
        subprocess.run(["umount", str(folder)], check=True)
