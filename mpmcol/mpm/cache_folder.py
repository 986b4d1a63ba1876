"""The folder of compiled kernels: the user's cache, or a private folder among the temporary files."""

from __future__ import annotations

import atexit
import contextlib
import os
import shutil
import stat
import sys
import tempfile
from pathlib import Path

CHOOSE = "set MPMCOL_CACHE_DIR to a folder that can be written"


def cache_root() -> tuple[Path, str]:
    """The folder for compiled kernels, and a note for the user unless it is in the user's cache."""
    chosen = Path(os.environ.get("MPMCOL_CACHE_DIR") or os.environ.get("XDG_CACHE_HOME") or "~/.cache")
    with contextlib.suppress(OSError, RuntimeError):  # RuntimeError: there is no home
        folder = chosen.expanduser() / "mpmcol"
        folder.mkdir(parents=True, exist_ok=True)
        _try_to_write(folder)
        return folder, ""
    return _temporary_root(f"note: {chosen / 'mpmcol'} cannot be written")


def _temporary_root(reason: str) -> tuple[Path, str]:
    """One folder for all commands of the user, or, if that is not private, one for this process."""
    folder = Path(tempfile.gettempdir()) / f"mpmcol-{_user_id()}"
    with contextlib.suppress(OSError):
        folder.mkdir(mode=0o700, exist_ok=True)
        if _is_private(folder):
            _try_to_write(folder)
            return folder, f"{reason}; compiled kernels are kept in {folder}: {CHOOSE}"
    own = Path(tempfile.mkdtemp(prefix="mpmcol-"))
    atexit.register(shutil.rmtree, own, ignore_errors=True)
    return own, (
        f"{reason}, and {folder} is not a folder that only you can write; every command compiles its kernels again: "
        f"{CHOOSE}"
    )


def _is_private(folder: Path) -> bool:
    """Whether a folder, not a link to one, belongs to the user and is closed to others: its files are executed."""
    status = folder.lstat()
    is_ours = stat.S_ISDIR(status.st_mode) and status.st_uid == _user_id()
    return is_ours and (sys.platform == "win32" or not stat.S_IMODE(status.st_mode) & 0o077)


def _user_id() -> int:
    """Number of the user; 0, as the owner of all files, in Windows, where each user has their own temporary files."""
    if sys.platform == "win32":
        return 0
    return os.getuid()


def _try_to_write(folder: Path) -> None:
    """Raise OSError if a folder cannot be written."""
    with tempfile.TemporaryFile(dir=folder) as trial:
        trial.write(b"trial")
