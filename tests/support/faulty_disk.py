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

    power_fails_at: number of the change at which the power fails; of a write, the first half is done. undoes_renames:
    undo renames after which the folder was not flushed to the disk. capacity: bytes that all files may hold. error: of
    every change from number `error_from` on. callback: called before change number `callback_at`.
    """

    def __init__(self, folder: Path) -> None:
        self.folder, self.changes, self.has_lost_power = folder, 0, False
        self.power_fails_at, self.undoes_renames = -1, False
        self.capacity: int | None = None
        self.error, self.error_from = 0, 0
        self.callback: Callable[[], None] = lambda: None
        self.callback_at = -1
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
            stack.callback(self._discard_unflushed)
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
        if self.has_lost_power:
            raise PowerLost
        self.changes += 1
        if self.changes - 1 == self.callback_at:
            self.callback()
        if self.error and self.changes > self.error_from:
            raise OSError(self.error, os.strerror(self.error))
        self.has_lost_power = self.changes - 1 == self.power_fails_at
        return self.has_lost_power

    def _change_or_lose_power(self) -> None:
        if self._change():
            raise PowerLost

    def _open(self, path: Any, flags: int, *more: Any, **named: Any) -> int:
        ours = self._is_ours(path)
        if ours and flags & CHANGES:
            self._change_or_lose_power()
        descriptor: int = self._real["open"](path, flags, *more, **named)
        if ours:
            self._opened[descriptor] = Path(path)
        return descriptor

    def _write(self, descriptor: int, data: bytes) -> int:
        path = self._opened.get(descriptor)
        if path is None:
            return int(self._real["write"](descriptor, data))
        fails = self._change()
        self._unsynced.add(path)
        size = len(data) // 2 if fails else len(data)
        if self.capacity is not None:
            size = min(size, self.capacity - self.used())
            if size <= 0:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        written = int(self._real["write"](descriptor, data[:size]))
        if fails:
            raise PowerLost
        return written

    def _fsync(self, descriptor: int) -> None:
        path = self._opened.get(descriptor)
        if path is not None:
            self._change_or_lose_power()
            self._unsynced.discard(path)
            self._renamed = [entry for entry in self._renamed if entry[0].parent != path]
        self._real["fsync"](descriptor)

    def _replace(self, source: Any, target: Any) -> None:
        source, target = Path(source), Path(target)
        if self._is_ours(target):
            self._change_or_lose_power()
            self._renamed.append((target, target.read_bytes() if target.exists() else None))
            if source in self._unsynced:
                self._unsynced = self._unsynced - {source} | {target}
        self._real["replace"](source, target)

    def _unlink(self, path: Any, *, dir_fd: int | None = None) -> None:
        if self._is_ours(path, dir_fd):
            self._change_or_lose_power()
        self._real["unlink"](path, dir_fd=dir_fd)

    def _rmdir(self, path: Any, *, dir_fd: int | None = None) -> None:
        if self._is_ours(path, dir_fd):
            self._change_or_lose_power()
        self._real["rmdir"](path, dir_fd=dir_fd)

    def _mkdir(self, path: Any, *more: Any, **named: Any) -> None:
        if self._is_ours(path):
            self._change_or_lose_power()
        self._real["mkdir"](path, *more, **named)

    def _discard_unflushed(self) -> None:
        """After a loss of power, discard what was not flushed to the disk."""
        for path in self._unsynced if self.has_lost_power else ():
            if path.exists():
                path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
        for path, before in reversed(self._renamed if self.has_lost_power and self.undoes_renames else []):
            if before is None:
                path.unlink(missing_ok=True)
            elif path.parent.exists():
                path.write_bytes(before)
