"""Deferred handling of signals and of the wall-clock limit: a run stops between two steps."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from math import inf
from types import FrameType

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGUSR1)  # Ctrl-C, schedulers, schedulers some time before the end


class Stopped(Exception):
    """The run was asked to stop; the text is the reason."""


class StopRequest:
    """Records whether this process was asked to stop."""

    def __init__(self, max_wall: float = inf) -> None:
        self._deadline = time.monotonic() + max_wall
        self._signal = ""

    @property
    def reason(self) -> str:
        """The signal or the limit that requested the stop; "" if there is no request."""
        return self._signal or ("the wall-clock limit" if time.monotonic() > self._deadline else "")

    def raise_if_requested(self) -> None:
        """Raise Stopped if a stop was requested."""
        if reason := self.reason:
            raise Stopped(reason)

    def handle(self, number: int, frame: FrameType | None) -> None:
        """Signal handler: the first signal is recorded, the second one aborts the process at once."""
        if self._signal:
            raise KeyboardInterrupt
        self._signal = signal.Signals(number).name


@contextmanager
def stop_request(max_wall: float = inf) -> Iterator[StopRequest]:
    """Record signals, and a stop after `max_wall` seconds, during the context.

    Outside the main thread signals are not recorded, since Python does not allow it.
    """
    request = StopRequest(max_wall)
    if threading.current_thread() is not threading.main_thread():
        yield request
        return
    before = {number: signal.signal(number, request.handle) for number in SIGNALS}
    try:
        yield request
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
