"""Threads of compiled functions: their number, calls from several threads of Python, and forked processes."""

from __future__ import annotations

import contextlib
import os
import threading
from collections.abc import Iterator

import numba

from mpmcol.errors import UsageError
from mpmcol.mpm.jit import THREAD_LIMIT

_forked_with_threads = False  # whether this process is a child forked from one that had started threads
_only_caller = threading.Lock()


def _record_fork() -> None:
    """Called in every forked child."""
    global _forked_with_threads, _only_caller
    _forked_with_threads = _forked_with_threads or _threading_layer() != ""
    _only_caller = threading.Lock()  # the thread that may hold the other one does not exist here


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_record_fork)


def _threading_layer() -> str:
    """The library whose threads Numba uses, "" before the first parallel loop was prepared."""
    try:
        return str(numba.threading_layer())
    except ValueError:
        return ""


def require_threads() -> None:
    """Raise UsageError in a forked child whose parent had started threads; the child would wait for them for ever."""
    if _forked_with_threads:
        raise UsageError(
            "this process was forked from one that had already computed, and threads do not survive a fork; start "
            'processes by multiprocessing.get_context("spawn") or "forkserver", or fork before the first computation'
        )


@contextlib.contextmanager
def compiled_calls(compiling: bool = False) -> Iterator[None]:
    """Context of calls of compiled functions from Python, which several threads of Python may enter.

    Only one at a time compiles, and only one at a time computes if the threading layer allows no more.

    Raises:
        UsageError: see `require_threads`.
    """
    require_threads()
    if compiling or _threading_layer() == "workqueue":
        with _only_caller:
            yield
    else:
        yield


def threads_in_use() -> int:
    """Number of threads of the next call from the present thread of Python."""
    return int(numba.get_num_threads())


def set_threads(threads: int | None) -> int:
    """Use `threads` threads for calls from the present thread of Python; returns the number in use.

    None: all that Numba may use, or OMP_NUM_THREADS if that is fewer.

    Raises:
        UsageError: the library that NUMBA_THREADING_LAYER names is not installed, or see `require_threads`.
    """
    require_threads()
    allowed = os.environ.get("OMP_NUM_THREADS", "").partition(",")[0]  # further numbers are of nested levels
    default = int(allowed) if allowed.isdecimal() else THREAD_LIMIT
    chosen = max(1, min(default if threads is None else threads, THREAD_LIMIT))
    try:
        numba.set_num_threads(chosen)
    except ValueError as missing:
        layer = os.environ.get("NUMBA_THREADING_LAYER", "")
        raise UsageError(
            f"NUMBA_THREADING_LAYER = {layer!r} is not available here; remove this variable, or set it to omp or "
            "workqueue"
        ) from missing
    return chosen
