"""Deferred handling of signals and of the wall-clock limit: a run stops between two steps."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from math import inf
from types import FrameType
from typing import Any

NAMES = (
    "SIGINT", "SIGBREAK",  # Ctrl-C, Ctrl-Break of Windows
    "SIGTERM", "SIGUSR1", "SIGUSR2",  # schedulers, some time before they kill the process
    "SIGXCPU",  # the limit of processor time is reached
    "SIGHUP",  # the terminal was closed
)  # fmt: skip
SIGNALS = tuple(signal.Signals[name] for name in NAMES if name in signal.Signals.__members__)
# Systems send these more than once for one reason: a terminal closes, a limit is exceeded.
REPEATED = tuple(number for number in SIGNALS if number.name in ("SIGXCPU", "SIGHUP"))


class Stopped(Exception):
    """The run was asked to stop; the text is the reason."""


class StopRequest:
    """Records whether this process was asked to stop."""

    def __init__(self, max_wall: float = inf) -> None:
        self._deadline = time.monotonic() + max_wall
        self._process = os.getpid()
        self._received: signal.Signals | None = None
        self._previous: dict[signal.Signals, Any] = {}  # handlers of the caller

    @property
    def reason(self) -> str:
        """The signal or the limit that requested the stop; "" if there is no request."""
        if self._received:
            return self._received.name
        return "the wall-clock limit" if time.monotonic() > self._deadline else ""

    def raise_if_requested(self) -> None:
        """Raise Stopped if a stop was requested."""
        if reason := self.reason:
            raise Stopped(reason)

    def install(self) -> None:
        """Handle the signals, except those that the caller ignores or handles in C.

        Ctrl-C is handled in any case: shells let commands in the background ignore it.
        """
        for number in SIGNALS:
            handler = signal.getsignal(number)
            if handler is not None and (handler is not signal.SIG_IGN or number == signal.SIGINT):
                self._previous[number] = signal.signal(number, self.handle)

    def restore(self) -> None:
        """Restore the handlers of the caller, and pass on a signal that is not meant for the run alone."""
        for number, handler in self._previous.items():
            signal.signal(number, handler)
        if self._received and _must_pass_on(self._previous[self._received]):
            signal.raise_signal(self._received)

    def handle(self, number: int, frame: FrameType | None) -> None:
        """Signal handler: the first signal is recorded, the second one aborts the process at once.

        A child that was forked during the run is not the run: there the signal has the effect that it had before.
        """
        received = signal.Signals(number)
        if os.getpid() != self._process:
            signal.signal(received, self._previous[received])
            signal.raise_signal(received)
        elif self._received is None:
            self._received = received
        elif received not in REPEATED:
            raise KeyboardInterrupt


def _must_pass_on(handler: Any) -> bool:
    """Whether a signal that stopped a run must also reach the caller's `handler`.

    A handler that the caller installed expects it. In a child of `multiprocessing`, the library ends the process by a
    signal and waits for that. Otherwise the exception of the run informs the caller.
    """
    if handler is signal.SIG_DFL:
        return multiprocessing.parent_process() is not None
    return callable(handler) and handler is not signal.default_int_handler


@contextmanager
def stop_request(max_wall: float = inf) -> Iterator[StopRequest]:
    """Record signals, and a stop after `max_wall` seconds, during the context.

    Outside the main thread signals are not recorded, since Python does not allow it.
    """
    request = StopRequest(max_wall)
    if threading.current_thread() is not threading.main_thread():
        yield request
        return
    try:
        request.install()
        yield request
    finally:
        request.restore()
