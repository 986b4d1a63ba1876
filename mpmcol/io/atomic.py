"""Files that are either whole or absent: every file of a results folder is written through here."""

from __future__ import annotations

import contextlib
import errno
import fcntl
import os
import shutil
import time
from collections.abc import Iterator
from pathlib import Path

from mpmcol.errors import OutputError

# the folder of a run
LOCK = ".lock"
CASE_FILE, RESULT_FILE, HISTORY_FILE = "case.resolved.toml", "result.json", "history.csv"
INDEX_FILES = ("run.vtkhdf", "run.vtkhdf.series")
DIGEST_FILE = "SHA256SUMS"  # of all the others, written just before the result
CHECKPOINT_FILES = ("checkpoint-0.npz", "checkpoint-1.npz")  # written in turn
# what may lie in it before the run: the case that it is to run, and what it says while it does
GIVEN_CASE_FILE, LOG_FILE = "case.toml", "run.log"

PATIENCE = 0.5  # s: who only looks whether a folder is locked holds the lock for a moment

REMEDIES = {
    errno.ENOSPC: "free some space on this disk, or choose another folder",
    errno.EDQUOT: "your quota is used up: free some space, or choose another folder",
    errno.EACCES: "choose a folder that you may write to, or mend its permissions",
    errno.EPERM: "choose a folder that you may write to, or mend its permissions",
    errno.EROFS: "this disk is read-only: choose another folder",
    errno.ENOENT: "the folder is gone: create it again, or choose another folder",
    errno.ENOTDIR: "a part of this path is a file, not a folder: choose another folder",
    errno.EEXIST: "a file of that name is in the way: move it, or choose another folder",
    errno.EISDIR: "a folder of that name is in the way: move it, or choose another name",
}


def atomic_write(path: Path, data: bytes) -> None:
    """Replace the file `path` by `data` so that a crash at any moment leaves the old or the new content, whole.

    Raises OutputError with the path, the reason and the remedy; the old file is then untouched.
    """
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        _write_synced(temporary, data)
        os.replace(temporary, path)
        _sync_folder(path.parent)
    except OSError as error:
        raise _cannot_write(path, error) from error
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)


def leftovers(folder: Path) -> list[Path]:
    """What a run was writing in its folder when it was killed; others may be writing there now."""
    own = (CASE_FILE, RESULT_FILE, DIGEST_FILE, HISTORY_FILE, *INDEX_FILES, *CHECKPOINT_FILES)
    patterns = [*(f".{name}.*.tmp" for name in own), "snapshots/.*.tmp"]
    return sorted({path for pattern in patterns for path in folder.glob(pattern)})


def make_folder(path: Path, parents: bool = True) -> Path:
    """Create the folder `path`, and its parents unless told not to, where they are missing; raises OutputError."""
    try:
        path.mkdir(parents=parents, exist_ok=True)
    except OSError as error:
        raise _cannot_write(path, error) from error
    return path


class Lock:
    """A folder that this process has to itself."""

    def __init__(self, path: Path, descriptor: int) -> None:
        self._path, self._descriptor = path, descriptor

    def check(self) -> None:
        """Raise OutputError if the folder is no longer the one that was locked: another process may write there now."""
        try:
            same = os.path.samestat(os.fstat(self._descriptor), os.stat(self._path))
        except OSError:
            same = False
        if not same:
            raise OutputError(
                f"{self._path.parent}: the folder, or {LOCK} in it, was removed or replaced while the run was going; "
                "if it was moved, the same command with --out and the new place goes on there, otherwise it begins anew"
            )


@contextlib.contextmanager
def locked(folder: Path) -> Iterator[Lock]:
    """Keep every other process that asks for the same out of `folder`, and clear away what one that was killed left.

    Raises OutputError if one is in there, or nothing can be written.
    """
    path = make_folder(folder) / LOCK
    try:
        descriptor = os.open(path, os.O_WRONLY | os.O_CREAT, 0o666)
    except OSError as error:
        raise _cannot_write(path, error) from error
    try:
        if not _taken(descriptor):
            raise OutputError(f"{folder}: another run is writing here; wait for it, or choose another folder")
        for left in leftovers(folder):  # a checkpoint may be gigabytes long
            remove(left)
        yield Lock(path, descriptor)
    finally:
        os.close(descriptor)


def is_locked(folder: Path) -> bool:
    """Whether a process is in `folder`, see `locked`."""
    try:
        descriptor = os.open(folder / LOCK, os.O_RDONLY)
    except OSError:
        return False
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    finally:
        os.close(descriptor)
    return False


def _taken(descriptor: int) -> bool:
    """Take the lock, for as long as the file is open; False if another process keeps it."""
    deadline = time.monotonic() + PATIENCE
    while True:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            return True
        except BlockingIOError:
            if time.monotonic() > deadline:
                return False
        time.sleep(PATIENCE / 10.0)


def remove(path: Path) -> None:
    """Delete a file or a whole folder if it is there; raises OutputError."""
    try:
        if path.is_dir():
            shutil.rmtree(path)
        else:
            path.unlink(missing_ok=True)
    except OSError as error:
        raise _cannot_write(path, error) from error


def _write_synced(path: Path, data: bytes) -> None:
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o666)
    try:
        rest = memoryview(data)
        while rest:
            rest = rest[os.write(descriptor, rest) :]
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _sync_folder(folder: Path) -> None:
    """Make the rename itself last; some network file systems cannot sync a folder and say EINVAL."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    except OSError as error:
        if error.errno != errno.EINVAL:
            raise
    finally:
        os.close(descriptor)


def _cannot_write(path: Path, error: OSError) -> OutputError:
    reason = error.strerror or str(error)
    remedy = REMEDIES.get(error.errno or 0, "check the disk and the folder, then run again")
    return OutputError(f"{path}: cannot be written: {reason}; {remedy}")
