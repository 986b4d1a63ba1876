"""Peak performance of this machine, measured: memory bandwidth and rate of fused multiply-adds."""

# Compiled functions take what Numba infers.
# mypy: allow-untyped-defs
# ruff: noqa: ANN001

from __future__ import annotations

import time
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from mpmcol.mpm.grid import NODE
from mpmcol.mpm.jit import kernel, prange
from mpmcol.mpm.lanes import RECORD_SIZE
from mpmcol.mpm.particles import aligned_zeros
from mpmcol.mpm.simd import LANES, fma, load, reduce_sum, splat, store
from mpmcol.mpm.threads import set_threads

BYTES = 8
BLOCKS, ROUNDS = 64, 20_000
REPEATS = 9
# Operations of eight lanes per point (multiplications, additions, comparisons, selections), counted by hand in the
# kernels: at the nodes of the stencil, then the rest, then one eighth of what is done for eight points at once.
POINT_OPERATIONS = {
    2: {"p2g": 9 * 2 + 28 + 72 // 8, "g2p": 9 * 2 + 24 + 58 // 8, "stress": 148 // 8},
    3: {"p2g": 27 * 2 + 62 + 108 // 8, "g2p": 27 * 2 + 55 + 87 // 8, "stress": 379 // 8},
}
NODE_OPERATIONS = 29  # of the grid update
# Memory traffic: times that the record of a point, and that of a node, is read or written. `stress` follows G2P of the
# same tile, whose points are then in the caches; so does P2G in the whole step.
RECORDS = {"update_grid": 0, "update_points": 2, "p2g": 1, "g2p": 2, "stress": 0, "step": 2}
NODE_RECORDS = {"update_grid": 2 + 1, "update_points": 1 + 2, "p2g": 2, "g2p": 1, "stress": 0, "step": 6}


class Machine(NamedTuple):
    """Peak performance with some number of threads."""

    bandwidth: float  # bytes per ns (GB/s), reading and writing
    vector_rate: float  # multiply-adds of eight lanes per ns

    def bounds(self, dimension: int, nodes_per_point: float) -> dict[str, float]:
        """Lower bound of the time of each phase, ns per point: that of its memory traffic or of its arithmetic."""
        operations: dict[str, float] = dict(POINT_OPERATIONS[dimension])
        operations["update_grid"] = NODE_OPERATIONS * nodes_per_point
        operations["update_points"] = sum(POINT_OPERATIONS[dimension].values())
        operations["step"] = operations["update_points"] + operations["update_grid"]
        traffic = {
            phase: BYTES * (RECORDS[phase] * RECORD_SIZE[dimension] + NODE_RECORDS[phase] * NODE * nodes_per_point)
            for phase in RECORDS
        }
        return {phase: max(traffic[phase] / self.bandwidth, operations[phase] / self.vector_rate) for phase in RECORDS}


def measure_machine(threads: int, working_set: int) -> Machine:
    """Best of several measurements, on as many bytes as the points and nodes of a case take."""
    set_threads(threads)
    n = max(working_set // (BYTES * LANES), 1) * LANES
    array = aligned_zeros(n)
    seconds = _best(lambda: _stream(array))
    sums = np.zeros(BLOCKS)
    chains = {5: _five_chains, 8: _eight_chains}
    rate = max(
        count * BLOCKS * ROUNDS / _best(partial(multiply_add, sums, 0.999, ROUNDS))
        for count, multiply_add in chains.items()
    )
    return Machine(2.0 * n * BYTES / seconds * 1e-9, rate * 1e-9)


def _best(action: Any) -> float:
    """Shortest time of several calls of an action after a first one that compiles it, s."""
    action()
    times = []
    for _ in range(REPEATS):
        started = time.perf_counter()
        action()
        times.append(time.perf_counter() - started)
    return min(times)


@kernel
def _stream(array):
    """Update in place, as of points: a copy would also read what it overwrites. Reads, writes: array. Eq. none."""
    for k in prange(len(array) // LANES):
        store(array, k * LANES, load(array, k * LANES) * 0.5)


@kernel
def _eight_chains(sums, factor, rounds):
    """Eight independent chains, enough to hide the latency. Reads: factor. Writes: sums. Eq. none."""
    for block in prange(len(sums)):
        f, s = splat(factor), splat(1.0)
        a, b, c, d, e, g, h, i = s, s + s, s * 3.0, s * 4.0, s * 5.0, s * 6.0, s * 7.0, s * 8.0
        for _ in range(rounds):
            a, b, c, d = fma(a, f, s), fma(b, f, s), fma(c, f, s), fma(d, f, s)
            e, g, h, i = fma(e, f, s), fma(g, f, s), fma(h, f, s), fma(i, f, s)
        sums[block] = reduce_sum(a + b + c + d + e + g + h + i)


@kernel
def _five_chains(sums, factor, rounds):
    """Five chains: with AVX2 ten of the sixteen registers, which do not hold eight. As `_eight_chains`."""
    for block in prange(len(sums)):
        f, s = splat(factor), splat(1.0)
        a, b, c, d, e = s, s + s, s * 3.0, s * 4.0, s * 5.0
        for _ in range(rounds):
            a, b, c, d, e = fma(a, f, s), fma(b, f, s), fma(c, f, s), fma(d, f, s), fma(e, f, s)
        sums[block] = reduce_sum(a + b + c + d + e)
