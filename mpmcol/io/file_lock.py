"""Exclusive lock of an open file between processes; the system releases it when the process ends.

The library filelock opens its file for writing, so that it cannot report whether a folder of another user, or on a
read-only disk, is in use.
"""

from __future__ import annotations

import errno
import sys

CONTENTION = (errno.EACCES, errno.EAGAIN)  # the errors of a lock that another process holds

if sys.platform == "win32":
    import msvcrt

    def _lock(descriptor: int, shared: bool) -> None:
        """Lock the first byte; Windows has no shared lock in its C library."""
        msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)

    def unlock(descriptor: int) -> None:
        """Release the lock of an open file."""
        msvcrt.locking(descriptor, msvcrt.LK_UNLCK, 1)

else:
    import fcntl

    def _lock(descriptor: int, shared: bool) -> None:
        fcntl.flock(descriptor, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)

    def unlock(descriptor: int) -> None:
        """Release the lock of an open file, also for forked children, which have inherited it."""
        fcntl.flock(descriptor, fcntl.LOCK_UN)


def try_lock(descriptor: int, shared: bool = False) -> bool:
    """Lock an open file; False if another process holds the lock.

    shared: only test for an exclusive lock, for which the file may be open for reading only.

    Raises OSError if the file system has no locks.
    """
    try:
        _lock(descriptor, shared)
    except OSError as error:
        if error.errno in CONTENTION:
            return False
        raise
    return True
