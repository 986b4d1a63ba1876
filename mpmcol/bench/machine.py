"""Peak performance of this machine, measured: memory bandwidth and rate of fused multiply-adds."""

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
# Multiplications and additions of eight lanes per point, counted by hand in the kernels: P2G and G2P (at the nodes of
# the stencil, then the rest), and one eighth of the stress update of eight points with Mohr-Coulomb. The weights, some
# 20 operations per point, are not counted.
POINT_OPERATIONS = {2: (9 * 2 + 23) + (9 * 2 + 26) + 148 // 8, 3: (27 * 2 + 49) + (27 * 2 + 60) + 379 // 8}
NODE_OPERATIONS = 25
# Cache lines read or written per node: clear, P2G (both), grid update (both), G2P.
NODE_LINES = 1 + 2 + 2 + 1


class Machine(NamedTuple):
    """Peak performance with some number of threads."""

    bandwidth: float  # bytes per ns (GB/s), reading and writing
    vector_rate: float  # multiply-adds of eight lanes per ns

    def bound(self, dimension: int, nodes_per_point: float) -> float:
        """Lower bound of the time of a step, ns per point: that of its memory traffic or of its arithmetic.

        The record of a point is read by P2G, and read and written by G2P and the stress update.
        """
        traffic = 3 * RECORD_SIZE[dimension] * BYTES + NODE_LINES * NODE * BYTES * nodes_per_point
        operations = POINT_OPERATIONS[dimension] + NODE_OPERATIONS * nodes_per_point
        return max(traffic / self.bandwidth, operations / self.vector_rate)


def measure_machine(threads: int, working_set: int) -> Machine:
    """Best of several measurements, on as many bytes as the points and nodes of a case take."""
    set_threads(threads)
    n = max(working_set // (2 * BYTES * LANES), 1) * LANES
    source, target = aligned_zeros(n), aligned_zeros(n)
    seconds = _best(lambda: _stream(source, target))
    sums = np.zeros(BLOCKS)
    rate = BLOCKS * ROUNDS * CHAINS / _best(lambda: _multiply_add(sums, 0.999, ROUNDS))
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
