"""Processes: wait for a condition, handle signals, and find the children of a process."""

from __future__ import annotations

import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any


def wait_until(condition: Callable[[], object], seconds: float = 120.0) -> None:
    """Return as soon as a condition is true; fail if it is still false after some seconds."""
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, f"the condition is still false after {seconds} s"
        time.sleep(0.01)


@contextmanager
def handled_by(handler: Any, *numbers: int) -> Iterator[None]:
    """Handle signals by `handler`, also if the process that started the tests ignores them."""
    previous = [(number, signal.signal(number, handler)) for number in numbers]
    try:
        yield
    finally:
        for number, handler in previous:
            signal.signal(number, handler)


def child_processes(parent: int) -> list[int]:
    """Process ids of the children of a process, from /proc."""
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            if int(path.read_text().rpartition(")")[2].split()[1]) == parent:
                found.append(int(path.parent.name))
        except OSError:
            continue
    return found
