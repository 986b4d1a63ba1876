"""The only place that decides how code is compiled: decorators, threads, and where compiled code is kept.

Numba's disk cache does not see edits of helpers in other files, so the cache folder carries a hash of every
file that holds compiled code; it is chosen here, before any kernel is declared.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import platform
import shutil
import tempfile
import time
from collections.abc import Callable
from importlib import metadata
from pathlib import Path
from typing import Any, TypeVar

os.environ.setdefault("NUMBA_THREADING_LAYER_PRIORITY", "omp tbb workqueue")
# Threads that wait for one another soon give up their core: by default they spin for milliseconds, and where another
# program wants a core a step then takes a hundred times longer.
os.environ.setdefault("GOMP_SPINCOUNT", "1000")

import numba
from numba import prange as prange
from numba.core.caching import FunctionCache
from numba.extending import register_jitable

F = TypeVar("F", bound=Callable[..., Any])

COMPILED_SOURCES = ("mpm", "bench")  # folders that hold compiled code
_STALE_AFTER_S = 7 * 24 * 3600.0
_FLAGS: dict[str, Any] = {"error_model": "numpy", "nogil": True}


def source_digest() -> str:
    """Hash of everything compiled code depends on: our sources, Numba, its LLVM binding, NumPy, Python."""
    digest = hashlib.sha256()
    versions = [metadata.version(package) for package in ("numba", "llvmlite", "numpy")] + [platform.python_version()]
    digest.update(repr(versions).encode())
    package = Path(__file__).parents[1]
    for name in COMPILED_SOURCES:
        for path in sorted((package / name).rglob("*.py")):
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def _cache_root() -> Path:
    """The user's cache folder, or a private temporary one where that is missing, read-only or full."""
    chosen = Path(os.environ.get("MPMCOL_CACHE_DIR") or os.environ.get("XDG_CACHE_HOME") or "~/.cache")
    with contextlib.suppress(OSError, RuntimeError):
        folder = chosen.expanduser() / "mpmcol"
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder) as trial:
            trial.write(b"trial")
        return folder
    return Path(tempfile.mkdtemp(prefix="mpmcol-"))


def _remove_stale(root: Path, keep: Path) -> None:
    """Delete cache folders of other versions that nobody used for a week."""
    for folder in root.iterdir():
        with contextlib.suppress(OSError):  # another process may just have done it
            if folder != keep and folder.is_dir() and time.time() - folder.stat().st_mtime > _STALE_AFTER_S:
                shutil.rmtree(folder, ignore_errors=True)


def _choose_cache_folder() -> Path:
    root = _cache_root()
    folder = root / source_digest()
    with contextlib.suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
        os.utime(folder)
    _remove_stale(root, folder)
    return folder


# Both are needed: Numba reads its environment anew whenever that changes, and may have been imported before us.
CACHE_FOLDER = _choose_cache_folder()
os.environ["NUMBA_CACHE_DIR"] = str(CACHE_FOLDER)
_config: Any = numba.config
_config.CACHE_DIR = str(CACHE_FOLDER)
JIT_DISABLED = bool(_config.DISABLE_JIT)


class _Kept(FunctionCache):
    """Numba's own, but where files are damaged, or cannot be written, it costs no more than to compile anew."""

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        try:
            return super().load_overload(sig, target_context)
        except Exception:  # whatever unpickling stumbles over
            with contextlib.suppress(OSError):
                self.flush()
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        with contextlib.suppress(OSError):
            super().save_overload(sig, data)


def _kept(compiled: Any) -> Any:
    """Keep what a function is compiled to on the disk."""
    if not JIT_DISABLED:
        compiled._cache = _Kept(compiled.py_func)
    return compiled


def variant(*frozen: Any) -> Callable[[F], F]:
    """Give a function that a factory makes a name of its own, from the modules, functions or numbers frozen into it.

    Machine code knows its parts by name, argument types and a number that counts compilations within one process.
    Code from the disk was numbered by other processes: of two functions of one factory that were both the first
    compiled in theirs, a third process would call one for the other, without a word.
    """
    labels = [str(getattr(part, "__name__", part)).rpartition(".")[2] for part in frozen]

    def rename(function: F) -> F:
        function.__qualname__ = "_".join([function.__qualname__, *labels])
        function.__name__ = "_".join([function.__name__, *labels])
        return function

    return rename


def device(function: F) -> F:
    """A formula: plain Python when called from Python, compiled into its caller when called from a kernel."""
    return register_jitable(forceinline=True, **_FLAGS)(function)


def phase(function: F) -> F:
    """A parallel loop that is part of a kernel; `kernel(function)` makes it callable on its own."""
    return register_jitable(parallel=True, **_FLAGS)(function)


def kernel(function: F) -> F:
    """An entry point from Python: compiled, parallel, kept on disk. No fastmath: NaN checks and equal bits."""
    compiled: F = _kept(numba.njit(parallel=True, **_FLAGS)(function))
    return compiled


def driver(function: F) -> F:
    """An entry point from Python that runs phases one after the other: compiled and kept on disk."""
    compiled: F = _kept(numba.njit(**_FLAGS)(function))
    return compiled


def set_threads(threads: int | None) -> int:
    """Use `threads` threads (all cores that Numba was given if None); returns the number in use."""
    limit: int = _config.NUMBA_NUM_THREADS
    chosen = limit if threads is None else max(1, min(threads, limit))
    numba.set_num_threads(chosen)
    return chosen
