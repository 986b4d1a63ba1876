"""Timing of one benchmark case: vector kernels and plain loops alternate, so that both see the same machine load."""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from mpmcol.bench import timed
from mpmcol.bench.cases import make_solver
from mpmcol.bench.machine import measure_machine
from mpmcol.bench.plain_loops.common import PlainState, plain_state
from mpmcol.bench.report import BenchmarkCase, Row, Spread
from mpmcol.mpm.grid import NODE
from mpmcol.mpm.lanes import LANES, RECORD_SIZE
from mpmcol.mpm.particles import aligned_zeros
from mpmcol.mpm.solver import Solver
from mpmcol.mpm.threads import set_threads

SORT_INTERVAL = 50  # steps between sorts; 50 to 100 in a fast collapse


class Effort(NamedTuple):
    """How long to measure: steps before the timing, then rounds of steps of each kind in turn."""

    warm_up: int
    rounds: int
    point_steps: int  # points times steps in a round

    def steps(self, points: int) -> int:
        """Steps in a round."""
        return min(max(self.point_steps // points, 3), 50)


FULL = Effort(120, 9, 400_000)
QUICK = Effort(5, 3, 10_000)


def vector_steps(solver: Solver, steps: int) -> np.ndarray:
    """Step a sorted solver without sorting it again; seconds per phase of VECTOR_PHASES (steps, 3)."""
    column, base, *_ = solver.bodies
    times = np.zeros((steps, len(timed.VECTOR_PHASES) + 1))
    timed.make_vector_steps(solver.points.dimension, column.law, base.law)(solver.state(), times)
    return np.diff(times, axis=1)


def plain_steps(solver: Solver, state: PlainState, steps: int) -> np.ndarray:
    """Step the plain copy `state` of a solver; seconds per phase of PLAIN_PHASES (steps, 5)."""
    column, base, *_ = solver.bodies
    times = np.zeros((steps, len(timed.PLAIN_PHASES) + 1))
    timed.make_plain_steps(solver.points.dimension, column.law, base.law)(state, times)
    return np.diff(times, axis=1)


def measure_case(model: str, points: int, per_axis: int, threads: int, effort: Effort) -> BenchmarkCase:
    """Time every phase and the whole step of one case with `per_axis` points per cell and axis."""
    threads = set_threads(threads)
    solver = make_solver(model, points, per_axis)
    advance(solver, effort.warm_up)
    solver.sort()
    plain_copy, steps = plain_state(solver), effort.steps(len(solver.points))
    vector_steps(solver, 1), plain_steps(solver, plain_copy, 1), transfer_seconds(solver, 1)
    vector, plain = [], []
    for _ in range(effort.rounds):
        vector.append(_vector_phases(vector_steps(solver, steps), *transfer_seconds(solver, 5)))
        plain.append(_plain_phases(plain_steps(solver, plain_copy, steps)))
    memory, python = bytes_per_point(solver), _python_seconds(solver, steps, effort.rounds)
    sort = [_seconds(solver.sort) / SORT_INTERVAL for _ in range(effort.rounds)]
    scale = 1e9 / len(solver.points)
    nodes = _active_nodes(solver)
    machine = measure_machine(threads, solver.points.rows.nbytes + 2 * nodes * NODE * 8)
    bounds = machine.bounds(solver.points.dimension, nodes / len(solver.points))
    rows = [_paired(name, vector, plain, scale, bounds[name]) for name in vector[0]]
    rows.append(Row("sort", Spread.of([scale * value for value in sort]), None, None, None))
    return BenchmarkCase(
        model=model,
        points=points,
        per_axis=per_axis,
        n_points=len(solver.points),
        threads=threads,
        rows=tuple(rows),
        bytes_per_point=memory,
        python_us=1e6 * python,
        bandwidth=machine.bandwidth,
        vector_rate=machine.vector_rate,
    )


def _vector_phases(times: np.ndarray, p2g: float, g2p: float) -> dict[str, float]:
    """Median seconds of each phase; the stress update is the difference of `update_points` and the transfers alone."""
    phases = dict(zip(timed.VECTOR_PHASES, np.median(times, axis=0).tolist(), strict=True))
    phases.pop("sums")
    stress = phases["update_points"] - p2g - g2p
    return {**phases, "p2g": p2g, "g2p": g2p, "stress": stress, "step": _step(times)}


def _plain_phases(times: np.ndarray) -> dict[str, float]:
    """Median seconds of each phase; the nodes are cleared in a loop of their own."""
    phases = dict(zip(timed.PLAIN_PHASES, np.median(times, axis=0).tolist(), strict=True))
    update_points = phases["p2g"] + phases["g2p"] + phases["stress"]
    update_grid = phases["update_grid"] + phases.pop("clear")
    return {**phases, "update_grid": update_grid, "update_points": update_points, "step": _step(times)}


def _step(times: np.ndarray) -> float:
    return float(np.median(times.sum(axis=1)))


def _paired(
    name: str, vector: list[dict[str, float]], plain: list[dict[str, float]], scale: float, bound: float
) -> Row:
    v, p = ([scale * round_[name] for round_ in kind] for kind in (vector, plain))
    return Row(name, Spread.of(v), Spread.of(p), statistics.median(np.divide(p, v).tolist()), bound)


def transfer_seconds(solver: Solver, repeats: int) -> tuple[float, float]:
    """Median seconds of P2G and of G2P alone, on a copy of the points."""
    d, rows, times = solver.points.dimension, solver.points.rows, np.zeros((repeats, 3))
    copy = aligned_zeros(rows.size + LANES * RECORD_SIZE[d])[: rows.size]
    copy[:] = rows.reshape(-1)
    timed.make_transfers(d)(solver.state(), copy, times)
    p2g, g2p = np.median(np.diff(times, axis=1), axis=0)
    return float(p2g), float(g2p)


def bytes_per_point(solver: Solver) -> float:
    """Bytes of all arrays that a run allocates and touches, over its points; those of the sort included."""
    if solver.tiles is None:
        solver.sort()
    state, n = solver.state(), len(solver.points)
    sort = n * (2 * 4 + 1)  # tile (then final order), order by tile, bucket
    nodes = 2 * _active_nodes(solver) * NODE * 8  # of two grids
    reports = (state.node_report, state.tile_report)
    arrays = (state.rows, *state.tiles, *solver.buffers, *reports, state.grid.fixed)
    return (sum(array.nbytes for array in arrays) + nodes + sort) / n


def _active_nodes(solver: Solver) -> int:
    return len(solver.state().tiles.active) * solver.grid.tile_doubles // NODE


def _python_seconds(solver: Solver, steps: int, rounds: int) -> float:
    """Additional time of a step if every step is a call from Python, s."""
    extra = []
    for _ in range(rounds):
        many = _seconds(lambda: advance(solver, steps))
        single = sum(_seconds(lambda: advance(solver, 1)) for _ in range(steps))
        extra.append((single - many) / steps)
    return float(np.median(extra))


def advance(solver: Solver, steps: int) -> None:
    """Take this number of steps; a call of the solver may end earlier."""
    end = solver.steps + steps
    while solver.steps < end:
        solver.advance(math.inf, end - solver.steps)


def step_seconds(solver: Solver, steps: int) -> float:
    """Duration of the next steps, s."""
    return _seconds(lambda: advance(solver, steps))


def _seconds(action: Callable[[], object]) -> float:
    started = time.perf_counter()
    action()
    return time.perf_counter() - started
