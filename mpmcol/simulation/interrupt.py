"""What asks a run to end, signals and a limit of time: noted when it comes, heeded where nothing is half done."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from math import inf
from types import FrameType

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGUSR1)  # a person, a scheduler, a scheduler some time before


class Stopped(Exception):
    """A run has been asked to end, and may keep what it has; the text says by what."""


class StopRequest:
    """Whether this process has been asked to end."""

    def __init__(self, max_wall: float = inf) -> None:
        self._deadline = time.monotonic() + max_wall
        self._signal = ""

    @property
    def asked(self) -> str:
        """By what; "" if it has not been."""
        return self._signal or ("the limit of time" if time.monotonic() > self._deadline else "")

    def heed(self) -> None:
        """Raise Stopped if it has been."""
        if asked := self.asked:
            raise Stopped(asked)

    def note(self, number: int, frame: FrameType | None) -> None:
        """The handler of the signals; the second one ends the process wherever it is."""
        if self._signal:
            raise KeyboardInterrupt
        self._signal = signal.Signals(number).name


@contextmanager
def stop_request(max_wall: float = inf) -> Iterator[StopRequest]:
    """Note signals while inside, and that `max_wall` seconds have gone by.

    Outside the main thread Python lets no signal be noted.
    """
    request = StopRequest(max_wall)
    if threading.current_thread() is not threading.main_thread():
        yield request
        return
    before = {number: signal.signal(number, request.note) for number in SIGNALS}
    try:
        yield request
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
