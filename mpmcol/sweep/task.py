"""Execution of one run of a sweep in a child process, with retries."""

from __future__ import annotations

import signal
import sys
import time
from collections.abc import Sequence
from contextlib import closing, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from mpmcol.errors import Interrupted, NumericalFailure, OutputError, UsageError
from mpmcol.io.lock import is_locked
from mpmcol.io.names import GIVEN_CASE_FILE, LOG_FILE
from mpmcol.io.run_status import RunStatus, read_status
from mpmcol.provenance import code_version
from mpmcol.sweep.worker import CONTINUE, POLL, StopRequest, Worker

RETRIES = 2


@dataclass(frozen=True)
class Task:
    """A run for a worker: its folder, which contains the case, threads, and the version of the code to use."""

    folder: Path
    threads: int
    version: str


@dataclass(frozen=True)
class TaskResult:
    """How a task ended.

    status: "done", "failed" (the simulation diverged), "error" (any other failure, after all attempts) or
        "interrupted".
    attempts: 0 if the run had ended before.
    message: the reason if the run is not done.
    """

    status: Literal["done", "failed", "error", "interrupted"]
    attempts: int = 0
    exit_code: int = 0
    message: str = ""


def run_command(folder: Path, threads: int, fresh: bool = False) -> list[str]:
    """The command that executes the case in the folder of a run."""
    return [sys.executable, "-m", "mpmcol", *run_arguments(folder, threads, fresh)]


def run_arguments(folder: Path, threads: int, fresh: bool = False) -> list[str]:
    """The arguments of `mpmcol` that execute the case in the folder of a run."""
    arguments = ["run", str(folder / GIVEN_CASE_FILE), "--out", str(folder), "--threads", str(threads)]
    return [*arguments, *(["--fresh"] if fresh else [])]


def execute_task(task: Task, stop: StopRequest = lambda: CONTINUE) -> TaskResult:
    """Execute a run in a process of its own; see `execute_with`."""
    with closing(Worker()) as worker:
        return execute_with(worker, task, stop)


def execute_with(worker: Worker, task: Task, stop: StopRequest) -> TaskResult:
    """Execute a run until it is done, has diverged, or has failed more than RETRIES times.

    A run that another process is executing is waited for. A simulation that diverged is not repeated, because it would
    diverge again with identical numbers.
    """
    if code_version() != task.version:
        message = f"the worker has mpmcol {code_version()}, expected {task.version}; install the same version there"
        return TaskResult("error", 0, UsageError.exit_code, message)
    attempts, code, printed = 0, 0, ""
    while True:
        status = _status_when_unlocked(task.folder, stop)
        if status.has_ended:
            return result_of_ended(status, attempts)
        if stop():
            return TaskResult("interrupted", attempts, Interrupted.exit_code)
        if attempts > RETRIES or code == UsageError.exit_code:
            return TaskResult("error", attempts, code, _failure_message(task.folder, code, printed, attempts))
        try:
            arguments = run_arguments(task.folder, task.threads, fresh=status.name == "damaged")
            code, printed = worker.execute([*arguments, "--quiet"], task.threads, stop)
        except OSError as error:
            return TaskResult("error", attempts, OutputError.exit_code, f"the run cannot be started: {error}")
        attempts += 1


def _status_when_unlocked(folder: Path, stop: StopRequest) -> RunStatus:
    """The status of a run once no process is executing it, or once a stop is requested."""
    while is_locked(folder) and not stop():
        time.sleep(POLL)
    return read_status(folder)


def result_of_ended(status: RunStatus, attempts: int = 0) -> TaskResult:
    """The result of a run that is done or has diverged, after this number of attempts."""
    if status.name == "done":
        return TaskResult("done", attempts)
    return TaskResult("failed", attempts, NumericalFailure.exit_code, status.failure)


def _complete_log(path: Path, printed: Sequence[str]) -> None:
    """Add the lines that a run printed to its log if they are not there, because it ended before it opened the log."""
    with suppress(OSError):
        known = path.read_text("utf-8", errors="replace") if path.exists() else ""
        with path.open("a", encoding="utf-8") as log:
            log.writelines(f"{line}\n" for line in printed if line not in known)


def _failure_message(folder: Path, code: int, printed: str, attempts: int) -> str:
    """How a run ended, with the last line that it printed."""
    path = folder / LOG_FILE
    lines = [line.strip() for line in printed.splitlines() if line.strip()]
    _complete_log(path, lines)
    ended = f"killed by {_signal_name(-code)}" if code < 0 else f"exit code {code}"
    tries = "" if attempts == 1 else f", {attempts} times"
    last = f": {lines[-1]}" if lines and code > 0 else ""
    return f"{ended}{tries}{last} ({path})"


def _signal_name(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:  # a real-time signal
        return f"signal {number}"
