"""P2G and G2P transfer mass, linear velocity fields and stress exactly, also next to walls."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest

from mpmcol.failure_modes.toolkit import (
    WEIGHTLESS,
    advance_steps,
    by_id,
    lattice,
    make_solver,
    points_at,
    walled_grid,
)
from mpmcol.mpm.boundary import WALL_GAP
from mpmcol.mpm.grid import node_coordinates, node_records
from mpmcol.mpm.particles import Points
from mpmcol.mpm.settings import PAPER, Scheme
from mpmcol.mpm.solver import Solver

CELLS = 8
V0, L = np.array([0.4, -0.3, 0.6]), np.array([[0.5, -1.1, 0.3], [0.8, 0.2, -0.7], [-0.4, 0.9, 0.6]])
SCHEMES = [
    PAPER,
    Scheme(affine=True),
    Scheme(basis="linear"),
    Scheme(basis="cubic"),
]
both_dimensions = pytest.mark.parametrize("d", [2, 3])
every_scheme_and_dimension = pytest.mark.parametrize(
    ("scheme", "d"),
    [
        *((scheme, 2) for scheme in SCHEMES[:3]),
        pytest.param(SCHEMES[3], 2, marks=pytest.mark.slow),
        pytest.param(Scheme(stress_order="musl", affine=True, basis="cubic"), 2, marks=pytest.mark.slow),
        (PAPER, 3),
        (Scheme(basis="linear"), 3),
        *(pytest.param(scheme, 3, marks=pytest.mark.slow) for scheme in (SCHEMES[1], SCHEMES[3])),
    ],
    ids=str,
)


class Nodes(NamedTuple):
    """All nodes after one step; coordinates, velocity and acceleration have shape (nodes, d)."""

    x: np.ndarray
    m: np.ndarray
    v: np.ndarray  # after the grid update
    a: np.ndarray


def moving(x: np.ndarray, v: np.ndarray, grad_v: np.ndarray, h: float) -> Points:
    """Points at `x` (n, d) with velocities `v` and gradients `grad_v` ([n,] d, d)."""
    d = x.shape[1]
    points = points_at(x, h / 2)
    points.v[:] = v
    points.grad_v = np.pad(np.broadcast_to(grad_v, (len(x), d, d)), ((0, 0), (0, 3 - d), (0, 3 - d)))
    return points


def one_step(points: Points, h: float, scheme: Scheme = PAPER, **change: float) -> tuple[Solver, Nodes]:
    """The solver and its nodes after one step without gravity in the unit square or cube."""
    d = points.dimension
    grid = walled_grid((0.0,) * d, h, (round(1.0 / h),) * d)
    solver = make_solver(points, grid, WEIGHTLESS._replace(**change), scheme=scheme)
    advance_steps(solver, 1)
    records = node_records(grid).reshape(-1, 8)
    x = np.stack(np.broadcast_arrays(*node_coordinates(grid)), axis=-1).reshape(-1, d)
    return solver, Nodes(x, records[:, 0], records[:, 1 : 1 + d], records[:, 4 : 4 + d])


def scattered(d: int) -> np.ndarray:
    """Random points, for each axis a hundred of them within half a cell of one of its walls."""
    rng = np.random.default_rng(4)
    x = rng.uniform(0.001, 0.999, (600 if d == 2 else 5000, d))
    strip = 0.5 / CELLS
    for axis in range(d):
        some = slice(100 * axis, 100 * (axis + 1))
        x[some, axis] = rng.uniform(0.001, strip, 100) if axis != 1 else rng.uniform(1.0 - strip, 0.999, 100)
    return x


def linear_field(d: int) -> Points:
    x = scattered(d)
    return moving(x, V0[:d] + x @ L[:d, :d].T, L[:d, :d], 1.0 / CELLS)


def linear_error(taylor: float, d: int, scheme: Scheme = PAPER) -> float:
    _, nodes = one_step(linear_field(d), 1.0 / CELLS, scheme, taylor=taylor)
    assert np.all(nodes.m > 0.0)
    return float(np.abs(nodes.v - V0[:d] - nodes.x @ L[:d, :d].T).max())


@every_scheme_and_dimension
def test_taylor_p2g_is_exact_for_linear_fields_up_to_the_walls(scheme: Scheme, d: int) -> None:
    """Points as close as 0.001 = 0.008 h to a wall."""
    assert linear_error(1.0, d, scheme) < 1e-12


@both_dimensions
def test_p2g_without_the_taylor_term_is_not_exact(d: int) -> None:
    assert linear_error(0.0, d) > 1e-2


@every_scheme_and_dimension
def test_g2p_is_exact_for_linear_fields_up_to_the_walls(scheme: Scheme, d: int) -> None:
    """PIC velocity, velocity gradient and displacement of every point, limited by the distance from walls."""
    points = linear_field(d)
    start, v = points.x.copy(), points.v.copy()
    solver, _ = one_step(points, 1.0 / CELLS, scheme, flip_fraction=0.0)
    after = by_id(solver)
    np.testing.assert_allclose(after.v, v, atol=1e-12)
    np.testing.assert_allclose(after.grad_v[:, :d, :d], np.broadcast_to(L[:d, :d], (len(v), d, d)), atol=1e-10)
    gap = WALL_GAP / CELLS
    np.testing.assert_allclose(after.x, np.clip(start + solver.time * v, gap, 1.0 - gap), atol=1e-14)


@both_dimensions
def test_p2g_conserves_mass_and_its_centre_up_to_the_walls(d: int) -> None:
    """The weights of a point add up to one, and their weighted node positions to its position."""
    points = points_at(scattered(d), 0.5 / CELLS)
    points.m[:] = np.random.default_rng(6).uniform(0.5, 2.0, len(points))
    moment = points.m @ points.x
    _, nodes = one_step(points, 1.0 / CELLS)
    assert nodes.m.sum() == pytest.approx(points.m.sum(), rel=1e-13)
    np.testing.assert_allclose(nodes.m @ nodes.x, moment, rtol=1e-13)


@both_dimensions
def test_internal_forces_have_no_resultant_and_the_moment_of_the_stress(d: int) -> None:
    """sum f = 0 and sum f x = -sum V sigma, since sum grad w = 0 and sum x grad w = I."""
    points = points_at(scattered(d), 0.5 / CELLS)
    rng = np.random.default_rng(7)
    points.sigma = rng.normal(0.0, 1e3, (len(points), 6))
    xx, yy, zz, xy, yz, xz = points.V @ points.sigma
    moment = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])[:d, :d]
    _, nodes = one_step(points, 1.0 / CELLS)
    force = nodes.m[:, None] * nodes.a
    scale = points.V.sum() * 1e3
    np.testing.assert_allclose(force.sum(axis=0), 0.0, atol=1e-12 * scale * CELLS)
    np.testing.assert_allclose(force.T @ nodes.x, -moment, atol=1e-12 * scale)


@both_dimensions
def test_the_taylor_term_adds_no_momentum(d: int) -> None:
    x = scattered(d)
    v = np.random.default_rng(5).normal(size=x.shape)
    _, nodes = one_step(moving(x, v, L[:d, :d], 1.0 / CELLS), 1.0 / CELLS)
    np.testing.assert_allclose(nodes.m @ nodes.v / nodes.m.sum(), v.mean(axis=0), rtol=1e-11)


@pytest.mark.parametrize(("d", "cells"), [(2, (10, 20, 40)), (3, (10, 20))])
@pytest.mark.parametrize("taylor", [0.0, 1.0], ids=["flip", "taylor-flip"])
def test_p2g_of_a_smooth_field_is_second_order(taylor: float, d: int, cells: tuple[int, ...]) -> None:
    k = np.array([4.0, 3.0, -2.0])[:d]

    def field(x: np.ndarray) -> np.ndarray:
        phase = x @ k
        return np.stack([np.sin(phase), np.cos(phase), np.sin(phase)], axis=1)[:, :d]

    def error(cells: int) -> float:
        x = lattice((0.0,) * d, (1.0,) * d, 0.5 / cells)
        # the derivative with respect to the phase is the field a quarter of a wave ahead
        derivative = field(x + (0.5 * np.pi) * k / (k @ k))
        _, nodes = one_step(moving(x, field(x), derivative[:, :, None] * k, 1.0 / cells), 1.0 / cells, taylor=taylor)
        inner = np.all((nodes.x > 1.5 / cells) & (nodes.x < 1.0 - 1.5 / cells), axis=1)
        return float(np.abs(nodes.v - field(nodes.x))[inner].max())

    errors = [error(count) for count in cells]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all((orders > 1.9) & (orders < 2.1)), (errors, orders)
