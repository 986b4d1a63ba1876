"""What this machine can do at best: memory bandwidth and the rate of fused multiply-adds, measured by itself."""

# Compiled functions take what Numba infers.
# mypy: allow-untyped-defs
# ruff: noqa: ANN001

from __future__ import annotations

import time
from typing import Any, NamedTuple

import numpy as np

from mpmcol.mpm.grid import NODE
from mpmcol.mpm.jit import kernel, prange, set_threads
from mpmcol.mpm.lanes import RECORD_SIZE
from mpmcol.mpm.particles import aligned_zeros
from mpmcol.mpm.simd import LANES, fma, load, reduce_sum, splat, store

BYTES = 8
CHAINS, BLOCKS, ROUNDS = 8, 64, 20_000
REPEATS = 9
# Multiplications and additions of eight lanes, counted by hand in the kernels' source. P2G and G2P of a point: those at
# the nodes of the stencil, then the rest; an eighth of those of eight points' stress with Mohr-Coulomb. The weights,
# some 20 operations for all axes of a point, are not counted.
POINT_OPERATIONS = {2: (9 * 2 + 23) + (9 * 2 + 26) + 148 // 8, 3: (27 * 2 + 49) + (27 * 2 + 60) + 379 // 8}
NODE_OPERATIONS = 25
# Lines of a node that each phase reads or writes: clear, P2G (both), grid update (both), G2P.
NODE_LINES = 1 + 2 + 2 + 1


class Machine(NamedTuple):
    """Measured with some number of threads."""

    bandwidth: float  # bytes per ns (GB/s), reading and writing
    vector_rate: float  # multiply-adds of eight lanes per ns

    def bound(self, dimension: int, nodes_per_point: float) -> float:
        """Least time of a step, ns per point: no faster than its traffic, nor than its arithmetic.

        Traffic: the record is read by P2G, and read and written by G2P and the stress update.
        """
        traffic = 3 * RECORD_SIZE[dimension] * BYTES + NODE_LINES * NODE * BYTES * nodes_per_point
        operations = POINT_OPERATIONS[dimension] + NODE_OPERATIONS * nodes_per_point
        return max(traffic / self.bandwidth, operations / self.vector_rate)


def measure_machine(threads: int, working_set: int) -> Machine:
    """The best of a few attempts with so many threads, on as many bytes as a scene's points and nodes take."""
    set_threads(threads)
    n = max(working_set // (2 * BYTES * LANES), 1) * LANES
    source, target = aligned_zeros(n), aligned_zeros(n)
    seconds = _best(lambda: _stream(source, target))
    sums = np.zeros(BLOCKS)
    rate = BLOCKS * ROUNDS * CHAINS / _best(lambda: _multiply_add(sums, 0.999, ROUNDS))
    return Machine(2.0 * n * BYTES / seconds * 1e-9, rate * 1e-9)


def _best(action: Any) -> float:
    """Least seconds of an action, which is compiled before."""
    action()
    times = []
    for _ in range(REPEATS):
        started = time.perf_counter()
        action()
        times.append(time.perf_counter() - started)
    return min(times)


@kernel
def _stream(source, target):
    """Reads: source. Writes: target. Eq. none."""
    for k in prange(len(source) // LANES):
        store(target, k * LANES, load(source, k * LANES) * 0.5)


@kernel
def _multiply_add(sums, factor, rounds):
    """Eight independent chains, enough to hide the latency. Reads: factor. Writes: sums. Eq. none."""
    for block in prange(len(sums)):
        f, s = splat(factor), splat(1.0)
        a, b, c, d, e, g, h, i = s, s + s, s * 3.0, s * 4.0, s * 5.0, s * 6.0, s * 7.0, s * 8.0
        for _ in range(rounds):
            a, b, c, d = fma(a, f, s), fma(b, f, s), fma(c, f, s), fma(d, f, s)
            e, g, h, i = fma(e, f, s), fma(g, f, s), fma(h, f, s), fma(i, f, s)
        sums[block] = reduce_sum(a + b + c + d + e + g + h + i)
