"""Allocation of cores to the runs of a sweep, and estimates of their duration."""

from __future__ import annotations

import heapq
from collections.abc import Sequence
from dataclasses import dataclass

from mpmcol.setup.cores import available_cores
from mpmcol.setup.cost import estimate
from mpmcol.setup.memory import machine_memory, memory_bytes
from mpmcol.sweep.arguments import require_count
from mpmcol.sweep.compile_cache import kernel_variant
from mpmcol.sweep.runs import PlannedRun

POINTS_PER_THREAD = 10_000  # material points; with fewer, another thread gains nothing
SPEEDUP_EXPONENT = 0.9  # n threads are as fast as n**0.9 single threads
MEMORY_SHARE = 0.8  # of the machine's memory that runs may use together
PROCESS_BYTES = 250e6  # interpreter, compiler and kernels


@dataclass(frozen=True)
class Allocation:
    """Number of concurrent runs and number of threads per run."""

    jobs: int
    threads: int

    def __str__(self) -> str:
        jobs = "1 run" if self.jobs == 1 else f"{self.jobs} runs"
        return f"{jobs} at a time, {self.threads} thread{'s' if self.threads > 1 else ''} per run"


def allocate(
    runs: Sequence[PlannedRun],
    jobs: int | None = None,
    threads: int | None = None,
    *,
    cores: int | None = None,
    memory: float | None = None,
) -> Allocation:
    """Choose the allocation with the shortest total time, within the cores and the memory of the machine.

    Many small runs are executed concurrently with one thread each; few large runs, or one that dominates, get more
    threads.

    Args:
        runs: those that remain to be executed.
        jobs, threads: prescribed values, kept even beyond the number of cores.
        cores: number of cores (default: all that this process may use).
        memory: bytes (default: memory of the machine).

    Raises UsageError if a prescribed value is out of range.
    """
    require_count("jobs", jobs)
    require_count("threads", threads)
    cores = cores or available_cores()
    budget = MEMORY_SHARE * (memory or machine_memory())
    candidates = []
    for per_run in [threads] if threads else range(1, cores + 1):
        concurrent = jobs or max(min(cores // per_run, len(runs), _fitting(runs, budget)), 1)
        if jobs is None or threads is not None or per_run == 1 or jobs * per_run <= cores:
            candidates.append(Allocation(concurrent, per_run))
    return min(candidates, key=lambda candidate: (_total_cost(runs, candidate), candidate.threads))


def makespan(durations: Sequence[float], jobs: int) -> float:
    """Time until the last of the tasks ends if `jobs` run concurrently, the longest first."""
    ends = [0.0] * jobs
    for duration in sorted(durations, reverse=True):
        heapq.heapreplace(ends, ends[0] + duration)
    return max(ends)


def estimate_seconds(runs: Sequence[PlannedRun], threads: int) -> list[float]:
    """Estimated seconds of each run, from the measured speed of the median run of each kernel variant."""
    variants: dict[tuple[object, ...], list[PlannedRun]] = {}
    for run in sorted(runs, key=lambda run: run.work):
        variants.setdefault(kernel_variant(run), []).append(run)
    pace = {key: estimate(group[len(group) // 2].case, threads).ns_per_point_step for key, group in variants.items()}
    return [1e-9 * pace[kernel_variant(run)] * run.work for run in runs]


def _fitting(runs: Sequence[PlannedRun], budget: float) -> int:
    """How many of the largest runs fit into the memory together."""
    taken, fitting = 0.0, 0
    for size in sorted((memory_bytes(run.discretization) + PROCESS_BYTES for run in runs), reverse=True):
        taken += size
        fitting += taken <= budget
    return fitting


def _total_cost(runs: Sequence[PlannedRun], allocation: Allocation) -> float:
    """Time until the last run ends, in the unit of the costs."""
    useful = (
        min(float(allocation.threads), max(run.discretization.most_points / POINTS_PER_THREAD, 1.0)) for run in runs
    )
    costs = [run.cost / threads**SPEEDUP_EXPONENT for run, threads in zip(runs, useful, strict=True)]
    return makespan(costs, allocation.jobs)
