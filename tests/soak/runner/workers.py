"""Processes that carry out trials: one that crashes or hangs counts as a failure, and the others continue."""

from __future__ import annotations

import multiprocessing
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing.pool import ThreadPool
from pathlib import Path
from queue import SimpleQueue

from tests.soak.runner.promise import load_promise

TIME_LIMIT = 1800.0  # s, far above the duration of any trial

Task = tuple[str, int]  # name of the promise, seed
Ended = tuple[Task, str | None, float]  # with the failure, if any, and the duration in s


class Worker:
    """A process that carries out one trial after another, and is replaced if it dies."""

    def __init__(self) -> None:
        self._pool = _new_pool()

    def carry_out(self, task: Task, folder: Path) -> str | None:
        """Carry out a trial; return its failure, if any."""
        future = self._pool.submit(attempt, *task, folder)
        try:
            return future.result(TIME_LIMIT)
        except (BrokenProcessPool, TimeoutError) as error:
            self.close()
            self._pool = _new_pool()
            is_late = isinstance(error, TimeoutError)
            return f"the trial did not end within {TIME_LIMIT:.0f} s" if is_late else "the process of the trial died"

    def close(self) -> None:
        """Kill the process."""
        for process in list((self._pool._processes or {}).values()):
            process.kill()
        self._pool.shutdown(cancel_futures=True)


def attempt(name: str, seed: int, folder: Path) -> str | None:
    """Carry out one trial in the process of a worker."""
    return load_promise(name).attempt(seed, folder)


def carry_out_all(tasks: Sequence[Task], jobs: int, folder: Path, deadline: float) -> Iterator[Ended]:
    """Carry out tasks, `jobs` at a time, each in its own folder; start none after `deadline` (`time.monotonic`)."""
    idle: SimpleQueue[Worker] = SimpleQueue()
    workers = [Worker() for _ in range(jobs)]
    for worker in workers:
        idle.put(worker)

    def carry_out(task: Task) -> Ended | None:
        started = time.monotonic()
        if started > deadline:
            return None
        worker = idle.get()
        failure = worker.carry_out(task, folder / f"{task[0]}-{task[1]}")
        idle.put(worker)
        return task, failure, time.monotonic() - started

    try:
        with ThreadPool(jobs) as threads:
            yield from filter(None, threads.imap_unordered(carry_out, tasks))
    finally:
        for worker in workers:
            worker.close()


def _new_pool() -> ProcessPoolExecutor:
    return ProcessPoolExecutor(1, multiprocessing.get_context("spawn"))
