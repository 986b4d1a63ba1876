"""The engine of sweeps: takes a list of points and yields an outcome for each as it ends."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass

from mpmcol.errors import Interrupted, MpmcolError, NumericalFailure, OutputError, UsageError
from mpmcol.io.run_status import read_status
from mpmcol.provenance import code_version
from mpmcol.sweep.compile_cache import smallest_of_each
from mpmcol.sweep.runs import PlannedRun, freeze
from mpmcol.sweep.scheduling import Allocation, allocate
from mpmcol.sweep.task import Halt, Task, TaskResult, carry_out

TICK = 0.25  # s

Say = Callable[[str], None]
Tick = Callable[[], None]


@dataclass(frozen=True)
class Outcome:
    """A planned run and how it ended."""

    run: PlannedRun
    result: TaskResult

    @property
    def status(self) -> str:
        """See `TaskResult`."""
        return self.result.status


@dataclass(frozen=True)
class Pool:
    """Where tasks are carried out: any executor, what its tasks ask whether to halt, and how they are told (`Halt`)."""

    executor: Executor
    slots: int  # tasks at a time
    halt: Halt
    stop: Callable[[int], None]


def execute_runs(
    points: Sequence[PlannedRun],
    shares: Allocation | None = None,
    *,
    pool: Pool | None = None,
    say: Say = lambda line: None,
    tick: Tick = lambda: None,
) -> Generator[Outcome]:
    """Carry out all points, largest first, and yield the outcome of each as it ends; first those that had ended before.

    No point that goes wrong stops the others. When the iterator is closed, or Ctrl-C comes while it waits, the runs are
    ended in good order, and at once at a second Ctrl-C: use `contextlib.closing` where the loop may be left early.

    Args:
        points: made by `plan_runs` or `plan_run`.
        shares: points at a time and threads of each (default: chosen from the sizes).
        pool: where to run (default: processes on this machine); see `mpmcol.sweep.dask_engine`.
        say: is told what happens, in one line.
        tick: is called some times a second while runs go on.
    """
    left = []
    for point in points:
        freeze(point)
        if read_status(point.folder).has_ended:
            yield Outcome(point, carry_out(Task(point.folder, 1, code_version())))
        else:
            left.append(point)
    if not left:
        return
    shares = shares or allocate(left)
    if pool is None and min(shares.jobs, len(left)) > 1:
        say("compiling kernels where they are not kept from before ...")
        _compile(left)
    with nullcontext(pool) if pool else local_pool(shares.jobs) as opened:
        yield from _carry_out_all(left, shares.threads, opened, say, tick)


def exit_code(outcomes: Sequence[Outcome]) -> int:
    """Of a sweep, the first that is true of a point: 75 halted, 5 files, 3 diverged, 2 refused, 1 else; 0 all done."""
    codes = {outcome.result.exit_code for outcome in outcomes if outcome.status != "done"}
    known = (Interrupted.exit_code, OutputError.exit_code, NumericalFailure.exit_code, UsageError.exit_code)
    return next((code for code in known if code in codes), 1) if codes else 0


def unsuccessful(outcomes: Sequence[Outcome], message: str) -> MpmcolError:
    """The error of a report that too few runs ended well for; it has their exit code."""
    error = OutputError(message)
    error.exit_code = exit_code(outcomes) or OutputError.exit_code
    return error


@contextmanager
def local_pool(jobs: int) -> Iterator[Pool]:
    """Threads of this process, each of which looks after one run in a process of its own."""
    urgency = [0]

    def stop(urgent: int) -> None:
        urgency[0] = urgent

    with ThreadPoolExecutor(jobs) as executor:
        yield Pool(executor, jobs, lambda: urgency[0], stop)


def _carry_out_all(points: Sequence[PlannedRun], threads: int, pool: Pool, say: Say, tick: Tick) -> Iterator[Outcome]:
    ordered = sorted(points, key=lambda point: point.work, reverse=True)
    pending: dict[Future[TaskResult], PlannedRun] = {}
    for point in ordered:
        task = Task(point.folder.resolve(), threads, code_version())
        pending[pool.executor.submit(carry_out, task, pool.halt)] = point
    try:
        while pending:
            ended, _ = wait(pending, timeout=TICK, return_when=FIRST_COMPLETED)
            for future in ended:
                yield Outcome(pending.pop(future), _ending(future))
            tick()
    finally:
        if pending:
            _halt(pending, pool, say)


def _ending(future: Future[TaskResult]) -> TaskResult:
    """The task's own, or one that tells why there is none, such as workers that died."""
    try:
        return future.result()
    except CancelledError:
        return TaskResult("error", 1, 1, "the scheduler has dropped it")
    except Exception as error:
        return TaskResult("error", 1, 1, f"{type(error).__name__}: {error}")


def _halt(pending: dict[Future[TaskResult], PlannedRun], pool: Pool, say: Say) -> None:
    """End all runs and wait for them; KeyboardInterrupt ends them at once."""
    say("ending the runs (Ctrl-C again: at once) ...")
    pool.stop(1)
    try:
        wait(pending)
    except KeyboardInterrupt:
        pool.stop(2)
        wait(pending)
    pool.stop(0)


def _compile(points: Sequence[PlannedRun]) -> None:
    """Compile what the points need once, in a process that is left behind; what goes wrong there, the runs tell."""
    cases = [str(freeze(point)) for point in smallest_of_each(points)]
    command = [sys.executable, "-m", "mpmcol.sweep.compile_cache", *cases]
    environment = {**os.environ, "NUMBA_NUM_THREADS": "1"}
    subprocess.run(command, env=environment, stdin=subprocess.DEVNULL, capture_output=True, start_new_session=True)
