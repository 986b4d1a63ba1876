"""On a full, failing or vanished disk a run ends with code 5 and words; once it is mended, the same command goes on."""

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
from tests.soak.writes import CASE, changes, look, undisturbed
from tests.support.cli import invoke, set_options
from tests.support.faulty_disk import Disk
from tests.support.runs import assert_equal_runs

COUNT = 200
DRAW = 8
SIZES = 20
SMALLEST = 8192  # bytes
PAGE = 4096
REFUSALS = (errno.EROFS, errno.EIO, errno.EDQUOT, errno.EACCES)


def trial(seed: int, folder: Path) -> str | None:
    """Run on a disk of one of twenty sizes, or one that fails on the way; then mend the disk and run again."""
    draw, faults = random.Random(seed), list(FAULTS.values())
    return faults[seed % len(faults)](seed // len(faults), draw, folder)


def full(step: int, draw: random.Random, folder: Path) -> str | None:
    """A disk that ends within what the run needs, of one of twenty sizes; a real one where this may be mounted."""
    size = SMALLEST + int((step % SIZES) / (SIZES - 1) * 1.3 * needed())
    if may_mount():
        with mounted(folder, size) as enlarge:
            return tried(folder / "run", "No space left on device; free some space", enlarge, None)
    disk = Disk(folder / "run")
    disk.room = size
    return on(disk, "No space left on device; free some space")


def refusing(step: int, draw: random.Random, folder: Path) -> str | None:
    """A disk that has become read-only, or worn out, in the middle."""
    disk = Disk(folder / "run")
    disk.refuses, disk.refuses_at = REFUSALS[step % len(REFUSALS)], draw.randrange(changes("new"))
    return on(disk, f"cannot be written: {os.strerror(disk.refuses)}; ")


def vanishing(step: int, draw: random.Random, folder: Path) -> str | None:
    """A folder that is deleted or moved away in the middle; of a moved one it goes on in the new place."""
    run, moved, disk = folder / "run", folder / "moved", Disk(folder / "run")
    disk.then_at = draw.randrange(2, changes("new") * 3 // 4)
    disk.then = (lambda: shutil.rmtree(run)) if step % 2 else (lambda: run.rename(moved))  # type: ignore[assignment]
    wrong = on(disk, "was removed or replaced during the run", moved)
    return f"change {disk.then_at}: {wrong}" if wrong else None


FAULTS = {"full": full, "refusing": refusing, "vanishing": vanishing}


def on(disk: Disk, words: str, moved: Path | None = None) -> str | None:
    """As `tried`, on a disk that fails and is then mended."""
    with disk.inserted():
        return tried(disk.folder, words, lambda: mend(disk), moved)


def mend(disk: Disk) -> None:
    """It fails no longer."""
    disk.room, disk.refuses, disk.then_at = None, 0, -1


def tried(run: Path, words: str, mend_it: Callable[[], object], moved: Path | None) -> str | None:
    """Run until the disk fails, look at what there is, mend the disk, and run again."""
    code, said = command(run)
    if code not in (0, 5) or "Traceback" in said:
        return f"exit code {code}: {said}"
    if code == 5 and words not in said:
        return f"it does not say what is wrong: {said}"
    mend_it()
    run = moved if moved is not None and moved.exists() else run
    if wrong := look(run):
        return f"after the fault: {wrong}"
    if code == 5:
        if "repeat the command" not in said and (run / "case.resolved.toml").exists():
            return f"it does not say how to go on: {said}"
        code, said = command(run)
        if code:
            return f"going on ended with exit code {code}: {said}"
    try:
        assert_equal_runs(undisturbed(), run)
    except AssertionError as difference:
        return f"other bits: {difference}"
    return look(run) or (None if Results(run).status == "done" else "it is not done")


def command(run: Path) -> tuple[int, str]:
    """Exit code of the run's command and what it says."""
    source, values = CASE
    command = ["run", source, *set_options(values), "--checkpoint", "0.002s", "--threads", "1", "--out", run]
    done = invoke(*command)
    return done.exit_code, done.output


@cache
def needed() -> int:
    """Bytes of a finished run, and of its two states."""
    return 2 * sum(path.stat().st_size for path in undisturbed().rglob("*"))


@cache
def may_mount() -> bool:
    """Whether this process may mount a file system."""
    with TemporaryDirectory() as place:
        try:
            with mounted(Path(place), PAGE):
                return True
        except (OSError, subprocess.CalledProcessError):
            return False


@contextmanager
def mounted(folder: Path, size: int) -> Iterator[Callable[[], object]]:
    """A small file system at a folder, and how to make it large."""

    def mount(options: str) -> None:
        subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", str(folder)], check=True, capture_output=True)

    mount(f"size={-(-size // PAGE) * PAGE}")
    try:
        yield lambda: mount("remount,size=100m")
    finally:
        subprocess.run(["umount", str(folder)], check=True)
