"""Child processes that execute runs one after another, so that only the first run waits for imports and kernels."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from queue import Empty, SimpleQueue
from typing import Any

from mpmcol.sweep.scheduling import PROCESS_BYTES

# A process of its own group does not receive Ctrl-C from the terminal; the sweep does, and then stops its runs.
if sys.platform == "win32":
    OWN_GROUP: dict[str, Any] = {"creationflags": subprocess.CREATE_NEW_PROCESS_GROUP}
    STOP_SIGNAL = signal.CTRL_BREAK_EVENT
else:
    OWN_GROUP: dict[str, Any] = {"start_new_session": True}
    STOP_SIGNAL = signal.SIGTERM

CONTINUE, STOP, ABORT = range(3)  # levels of a stop request: none, stop with a checkpoint, kill
StopRequest = Callable[[], int]  # returns the level

COMPILE = "compile"  # a command that `mpmcol` lacks: compile the kernels of the given cases, or load them
GRACE = 30.0  # s for a stopped run to write its checkpoint, before it is killed
POLL = 0.1  # s


def worker_command() -> list[str]:
    """The command of a process that reads arguments of `mpmcol`, or COMPILE, and answers with exit codes."""
    return [sys.executable, "-m", "mpmcol.cli.worker"]


class Worker:
    """Executes commands of `mpmcol` in a child process, one at a time.

    The process is started by the first command. It is replaced after a command that was not successful, which is
    then tried again in a new process, and once it has more memory than PROCESS_BYTES between two commands, since that
    of compilation and of the kernels of many schemes is not freed.
    """

    def __init__(self) -> None:
        self._process: subprocess.Popen[str] | None = None
        self._threads = 0
        self._answers: SimpleQueue[str] = SimpleQueue()
        # What the commands print, written by the process. The position in the file is that of both processes.
        self._output = tempfile.TemporaryFile(buffering=0)  # noqa: SIM115  # `close` closes it

    def start(self, threads: int) -> subprocess.Popen[str]:
        """Start the process unless it is there, with `threads` threads. Raises OSError."""
        if self._process and (self._process.poll() is not None or self._threads != threads):
            self._end_process()
        if self._process is None:
            self._process = subprocess.Popen(
                worker_command(),
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._output,
                env={**os.environ, "NUMBA_NUM_THREADS": str(threads)},
                encoding="utf-8",
                **OWN_GROUP,
            )
            self._threads, self._answers = threads, SimpleQueue()
            threading.Thread(target=_forward, args=(self._process, self._answers), daemon=True).start()
        return self._process

    def execute(self, arguments: Sequence[str], threads: int, stop: StopRequest = lambda: CONTINUE) -> tuple[int, str]:
        """Execute a command; returns its exit code, negative if a signal ended the process, and what it printed.

        Raises OSError if no process can be started.
        """
        process = self.start(threads)
        self._output.seek(0)
        self._output.truncate()
        assert process.stdin is not None
        with suppress(OSError):  # the process has ended, as its exit code will tell
            process.stdin.write(json.dumps(list(arguments)) + "\n")
            process.stdin.flush()
        try:
            code, resident = self._wait(process, stop)
        except BaseException:  # Ctrl-C
            process.kill()
            raise
        self._output.seek(0)
        printed = self._output.read().decode(errors="replace")
        if code != 0 or resident > PROCESS_BYTES:
            self._end_process()
        return code, printed

    def close(self) -> None:
        """End the process."""
        self._end_process()
        self._output.close()

    def _wait(self, process: subprocess.Popen[str], stop: StopRequest) -> tuple[int, int]:
        """Exit code and memory (bytes) in the answer of the process, or its own exit code if it ends.

        A stop request signals it, and later kills it.
        """
        deadline = 0.0
        while True:
            with suppress(Empty):
                answer = self._answers.get(timeout=POLL)
                code, resident = map(int, answer.split()) if answer else (process.wait(), 0)
                return code, resident
            if stop() and not deadline:
                with suppress(OSError):  # Windows sends it only within a console; the run is killed later
                    process.send_signal(STOP_SIGNAL)
                deadline = time.monotonic() + GRACE
            if deadline and (stop() >= ABORT or time.monotonic() > deadline):
                process.kill()

    def _end_process(self) -> None:
        if self._process is None:
            return
        with suppress(OSError):  # it has ended already
            if self._process.stdin:
                self._process.stdin.close()
        try:
            self._process.wait(GRACE)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._process = None


def _forward(process: subprocess.Popen[str], answers: SimpleQueue[str]) -> None:
    """Put each answer of a process into the queue, and an empty one at its end."""
    if process.stdout:
        with process.stdout:
            for line in process.stdout:
                answers.put(line)
    answers.put("")
