"""Strong and weak scaling of the step: numbers of threads alternate, so that all see the same machine load."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mpmcol.bench.cases import make_solver
from mpmcol.bench.measure import QUICK, Effort, advance, vector_steps
from mpmcol.bench.scaling_report import ScalingCase, ScalingRow, measured_row, predicted_row
from mpmcol.mpm.grid import Tiles
from mpmcol.mpm.solver import Solver
from mpmcol.mpm.threads import set_threads

KINDS = ("strong", "weak")
MODELLED = (4, 8, 16, 32, 64)  # numbers of threads in the table whether this machine has as many cores or not
MOST_POINTS = 2_000_000  # of a weak case that is not measured
SCALING_FULL = Effort(120, 61, 100_000)  # short rounds: background load disturbs some of them, not all
SCALING_QUICK = QUICK


class Threads(NamedTuple):
    """Numbers of threads, in order: those to measure, and those of which only the model is computed."""

    measured: tuple[int, ...]
    modelled: tuple[int, ...]


def choose_threads(requested: tuple[int, ...] | None, available: int) -> Threads:
    """One thread and those requested, measured up to `available`; by default powers of two, all cores and MODELLED."""
    powers = tuple(2**k for k in range(available.bit_length()))
    counts = sorted({1, *(requested or (*powers, available, *MODELLED))})
    return Threads(tuple(n for n in counts if n <= available), tuple(n for n in counts if n > available))


def measure_scaling(model: str, kind: str, points: int, threads: Threads, effort: Effort) -> ScalingCase:
    """Time one case with each number of threads, and compute the model for all of them."""
    sizes = {n: points * (n if kind == "weak" else 1) for n in (*threads.measured, *threads.modelled)}
    released = {sizes[n]: ReleasedCase(model, sizes[n], effort) for n in threads.measured}
    cases = {n: released[sizes[n]] for n in threads.measured}
    times = alternate(cases, effort)
    rows = [measured_row(n, case.n_points, case.tiles, times[n], times[1]) for n, case in cases.items()]
    for n in threads.modelled:
        if sizes[n] in released:
            rows.append(predicted_row(n, released[sizes[n]].n_points, released[sizes[n]].tiles))
        elif sizes[n] <= MOST_POINTS:
            rows.append(_predict(n, make_solver(model, sizes[n])))
    return ScalingCase(model, kind, points, tuple(rows))


class ReleasedCase:
    """A case some steps after its release, whose next steps can be repeated."""

    def __init__(self, model: str, points: int, effort: Effort) -> None:
        set_threads(None)
        self.solver = make_solver(model, points)
        advance(self.solver, effort.warm_up)
        self.solver.sort()
        self.rows, self.clock = self.solver.points.rows.copy(), self.solver.clock.copy()
        self.step_seconds(1, 1)  # compiles

    @property
    def n_points(self) -> int:
        """Number of points."""
        return len(self.solver.points)

    @property
    def tiles(self) -> Tiles:
        """Order of the points."""
        assert self.solver.tiles is not None
        return self.solver.tiles

    def step_seconds(self, threads: int, steps: int) -> np.ndarray:
        """Times of steps (steps,), s. The same steps are repeated, so that each number of threads has the same work."""
        set_threads(threads)
        self.solver.points.rows[...], self.solver.clock[...] = self.rows, self.clock
        return vector_steps(self.solver, steps).sum(axis=1)


def alternate(cases: dict[int, ReleasedCase], effort: Effort) -> dict[int, np.ndarray]:
    """Times of the steps of each round (rounds, steps) by number of threads, ns per point and step."""
    times: dict[int, list[np.ndarray]] = {n: [] for n in cases}
    for _ in range(effort.rounds):
        for n, case in cases.items():
            times[n].append(1e9 / case.n_points * case.step_seconds(n, effort.steps(case.n_points)))
    return {n: np.array(rounds) for n, rounds in times.items()}


def _predict(threads: int, solver: Solver) -> ScalingRow:
    solver.sort()
    assert solver.tiles is not None
    return predicted_row(threads, len(solver.points), solver.tiles)
