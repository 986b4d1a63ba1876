"""Cores of this machine, and the note about more threads than cores."""

from __future__ import annotations

import os


def available_cores() -> int:
    """Number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def thread_note(threads: int) -> str | None:
    """A note if a run has more threads than cores; its results are the same."""
    if threads <= (cores := available_cores()):
        return None
    return f"{threads} threads on {cores} core{'s' if cores > 1 else ''}: no faster than {cores}; omit --threads"
