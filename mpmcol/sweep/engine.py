"""Execution of planned runs on a pool of workers; yields an outcome for each run as it ends."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, Future, ThreadPoolExecutor, wait
from contextlib import ExitStack, contextmanager, nullcontext, suppress
from dataclasses import dataclass, field
from queue import LifoQueue

from mpmcol.errors import Interrupted, MpmcolError, NumericalFailure, OutputError, UsageError
from mpmcol.io.run_status import read_status
from mpmcol.provenance import code_version
from mpmcol.sweep.compile_cache import kernel_variant, smallest_per_variant
from mpmcol.sweep.runs import PlannedRun, write_case
from mpmcol.sweep.scheduling import Allocation, allocate
from mpmcol.sweep.task import Task, TaskResult, execute_task, execute_with, result_of_ended
from mpmcol.sweep.worker import ABORT, COMPILE, CONTINUE, STOP, StopRequest, Worker

TICK = 0.25  # s

Notify = Callable[[str], None]
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
    """Workers: an executor, the stop request that its tasks poll, and the function that sets its level.

    compile: compiles the kernels of some cases, for that number of threads per run, before the first tasks.
    compiled: variants of kernels for which this was done.
    """

    executor: Executor
    slots: int  # concurrent tasks
    stop: StopRequest
    request_stop: Callable[[int], None]
    execute: Callable[[Task, StopRequest], TaskResult] = execute_task
    compile: Callable[[Sequence[str], int], None] | None = None
    compiled: set[tuple[object, ...]] = field(default_factory=set)


def execute_runs(
    runs: Sequence[PlannedRun],
    allocation: Allocation | None = None,
    *,
    pool: Pool | None = None,
    notify: Notify = lambda line: None,
    tick: Tick = lambda: None,
) -> Generator[Outcome]:
    """Execute runs, largest first, and yield the outcome of each as it ends, beginning with those that ended before.

    A run that fails does not stop the others. When the generator is closed, or Ctrl-C is pressed while it waits, the
    runs are stopped with a checkpoint; a second Ctrl-C kills them. Use `contextlib.closing` where the loop may be left
    early.

    Args:
        runs: from `plan_runs` or `plan_run`.
        allocation: concurrent runs and threads per run (default: chosen from the sizes).
        pool: workers (default: processes on this machine); see `mpmcol.sweep.dask_engine`.
        notify: called with one-line messages.
        tick: called several times a second while runs are executed.
    """
    pending = []
    for run in runs:
        write_case(run)
        if (status := read_status(run.folder)).has_ended:
            yield Outcome(run, result_of_ended(status))
        else:
            pending.append(run)
    if not pending:
        return
    allocation = allocation or allocate(pending)
    with nullcontext(pool) if pool else local_pool(allocation.jobs) as opened:
        new = [run for run in smallest_per_variant(pending) if kernel_variant(run) not in opened.compiled]
        if opened.compile and new and min(allocation.jobs, len(pending)) > 1:
            notify("compiling kernels that are not in the cache ...")
            opened.compile([str(write_case(run)) for run in new], allocation.threads)
            opened.compiled.update(map(kernel_variant, new))
        yield from _execute_on(opened, pending, allocation.threads, notify, tick)


def exit_code(outcomes: Sequence[Outcome]) -> int:
    """Exit code of a sweep: the first that applies of 75 interrupted, 5 files, 3 diverged, 2 refused, 1 other error.

    0 if all runs are done.
    """
    codes = {outcome.result.exit_code for outcome in outcomes if outcome.status != "done"}
    known = (Interrupted.exit_code, OutputError.exit_code, NumericalFailure.exit_code, UsageError.exit_code)
    return next((code for code in known if code in codes), 1) if codes else 0


def unsuccessful(outcomes: Sequence[Outcome], message: str) -> MpmcolError:
    """The error of a report for which too few runs are done; it has the exit code of the runs."""
    error = OutputError(message)
    error.exit_code = exit_code(outcomes) or OutputError.exit_code
    return error


@contextmanager
def local_pool(jobs: int) -> Iterator[Pool]:
    """Threads of this process, each of which supervises one child process at a time."""
    level = [CONTINUE]
    workers = [Worker() for _ in range(jobs)]
    idle = LifoQueue[Worker]()  # first those that have a process
    for worker in workers:
        idle.put(worker)

    def request_stop(requested: int) -> None:
        level[0] = requested

    @contextmanager
    def one_of_them() -> Iterator[Worker]:
        worker = idle.get()
        try:
            yield worker
        finally:
            idle.put(worker)

    def execute(task: Task, stop: StopRequest) -> TaskResult:
        with one_of_them() as worker:
            return execute_with(worker, task, stop)

    def compile_first(cases: Sequence[str], threads: int) -> None:
        """Compile in one process, while the others import; its errors are ignored, because the runs report them."""
        with suppress(OSError), one_of_them() as worker:
            for each in workers:
                each.start(threads)
            worker.execute([COMPILE, *cases], threads)

    with ExitStack() as stack:
        for worker in workers:
            stack.callback(worker.close)
        executor = stack.enter_context(ThreadPoolExecutor(jobs))
        yield Pool(executor, jobs, lambda: level[0], request_stop, execute, compile_first)


class KeptPool:
    """Processes on this machine that serve several sweeps one after another, so that they import and compile once.

    A context manager: the processes end with it.
    """

    def __init__(self) -> None:
        self._stack = ExitStack()
        self._jobs = 0
        self._pool: Pool | None = None

    def __enter__(self) -> KeptPool:
        return self

    def __exit__(self, *error: object) -> None:
        self._stack.close()

    def serve(self, jobs: int) -> Pool:
        """The pool for a number of concurrent runs; another number starts new processes."""
        if self._pool is None or jobs != self._jobs:
            self._stack.close()
            self._jobs, self._pool = jobs, self._stack.enter_context(local_pool(jobs))
        return self._pool


def _execute_on(pool: Pool, runs: Sequence[PlannedRun], threads: int, notify: Notify, tick: Tick) -> Iterator[Outcome]:
    pending: dict[Future[TaskResult], PlannedRun] = {}
    for run in sorted(runs, key=lambda run: run.cost, reverse=True):
        task = Task(run.folder.resolve(), threads, code_version())
        pending[pool.executor.submit(pool.execute, task, pool.stop)] = run
    try:
        while pending:
            ended, _ = wait(pending, timeout=TICK, return_when=FIRST_COMPLETED)
            for future in ended:
                yield Outcome(pending.pop(future), _task_result(future))
            tick()
    finally:
        if pending:
            _stop(pending, pool, notify)


def _task_result(future: Future[TaskResult]) -> TaskResult:
    """The result of a task, or the reason why there is none, for example a worker that died."""
    try:
        return future.result()
    except CancelledError:
        return TaskResult("error", 1, 1, "the scheduler cancelled the run")
    except Exception as error:
        return TaskResult("error", 1, 1, f"{type(error).__name__}: {error}")


def _stop(pending: dict[Future[TaskResult], PlannedRun], pool: Pool, notify: Notify) -> None:
    """Stop all runs and wait for them; a KeyboardInterrupt kills them."""
    notify("stopping the runs (press Ctrl-C again to abort) ...")
    pool.request_stop(STOP)
    try:
        wait(pending)
    except KeyboardInterrupt:
        pool.request_stop(ABORT)
        wait(pending)
    pool.request_stop(CONTINUE)
