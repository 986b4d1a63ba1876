"""Atomic writing of files: after a crash at any moment a file has its old or its new content, complete."""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

from mpmcol.errors import OutputError
from mpmcol.io.names import OWN_FILES, SNAPSHOT_FOLDER

IS_WINDOWS = sys.platform == "win32"
# Windows neither replaces nor deletes a file that another program has open, for example to index it or to scan it.
PATIENCE = 2.0 if IS_WINDOWS else 0.0  # s
NO_ACCESS = "choose a folder that you may write to, or change its permissions" + (
    "; if another program has the file open, close it there, and repeat the command" if IS_WINDOWS else ""
)
BINARY = getattr(os, "O_BINARY", 0)  # Windows changes line ends otherwise
REMEDIES = {
    errno.ENOSPC: "free some space on this disk, or choose another folder",
    errno.EDQUOT: "your quota is used up: free some space, or choose another folder",
    errno.EACCES: NO_ACCESS,
    errno.EPERM: NO_ACCESS,
    errno.EROFS: "this disk is read-only: choose another folder",
    errno.ENOENT: "there is no folder {folder}; create it, or choose another one",
    errno.ENOTDIR: "a part of this path is a file, not a folder: choose another folder",
    errno.EEXIST: "a file of that name is in the way: move it, or choose another folder",
    errno.EISDIR: "a folder of that name is in the way: move it, or choose another name",
}


def atomic_write(path: Path, data: bytes) -> None:
    """Replace the content of the file `path` by `data`: write a temporary file, sync it to the disk, rename it.

    Raises OutputError with the path, the reason and the remedy; the old file is then unchanged.
    """
    temporary = path.with_name(f".{path.name}.{os.getpid()}-{threading.get_ident()}.tmp")
    try:
        _write_synced(temporary, data)
        _patiently(lambda: os.replace(temporary, path))
        _sync_folder(path.parent)
    except OSError as error:
        raise cannot_write(path, error) from error
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)


def is_temporary(path: Path) -> bool:
    """Whether a file has the name of a temporary file of `atomic_write`."""
    return path.name.startswith(".") and path.suffix == ".tmp"


def temporary_files(folder: Path) -> list[Path]:
    """Temporary files of a run in its folder: of the running process, or left by one that was killed."""
    patterns = [*(f".{name}.*.tmp" for name in OWN_FILES), f"{SNAPSHOT_FOLDER}/.*.tmp"]
    return sorted({path for pattern in patterns for path in folder.glob(pattern)})


def read_bytes(path: Path) -> bytes:
    """The content of a file. Raises OutputError with the path and the reason."""
    try:
        return path.read_bytes()
    except OSError as error:
        raise OutputError(f"{path}: cannot be read: {error.strerror or error}") from error


def make_folder(path: Path, parents: bool = True) -> Path:
    """Create the folder `path`, by default with its parents, if it is missing; of a link, its target.

    Raises OutputError.
    """
    try:
        (path.resolve() if path.is_symlink() else path).mkdir(parents=parents, exist_ok=True)
    except OSError as error:
        raise cannot_write(path, error) from error
    return path


def require_folder_path(path: Path) -> None:
    """Raise OutputError if `path` is no folder and cannot become one; writes nothing."""
    try:
        present = _nearest_existing(path)
    except OSError as error:  # for example a name that is too long
        raise cannot_write(path, error) from error
    if not present.is_dir():
        number = errno.EEXIST if present == path else errno.ENOTDIR
        raise cannot_write(path, OSError(number, os.strerror(number)))
    if not os.access(present, os.W_OK):
        raise cannot_write(path, OSError(errno.EACCES, os.strerror(errno.EACCES)))


def _nearest_existing(path: Path) -> Path:
    """The path, or the nearest folder above it that exists. Raises OSError, for example for a name that is too long."""
    return next(one for one in (path, *path.absolute().parents) if one.exists())


def free_bytes(path: Path) -> int:
    """Free space on the disk of a folder that may not exist yet."""
    return shutil.disk_usage(_nearest_existing(path)).free


def remove(path: Path) -> None:
    """Delete a file or a folder with its content, if it exists. Raises OutputError."""
    try:
        if path.is_dir():
            _patiently(lambda: shutil.rmtree(path))
        else:
            _patiently(lambda: path.unlink(missing_ok=True))
    except OSError as error:
        raise cannot_write(path, error) from error


def cannot_write(path: Path, error: OSError) -> OutputError:
    """The error to raise for a failed write: path, reason and remedy."""
    reason = error.strerror or str(error)
    remedy = REMEDIES.get(error.errno or 0, "check the disk and the folder, then run again")
    return OutputError(f"{path}: cannot be written: {reason}; {remedy.format(folder=path.parent)}")


def _patiently(action: Callable[[], None]) -> None:
    """Repeat an action for PATIENCE while it is refused; raises PermissionError after that."""
    deadline = time.monotonic() + PATIENCE
    while True:
        try:
            return action()
        except PermissionError:
            if time.monotonic() >= deadline:
                raise
        time.sleep(0.05)


def _write_synced(path: Path, data: bytes) -> None:
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC | BINARY, 0o666)
    try:
        rest = memoryview(data)
        while rest:
            rest = rest[os.write(descriptor, rest) :]
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _sync_folder(folder: Path) -> None:
    """Make the rename durable; some network file systems cannot sync a folder and return EINVAL.

    Windows cannot open a folder; its file system records renames in a journal.
    """
    if IS_WINDOWS:
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    except OSError as error:
        if error.errno != errno.EINVAL:
            raise
    finally:
        os.close(descriptor)
