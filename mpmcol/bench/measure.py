"""Timing of one scene: vector kernels and plain loops in turn, so that both see the same load on the machine."""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from mpmcol.bench import timed
from mpmcol.bench.machine import measure_machine
from mpmcol.bench.plain_loops.common import PlainGrid, PlainPoints, plain_grid, plain_points
from mpmcol.bench.report import Row, Scene, Spread
from mpmcol.bench.scenes import make_solver
from mpmcol.mpm.grid import NODE, Tiles
from mpmcol.mpm.jit import set_threads
from mpmcol.mpm.kernels.grid_update import NODE_REPORT
from mpmcol.mpm.particles import Points
from mpmcol.mpm.solver import Solver

SORT_INTERVAL = 50  # steps; a fast collapse sorts every 50 to 100 steps


class Effort(NamedTuple):
    """How long to look: steps before the clock starts, then rounds of steps of each kind in turn."""

    warm_up: int
    rounds: int
    point_steps: int  # points times steps in a round

    def steps(self, points: int) -> int:
        """Steps in a round."""
        return min(max(self.point_steps // points, 3), 50)


FULL = Effort(120, 9, 400_000)
QUICK = Effort(5, 3, 10_000)


class Twin(NamedTuple):
    """The plain loops' copy of a solver's state."""

    points: PlainPoints
    grid: PlainGrid
    tiles: Tiles
    reports: tuple[np.ndarray, np.ndarray]
    clock: np.ndarray


def make_twin(solver: Solver) -> Twin:
    """Copy a solver that has just been sorted."""
    tiles = _tiles(solver)
    reports = np.zeros((len(tiles.active), NODE_REPORT)), np.zeros((len(tiles.split), 2))
    return Twin(plain_points(solver.points), plain_grid(solver.grid, tiles), tiles, reports, solver.clock.copy())


def vector_steps(solver: Solver, steps: int) -> np.ndarray:
    """Step a sorted solver without sorting it again; seconds per phase of VECTOR_PHASES (steps, 5)."""
    column, base = solver.bodies
    times = np.zeros((steps, len(timed.VECTOR_PHASES) + 1))
    timed.make_vector_steps(solver.points.dimension, column.law, base.law)(
        solver.points.rows.reshape(-1), solver.grid, _tiles(solver), solver.settings, column.params, base.params,
        column.wave_speed2, base.wave_speed2, solver.smallest_mass, solver._reports, solver.clock, solver.ledger, times,
    )  # fmt: skip
    return np.diff(times, axis=1)


def plain_steps(solver: Solver, twin: Twin, steps: int) -> np.ndarray:
    """Step the plain copy of `solver`; seconds per phase of PLAIN_PHASES (steps, 5)."""
    column, base = solver.bodies
    times = np.zeros((steps, len(timed.PLAIN_PHASES) + 1))
    timed.make_plain_steps(solver.points.dimension, column.law, base.law)(
        twin.points, twin.grid, twin.tiles, solver.settings, column.params, base.params,
        column.wave_speed2, base.wave_speed2, solver.smallest_mass, twin.reports, twin.clock, times,
    )  # fmt: skip
    return np.diff(times, axis=1)


def measure_scene(model: str, points: int, threads: int, effort: Effort) -> Scene:
    """Time every phase and the whole step of one scene with so many threads."""
    threads = set_threads(threads)
    solver = make_solver(model, points)
    _advance(solver, effort.warm_up)
    solver.sort()
    twin, steps = make_twin(solver), effort.steps(len(solver.points))
    vector_steps(solver, 1), plain_steps(solver, twin, 1), _gather(solver, 1)
    vector, plain = [], []
    for _ in range(effort.rounds):
        vector.append(_vector_phases(vector_steps(solver, steps), _gather(solver, 5)))
        plain.append(_plain_phases(plain_steps(solver, twin, steps)))
    memory, python = bytes_per_point(solver), _python_seconds(solver, steps, effort.rounds)
    sort = [_seconds(solver.sort) / SORT_INTERVAL for _ in range(effort.rounds)]
    scale = 1e9 / len(solver.points)
    rows = [_paired(name, vector, plain, scale) for name in vector[0]]
    rows.append(Row("sort", Spread.of([scale * value for value in sort]), None, None))
    nodes = _active_nodes(solver) / len(solver.points)
    machine = measure_machine(threads, solver.points.rows.nbytes + _active_nodes(solver) * NODE * 8)
    bound = machine.bound(solver.points.dimension, nodes)
    return Scene(model, points, len(solver.points), threads, tuple(rows), memory, 1e6 * python, *machine, bound)


def _vector_phases(times: np.ndarray, gather: float) -> dict[str, float]:
    """Median seconds of each phase; the stress is what G2P leaves of `update_points`."""
    phases = dict(zip(timed.VECTOR_PHASES, np.median(times, axis=0).tolist(), strict=True))
    phases.pop("sums")
    return {**phases, "g2p": gather, "stress": phases["update_points"] - gather, "step": _step(times)}


def _plain_phases(times: np.ndarray) -> dict[str, float]:
    """Median seconds of each phase."""
    phases = dict(zip(timed.PLAIN_PHASES, np.median(times, axis=0).tolist(), strict=True))
    return {**phases, "update_points": phases["g2p"] + phases["stress"], "step": _step(times)}


def _step(times: np.ndarray) -> float:
    return float(np.median(times.sum(axis=1)))


def _paired(name: str, vector: list[dict[str, float]], plain: list[dict[str, float]], scale: float) -> Row:
    v, p = ([scale * round_[name] for round_ in kind] for kind in (vector, plain))
    return Row(name, Spread.of(v), Spread.of(p), statistics.median(np.divide(p, v).tolist()))


def _gather(solver: Solver, repeats: int) -> float:
    """Median seconds of G2P alone, on a copy of the points."""
    spare, tiles, times = Points(len(solver.points), solver.points.dimension), _tiles(solver), np.zeros((repeats, 2))
    spare.rows[:] = solver.points.rows
    report = solver._reports[1]
    gather_alone = timed.make_gather_alone(spare.dimension)
    gather_alone(spare.rows.reshape(-1), solver.grid, tiles, solver.settings, solver.dt, report, times)
    return float(np.median(np.diff(times, axis=1)))


def bytes_per_point(solver: Solver) -> float:
    """Bytes of all arrays that a run holds and touches, over its points; the sort's own arrays included."""
    tiles, n = _tiles(solver), len(solver.points)
    sort = n * (2 * 4 + 1)  # tile (then final order), order by tile, bucket
    nodes = _active_nodes(solver) * NODE * 8
    arrays = (solver.points.rows, *tiles, *solver._scratch, *solver._reports, solver.grid.fixed)
    return (sum(array.nbytes for array in arrays) + nodes + sort) / n


def _active_nodes(solver: Solver) -> int:
    return len(_tiles(solver).active) * solver.grid.tile_doubles // NODE


def _python_seconds(solver: Solver, steps: int, rounds: int) -> float:
    """What a step costs more if Python is asked for every single one, s."""
    extra = []
    for _ in range(rounds):
        many = _seconds(lambda: _advance(solver, steps))
        single = sum(_seconds(lambda: _advance(solver, 1)) for _ in range(steps))
        extra.append((single - many) / steps)
    return float(np.median(extra))


def _advance(solver: Solver, steps: int) -> None:
    end = solver.steps + steps
    while solver.steps < end:
        solver.advance(math.inf, end - solver.steps)


def _seconds(action: Callable[[], object]) -> float:
    started = time.perf_counter()
    action()
    return time.perf_counter() - started


def _tiles(solver: Solver) -> Tiles:
    if solver.tiles is None:
        solver.sort()
    assert solver.tiles is not None
    return solver.tiles
