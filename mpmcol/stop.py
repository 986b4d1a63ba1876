"""Signals that ask a run to end: noted when they come, heeded where nothing is half done."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

SIGNALS = (signal.SIGINT, signal.SIGTERM)  # a scheduler's wish is a Ctrl-C


class Stopped(Exception):
    """A run has been asked to end, and may keep what it has."""


class StopRequest:
    """Whether a signal has asked this process to end."""

    def __init__(self) -> None:
        self._asked = False

    def heed(self) -> None:
        """Raise Stopped if a signal has come."""
        if self._asked:
            raise Stopped

    def note(self, number: int, frame: FrameType | None) -> None:
        """The handler of the signals; the second one ends the process wherever it is."""
        if self._asked:
            raise KeyboardInterrupt
        self._asked = True


@contextmanager
def stop_request() -> Iterator[StopRequest]:
    """Note SIGINT and SIGTERM while inside; outside the main thread Python lets none be noted."""
    request = StopRequest()
    if threading.current_thread() is not threading.main_thread():
        yield request
        return
    before = {number: signal.signal(number, request.note) for number in SIGNALS}
    try:
        yield request
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
