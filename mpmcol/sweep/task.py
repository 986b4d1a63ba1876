"""One point of a sweep carried out from beginning to end, in a process of its own that may die alone."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from mpmcol.errors import Interrupted, NumericalFailure, OutputError, UsageError
from mpmcol.io.lock import is_locked
from mpmcol.io.names import GIVEN_CASE_FILE, LOG_FILE
from mpmcol.io.run_status import RunStatus, read_status
from mpmcol.provenance import code_version

RETRIES = 2
GRACE = 30.0  # s that a run has to write its last state
POLL = 0.1  # s

Halt = Callable[[], int]  # 0 go on, 1 end the run in good order, 2 end it at once


@dataclass(frozen=True)
class Task:
    """What a worker has to know; it needs no more than this and the folder."""

    folder: Path
    threads: int
    version: str  # of the code


@dataclass(frozen=True)
class TaskResult:
    """How a task ended.

    "done", "failed" (the simulation diverged), "error" (anything else went wrong, as often as it was tried) or
    "interrupted". `message` says why it is not done; `attempts` is 0 if the run had ended before.
    """

    status: Literal["done", "failed", "error", "interrupted"]
    attempts: int = 0
    exit_code: int = 0
    message: str = ""


def run_command(folder: Path, threads: int, fresh: bool = False) -> list[str]:
    """The command that runs the case in a point's folder."""
    words = [sys.executable, "-m", "mpmcol", "run", str(folder / GIVEN_CASE_FILE), "--out", str(folder)]
    return [*words, "--threads", str(threads), *(["--fresh"] if fresh else [])]


def carry_out(task: Task, halt: Halt = lambda: 0) -> TaskResult:
    """Run a task until it is done, has diverged, or has gone wrong more than RETRIES times.

    A run that another process has in hand is waited for. A simulation that diverges is not tried again: it gives equal
    bits every time.
    """
    if code_version() != task.version:
        return TaskResult(
            "error", 0, UsageError.exit_code, f"this worker has mpmcol {code_version()}, not {task.version}"
        )
    attempts, code = 0, 0
    while True:
        state = _when_free(task.folder, halt)
        if state.has_ended:
            return _ended(state, attempts)
        if halt():
            return TaskResult("interrupted", attempts, Interrupted.exit_code)
        if attempts > RETRIES or code == UsageError.exit_code:
            return TaskResult("error", attempts, code, _why(task.folder, code, attempts))
        try:
            code = _attempt(task, state.name == "damaged", halt)
        except OSError as error:
            return TaskResult("error", attempts, OutputError.exit_code, f"it cannot be started: {error}")
        attempts += 1


def _when_free(folder: Path, halt: Halt) -> RunStatus:
    """The state of a run once no process has it in hand, or when the task is to end."""
    while is_locked(folder) and not halt():
        time.sleep(POLL)
    return read_status(folder)


def _attempt(task: Task, fresh: bool, halt: Halt) -> int:
    """The exit code of one run; negative if a signal ended it."""
    environment = {**os.environ, "NUMBA_NUM_THREADS": str(task.threads)}
    with (task.folder / LOG_FILE).open("wb") as log:
        run = subprocess.Popen(
            run_command(task.folder, task.threads, fresh),
            stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT, env=environment,
            start_new_session=True,  # a Ctrl-C in the terminal reaches the sweep alone, which ends its runs itself
        )  # fmt: skip
    deadline = 0.0
    while run.poll() is None:
        time.sleep(POLL)
        if halt() and not deadline:
            run.send_signal(signal.SIGTERM)
            deadline = time.monotonic() + GRACE
        if deadline and (halt() > 1 or time.monotonic() > deadline):
            run.kill()
    return int(run.returncode)


def _ended(state: RunStatus, attempts: int) -> TaskResult:
    if state.name == "done":
        return TaskResult("done", attempts)
    return TaskResult("failed", attempts, NumericalFailure.exit_code, state.failure)


def _why(folder: Path, code: int, attempts: int) -> str:
    """The last line that a run said before it went wrong, and how it ended."""
    path = folder / LOG_FILE
    try:
        lines = [line.strip() for line in path.read_text(errors="replace").splitlines() if line.strip()]
    except OSError:
        lines = []
    ended = f"killed by {signal.Signals(-code).name}" if code < 0 else f"exit code {code}"
    tries = "" if attempts == 1 else f", {attempts} times"
    said = f": {lines[-1]}" if lines and code > 0 else ""
    return f"{ended}{tries}{said} ({path})"
