"""Carries out trials in processes of their own, so that one that dies or hangs is a failure and not the end."""

from __future__ import annotations

import multiprocessing
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing.pool import ThreadPool
from pathlib import Path
from queue import SimpleQueue

from tests.soak.figures import load_figure

HANG = 1800.0  # s: no trial is meant to last that long

Task = tuple[str, int]  # figure and seed
Ended = tuple[Task, str | None, float]  # with what went wrong, and seconds


class Worker:
    """A process that carries out one trial after another, and another process after it has died."""

    def __init__(self) -> None:
        self._pool = _open()

    def carry_out(self, task: Task, folder: Path) -> str | None:
        """What went wrong in a trial, None if nothing did."""
        future = self._pool.submit(attempt, *task, folder)
        try:
            return future.result(HANG)
        except (BrokenProcessPool, TimeoutError) as error:
            self.close()
            self._pool = _open()
            return f"it hung for {HANG:.0f} s" if isinstance(error, TimeoutError) else "its process died"

    def close(self) -> None:
        """End the process, whatever it does."""
        for process in list((self._pool._processes or {}).values()):
            process.kill()
        self._pool.shutdown(cancel_futures=True)


def attempt(name: str, seed: int, folder: Path) -> str | None:
    """One trial, in the process of a worker."""
    return load_figure(name).attempt(seed, folder)


def carry_out_all(tasks: Sequence[Task], jobs: int, folder: Path, deadline: float) -> Iterator[Ended]:
    """Carry out tasks, so many at a time, each in a folder of its own, until a moment of `time.monotonic`."""
    workers: SimpleQueue[Worker] = SimpleQueue()
    opened = [Worker() for _ in range(jobs)]
    for worker in opened:
        workers.put(worker)

    def one(task: Task) -> Ended | None:
        started = time.monotonic()
        if started > deadline:
            return None
        worker = workers.get()
        wrong = worker.carry_out(task, folder / f"{task[0]}-{task[1]}")
        workers.put(worker)
        return task, wrong, time.monotonic() - started

    try:
        with ThreadPool(jobs) as threads:
            yield from filter(None, threads.imap_unordered(one, tasks))
    finally:
        for worker in opened:
            worker.close()


def _open() -> ProcessPoolExecutor:
    return ProcessPoolExecutor(1, multiprocessing.get_context("spawn"))
