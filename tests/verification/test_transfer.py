"""Points to grid: the Taylor term makes linear velocity fields exact, beside walls too."""

from __future__ import annotations

import numpy as np
import pytest

from mpmcol.grid import node_coordinates, node_records
from tests.verification.blocks import (
    WEIGHTLESS,
    advance_steps,
    lattice,
    make_solver,
    points_at,
    walled_grid,
)

CELLS = 8
V0, L = np.array([0.4, -0.3]), np.array([[0.5, -1.1], [0.8, 0.2]])


def nodal_velocity(x, v, grad_v, h, taylor):
    """Mass (n, n), velocity and coordinates (n, n, 2) of the nodes after P2G of stress-free points."""
    points = points_at(x, h / 2)
    points.v[:] = v
    points.grad_v = np.pad(np.broadcast_to(grad_v, (len(x), 2, 2)), ((0, 0), (0, 1), (0, 1)))
    solver = make_solver(points, walled_grid((0.0, 0.0), h, (round(1.0 / h),) * 2), WEIGHTLESS._replace(taylor=taylor))
    advance_steps(solver, 1)
    nodes = node_records(solver.grid)
    return nodes[:, :, 0], nodes[:, :, 1:3], np.stack(np.broadcast_arrays(*node_coordinates(solver.grid)), axis=-1)


def scattered() -> np.ndarray:
    """Points everywhere, a third of them in the strips half a cell wide beside the walls."""
    rng = np.random.default_rng(4)
    x = rng.uniform(0.001, 0.999, (600, 2))
    strip = 0.5 / CELLS
    x[:100, 0], x[100:200, 1] = rng.uniform(0.001, strip, 100), rng.uniform(1.0 - strip, 0.999, 100)
    return x


def linear_error(taylor: float) -> float:
    x = scattered()
    mass, v, nodes = nodal_velocity(x, V0 + x @ L.T, L, 1.0 / CELLS, taylor)
    assert np.all(mass > 0.0)
    return float(np.abs(v - V0 - nodes @ L.T).max())


def test_taylor_p2g_is_exact_for_linear_fields_up_to_the_walls() -> None:
    assert linear_error(taylor=1.0) < 1e-12


def test_flip_p2g_is_not() -> None:
    assert linear_error(taylor=0.0) > 1e-2


def test_the_taylor_term_adds_no_momentum() -> None:
    x = scattered()
    v = np.random.default_rng(5).normal(size=x.shape)
    mass, nodal, _ = nodal_velocity(x, v, L, 1.0 / CELLS, taylor=1.0)
    momentum = np.einsum("ij,ijk->k", mass, nodal)
    np.testing.assert_allclose(momentum / mass.sum(), v.mean(axis=0), rtol=1e-12)


@pytest.mark.parametrize("taylor", [0.0, 1.0], ids=["flip", "taylor-flip"])
def test_p2g_of_a_smooth_field_is_second_order(taylor: float) -> None:
    def error(cells: int) -> float:
        h = 1.0 / cells
        x = lattice((0.0, 0.0), (1.0, 1.0), h / 2)
        k = np.array([4.0, 3.0])
        phase = x @ k
        v = np.stack([np.sin(phase), np.cos(phase)], axis=1)
        grad = np.stack([np.cos(phase), -np.sin(phase)], axis=1)[:, :, None] * k
        _, nodal, nodes = nodal_velocity(x, v, grad, h, taylor)
        inner, at = (slice(2, -2), slice(2, -2)), nodes @ k
        return float(np.abs(nodal - np.stack([np.sin(at), np.cos(at)], axis=-1))[inner].max())

    errors = [error(10), error(20), error(40)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all((orders > 1.9) & (orders < 2.1)), (errors, orders)
