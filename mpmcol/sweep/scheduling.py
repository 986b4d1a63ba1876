"""How many points run at a time, and with how many threads each."""

from __future__ import annotations

import heapq
import os
from collections.abc import Sequence
from dataclasses import dataclass

from mpmcol.setup.memory import memory_bytes
from mpmcol.sweep.runs import PlannedRun

POINTS_PER_THREAD = 10_000  # with fewer a further thread gains nothing
GAIN = 0.9  # threads are as fast as threads**GAIN
MEMORY_SHARE = 0.8  # of the machine's
BYTES_OF_PROCESS = 250e6  # interpreter, compiler and kernels


@dataclass(frozen=True)
class Allocation:
    """Points at a time and threads of each."""

    jobs: int
    threads: int

    def __str__(self) -> str:
        points = "1 point" if self.jobs == 1 else f"{self.jobs} points"
        return f"{points} at a time, {self.threads} thread{'s' if self.threads > 1 else ' each'}"


def cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def allocate(
    points: Sequence[PlannedRun],
    jobs: int | None = None,
    threads: int | None = None,
    available: int | None = None,
    memory: float | None = None,
) -> Allocation:
    """The shares with which all points are done soonest, within the cores and the memory of the machine.

    Many small points run side by side with one thread each; few large ones, or one that is larger than all others
    together, get more threads.

    Args:
        points: those that are still to run.
        jobs, threads: keep to these, even beyond the number of cores.
        available: cores (default: all that this process may use).
        memory: bytes (default: that of the machine).
    """
    count = available or cores()
    room = MEMORY_SHARE * (memory or os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    choices = []
    for used in [threads] if threads else range(1, count + 1):
        side_by_side = jobs or max(min(count // used, len(points), _fitting(points, room)), 1)
        if jobs is None or threads is not None or used == 1 or jobs * used <= count:
            choices.append(Allocation(side_by_side, used))
    return min(choices, key=lambda shares: (_duration(points, shares), shares.threads))


def _fitting(points: Sequence[PlannedRun], room: float) -> int:
    """How many of the largest points fit into the memory together."""
    taken, fitting = 0.0, 0
    for size in sorted((memory_bytes(point.discretization) + BYTES_OF_PROCESS for point in points), reverse=True):
        taken += size
        fitting += taken <= room
    return fitting


def finish(durations: Sequence[float], jobs: int) -> float:
    """When the last of tasks ends if `jobs` run side by side, the longest begun first."""
    ends = [0.0] * jobs
    for duration in sorted(durations, reverse=True):
        heapq.heapreplace(ends, ends[0] + duration)
    return max(ends)


def _duration(points: Sequence[PlannedRun], shares: Allocation) -> float:
    """When the last point ends, in units of work."""
    useful = (min(float(shares.threads), max(p.discretization.most_points / POINTS_PER_THREAD, 1.0)) for p in points)
    return finish([point.work / used**GAIN for point, used in zip(points, useful, strict=True)], shares.jobs)
