"""A simulated disk that fails below one folder, by replacing the functions of `os` that change files.

A `Disk` counts the changes that a program makes there. The power may fail at one of them: later changes have no effect,
and what was not flushed to the disk is lost. The disk may also be full, refuse changes, or lose the folder.
"""

from __future__ import annotations

import errno
import os
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any
from unittest.mock import patch

CHANGES = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC


class PowerLost(BaseException):
    """Raised where the power fails."""


class Disk:
    """The disk below `folder`.

    dies_at: number of the change at which the power fails; of a write, the first half is done. forgets_renames: undo
    renames after which the folder was not flushed to the disk. room: bytes that all files may hold. refuses: error of
    every change from number `refuses_at`. then: called before change number `then_at`.
    """

    def __init__(self, folder: Path) -> None:
        self.folder, self.changes, self.is_dead = folder, 0, False
        self.dies_at, self.forgets_renames = -1, False
        self.room: int | None = None
        self.refuses, self.refuses_at = 0, 0
        self.then: Callable[[], None] = lambda: None
        self.then_at = -1
        self._opened: dict[int, Path] = {}
        self._unsynced: set[Path] = set()
        self._renamed: list[tuple[Path, bytes | None]] = []  # and the previous content
        self._real = {
            name: getattr(os, name) for name in ("open", "write", "fsync", "replace", "unlink", "rmdir", "mkdir")
        }

    @contextmanager
    def inserted(self) -> Iterator[None]:
        """Replace the real disk; afterwards the real one holds what a loss of power has left."""
        with ExitStack() as stack:
            stack.callback(self._lose)
            for name in self._real:
                stack.enter_context(patch.object(os, name, getattr(self, f"_{name}")))
            yield

    def used(self) -> int:
        """Size of all files, in bytes."""
        return sum(path.stat().st_size for path in self.folder.rglob("*") if path.is_file())

    def _is_ours(self, path: Any, dir_fd: int | None = None) -> bool:
        return dir_fd is not None or (not isinstance(path, int) and self.folder in (Path(path), *Path(path).parents))

    def _change(self) -> bool:
        """Count a change; return whether the power fails at it."""
        if self.is_dead:
            raise PowerLost
        self.changes += 1
        if self.changes - 1 == self.then_at:
            self.then()
        if self.refuses and self.changes > self.refuses_at:
            raise OSError(self.refuses, os.strerror(self.refuses))
        self.is_dead = self.changes - 1 == self.dies_at
        return self.is_dead

    def _die_if_due(self) -> None:
        if self._change():
            raise PowerLost

    def _open(self, path: Any, flags: int, *more: Any, **named: Any) -> int:
        ours = self._is_ours(path)
        if ours and flags & CHANGES:
            self._die_if_due()
        descriptor: int = self._real["open"](path, flags, *more, **named)
        if ours:
            self._opened[descriptor] = Path(path)
        return descriptor

    def _write(self, descriptor: int, data: bytes) -> int:
        path = self._opened.get(descriptor)
        if path is None:
            return int(self._real["write"](descriptor, data))
        dies = self._change()
        self._unsynced.add(path)
        size = len(data) // 2 if dies else len(data)
        if self.room is not None:
            size = min(size, self.room - self.used())
            if size <= 0:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        written = int(self._real["write"](descriptor, data[:size]))
        if dies:
            raise PowerLost
        return written

    def _fsync(self, descriptor: int) -> None:
        path = self._opened.get(descriptor)
        if path is not None:
            self._die_if_due()
            self._unsynced.discard(path)
            self._renamed = [entry for entry in self._renamed if entry[0].parent != path]
        self._real["fsync"](descriptor)

    def _replace(self, source: Any, target: Any) -> None:
        source, target = Path(source), Path(target)
        if self._is_ours(target):
            self._die_if_due()
            self._renamed.append((target, target.read_bytes() if target.exists() else None))
            if source in self._unsynced:
                self._unsynced = self._unsynced - {source} | {target}
        self._real["replace"](source, target)

    def _unlink(self, path: Any, *, dir_fd: int | None = None) -> None:
        if self._is_ours(path, dir_fd):
            self._die_if_due()
        self._real["unlink"](path, dir_fd=dir_fd)

    def _rmdir(self, path: Any, *, dir_fd: int | None = None) -> None:
        if self._is_ours(path, dir_fd):
            self._die_if_due()
        self._real["rmdir"](path, dir_fd=dir_fd)

    def _mkdir(self, path: Any, *more: Any, **named: Any) -> None:
        if self._is_ours(path):
            self._die_if_due()
        self._real["mkdir"](path, *more, **named)

    def _lose(self) -> None:
        """After a loss of power, discard what was not flushed to the disk."""
        for path in self._unsynced if self.is_dead else ():
            if path.exists():
                path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
        for path, before in reversed(self._renamed if self.is_dead and self.forgets_renames else []):
            if before is None:
                path.unlink(missing_ok=True)
            elif path.parent.exists():
                path.write_bytes(before)
