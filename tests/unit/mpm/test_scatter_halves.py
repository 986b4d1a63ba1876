"""P2G for registers of four doubles gives the bits of that for registers of eight."""

from __future__ import annotations

from types import ModuleType

import numba
import numpy as np
import pytest

from mpmcol.bench.cases import make_solver
from mpmcol.mpm.jit import JIT_DISABLED
from mpmcol.mpm.kernels import scatter_halves_2d, transfer_quadratic_2d
from mpmcol.mpm.simd.registers import holds_vector
from mpmcol.mpm.solver import Solver


def moving_solver(model: str) -> Solver:
    """Points with different velocities, velocity gradients, stresses, volumes and opening strains."""
    solver, noise = make_solver(model, 500), np.random.default_rng(3)
    points = solver.points
    points.v[:] = noise.normal(size=points.v.shape)
    points.grad_v = points.grad_v + noise.normal(size=points.grad_v.shape) * np.array([[1, 1, 0], [1, 1, 0], [0, 0, 1]])
    points.sigma = points.sigma + noise.normal(0.0, 1e3, points.sigma.shape) * np.array([1, 1, 1, 1, 0, 0])
    points.J[:] = noise.uniform(0.5, 1.5, len(points))
    points.opening[:] = np.maximum(noise.normal(0.0, 0.01, len(points)), 0.0)
    solver.sort()
    return solver


def scattered(module: ModuleType, solver: Solver, filter_rate: float) -> np.ndarray:
    """The nodes after P2G of all points, tile by tile."""
    scatter, state = module.scatter_points, solver.state()
    settings = state.settings._replace(filter_rate=filter_rate, filter_modulus=1e6, filter_opening=0.005)

    def p2g(rows, start, grid, settings):  # type: ignore[no-untyped-def]
        for t in range(len(start) - 1):
            scatter(rows, start[t], start[t + 1], start[t + 1], grid, settings)

    function = p2g if JIT_DISABLED else numba.njit(error_model="numpy")(p2g)
    state.grid.nodes[:] = 0.0
    function(state.rows, state.tiles.start, state.grid, settings)
    return state.grid.nodes.copy()


@pytest.mark.parametrize("filter_rate", [0.0, 1.0])
@pytest.mark.parametrize("model", ["plane", "axisymmetric"])
def test_both_forms_give_the_same_bits(model: str, filter_rate: float) -> None:
    solver = moving_solver(model)
    nodes = scattered(transfer_quadratic_2d, solver, filter_rate)
    assert np.count_nonzero(nodes.reshape(-1, 8).any(axis=0)) == 5 + (filter_rate > 0.0)
    assert nodes.tobytes() == scattered(scatter_halves_2d, solver, filter_rate).tobytes()


def test_the_form_follows_from_the_features_of_the_processor() -> None:
    assert holds_vector("+avx2,+avx512f,-avx512bf16")
    assert not holds_vector("+avx2,-avx512f,+fma")
    assert holds_vector("")  # unknown
