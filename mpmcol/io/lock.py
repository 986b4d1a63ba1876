"""Exclusive use of a results folder by one process, by the lock of a file in it."""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Iterator
from pathlib import Path

import portalocker
from portalocker import AlreadyLocked, LockException, LockFlags

from mpmcol.errors import OutputError
from mpmcol.io.atomic import cannot_write, make_folder, remove, temporary_files
from mpmcol.io.names import LOCK_FILE

PATIENCE = 0.5  # s to wait for the lock: `is_locked` in another process holds it for a moment


class Lock:
    """The lock of a folder that this process holds."""

    def __init__(self, path: Path, descriptor: int) -> None:
        self._path, self._descriptor = path, descriptor

    def check(self) -> None:
        """Raise OutputError if the folder is no longer the locked one; another process may then write to its path."""
        try:
            is_same = os.path.samestat(os.fstat(self._descriptor), os.stat(self._path))
        except OSError:
            is_same = False
        if not is_same:
            raise OutputError(
                f"{self._path.parent}: the folder, or {LOCK_FILE} in it, was removed or replaced during the run; if it "
                "was moved, repeat the command with --out NEW_FOLDER to resume; otherwise the run restarts from scratch"
            )


@contextlib.contextmanager
def locked(folder: Path) -> Iterator[Lock]:
    """Hold the lock of `folder`, which is created if missing, and remove temporary files of a process that was killed.

    Raises OutputError if another process, or another thread, holds the lock, if the folder is not writable, or if its
    file system has no locks.
    """
    path = make_folder(folder) / LOCK_FILE
    try:
        descriptor = os.open(path, os.O_WRONLY | os.O_CREAT, 0o666)
    except OSError as error:
        raise cannot_write(path, error) from error
    try:
        _acquire(descriptor, folder)
        process = os.getpid()
        try:
            for temporary in temporary_files(folder):  # that of a checkpoint may be gigabytes long
                remove(temporary)
            yield Lock(path, descriptor)
        finally:
            if os.getpid() == process:  # not in a child that was forked meanwhile
                with contextlib.suppress(LockException, OSError):
                    portalocker.unlock(descriptor)  # also for forked children, which have inherited it
    finally:
        os.close(descriptor)


def is_locked(folder: Path) -> bool:
    """Whether a process holds the lock of `folder`."""
    try:
        descriptor = os.open(folder / LOCK_FILE, os.O_RDONLY)
    except OSError:
        return False
    try:
        portalocker.lock(descriptor, LockFlags.SHARED | LockFlags.NON_BLOCKING)  # a file open for reading has no other
    except AlreadyLocked:
        return True
    except LockException:  # this file system has no locks: no run can have started
        return False
    finally:
        os.close(descriptor)
    return False


def _acquire(descriptor: int, folder: Path) -> None:
    """Acquire the lock; raise OutputError if another process holds it for longer than PATIENCE."""
    deadline = time.monotonic() + PATIENCE
    while True:
        try:
            portalocker.lock(descriptor, LockFlags.EXCLUSIVE | LockFlags.NON_BLOCKING)
        except AlreadyLocked:
            if time.monotonic() > deadline:
                raise OutputError(
                    f"{folder}: another run is writing here; wait until it ends, or choose another folder"
                ) from None
            time.sleep(PATIENCE / 10.0)
        except LockException as error:
            raise OutputError(
                f"{folder}: this file system has no file locks ({error.strerror}), which keep two runs apart; choose a "
                "folder on another disk"
            ) from error
        else:
            return
