"""One code on one scene in a process of its own, stepping on demand: Taichi and Numba are set up once per process.

    python -m scripts.peers.worker CODE PRECISION MODEL POINTS THREADS

Answers every line on the standard input, a number of steps, with one line of JSON.
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

from mpmcol.bench.scenes import make_solver
from mpmcol.mpm.jit import set_threads
from scripts.peers.scene import from_solver

Advance = Callable[[int], None]
State = Callable[[], dict[str, np.ndarray]]


def start_mpmcol(model: str, points: int, threads: int) -> tuple[int, Advance, State]:
    """mpmcol's own step, many per call."""
    set_threads(threads)
    solver = make_solver(model, points)

    def advance(steps: int) -> None:
        end = solver.steps + steps
        while solver.steps < end:
            solver.advance(math.inf, end - solver.steps)

    return len(solver.points), advance, lambda: {"v": solver.points.v, "m": solver.points.m}


def start_taichi(code: str, precision: str, model: str, points: int, threads: int) -> tuple[int, Advance, State]:
    """One of the Taichi versions."""
    import taichi as ti

    from scripts.peers.best import Best
    from scripts.peers.example import Example

    scene, make = from_solver(make_solver(model, points)), {"best": Best, "example": Example}[code]
    ti.init(
        arch=ti.cpu, cpu_max_num_threads=threads, default_fp=getattr(ti, precision), log_level=ti.ERROR, **make.TAICHI
    )
    peer = make(scene)

    def advance(steps: int) -> None:
        peer.advance(steps)
        ti.sync()

    return len(scene.x), advance, peer.state


def kinetic_energy(state: dict[str, np.ndarray]) -> float:
    """Of all points, J (per metre in 2D): tells whether all codes simulate the same."""
    return float(0.5 * np.sum(state["m"].astype(float) * np.sum(state["v"].astype(float) ** 2, axis=1)))


def main() -> None:
    code, precision, model, points, threads = sys.argv[1:]
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # Taichi prints its name

    def answer(**what: Any) -> None:
        print(json.dumps(what), file=answers)

    if code == "mpmcol":
        n, advance, state = start_mpmcol(model, int(points), int(threads))
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
