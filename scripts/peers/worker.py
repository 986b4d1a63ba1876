"""Run one code on one problem in a separate process: Taichi, Warp and Numba are set up once per process.

    python -m scripts.peers.worker CODE PRECISION MODEL POINTS THREADS

Reads numbers of steps from standard input, one per line, and answers each with a line of JSON.
"""

from __future__ import annotations

import json
import math
import os
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from mpmcol.bench.cases import make_solver
from mpmcol.mpm.threads import set_threads
from scripts.peers.problem import from_solver

Advance = Callable[[int], None]
State = Callable[[], dict[str, np.ndarray]]


def start_mpmcol(model: str, points: int, threads: int) -> tuple[int, Advance, State]:
    """The solver of mpmcol."""
    set_threads(threads)
    solver = make_solver(model, points)

    def advance(steps: int) -> None:
        end = solver.steps + steps
        while solver.steps < end:
            solver.advance(math.inf, end - solver.steps)

    return len(solver.points), advance, lambda: {"v": solver.points.v, "m": solver.points.m}


def start_taichi(code: str, precision: str, model: str, points: int, threads: int) -> tuple[int, Advance, State]:
    """One of the Taichi codes."""
    import taichi as ti

    from scripts.peers.example import Example
    from scripts.peers.optimized import Optimized

    problem, make = from_solver(make_solver(model, points)), {"optimized": Optimized, "example": Example}[code]
    ti.init(
        arch=ti.cpu, cpu_max_num_threads=threads, default_fp=getattr(ti, precision), log_level=ti.ERROR, **make.TAICHI
    )
    peer = make(problem)

    def advance(steps: int) -> None:
        peer.advance(steps)
        ti.sync()

    return len(problem.x), advance, peer.state


def start_warp(precision: str, model: str, points: int) -> tuple[int, Advance, State]:
    """The Warp code, always on one thread."""
    from scripts.peers.warp_example import WarpExample

    peer = WarpExample(from_solver(make_solver(model, points)), precision)
    return peer.n, peer.advance, peer.state


def kinetic_energy(state: dict[str, np.ndarray]) -> float:
    """Kinetic energy of all points, J (per metre in 2D), to verify that all codes simulate the same."""
    return float(0.5 * np.sum(state["m"].astype(float) * np.sum(state["v"].astype(float) ** 2, axis=1)))


def main() -> None:
    code, precision, model, points, threads = sys.argv[1:]
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # Taichi prints a banner

    def answer(**what: Any) -> None:
        print(json.dumps(what), file=answers)

    if code == "mpmcol":
        n, advance, state = start_mpmcol(model, int(points), int(threads))
    elif code == "warp":
        n, advance, state = start_warp(precision, model, int(points))
    else:
        n, advance, state = start_taichi(code, precision, model, int(points), int(threads))
    advance(1)  # compiles
    answer(points=n)
    for line in sys.stdin:
        started = time.perf_counter()
        advance(int(line))
        seconds = time.perf_counter() - started
        answer(seconds=seconds, kinetic_energy=kinetic_energy(state()))


if __name__ == "__main__":
    main()
