"""Shape functions next to walls: partition of unity, linear fields, continuity of the kernel correction."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from mpmcol.mpm.shape_functions import SHAPE_FUNCTIONS
from mpmcol.mpm.shape_functions.quadratic import spline, spline_lanes
from mpmcol.mpm.simd import vector

NODES = 6
EXACT = 1e-13
EVERY_CELL = np.linspace(1e-9, NODES - 1 - 1e-9, 1001)
WALL_STRIPS = np.concatenate([EVERY_CELL[EVERY_CELL < 0.5], EVERY_CELL[EVERY_CELL > NODES - 1.5]])


def weights_at(s: float, correction: bool = True) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Numbers, weights and gradients of the three nodes along one axis."""
    first, w0, w1, w2, g0, g1, g2 = spline(s, NODES, correction)
    return first + np.arange(3), np.array([w0, w1, w2]), np.array([g0, g1, g2])


def test_weights_reproduce_constants_and_coordinates_in_every_cell() -> None:
    for s in EVERY_CELL:
        nodes, w, g = weights_at(s)
        assert nodes[0] >= 0 and nodes[2] < NODES
        assert np.all(w >= 0.0)
        np.testing.assert_allclose([w.sum(), w @ nodes, g.sum(), g @ nodes], [1.0, s, 0.0, 1.0], atol=EXACT)


@pytest.mark.parametrize("corner", list(product(["low", "inner", "high"], repeat=2)), ids="-".join)
def test_linear_fields_are_exact_in_wall_and_corner_cells(corner: tuple[str, str]) -> None:
    ranges = {"low": (0.0, 1.0), "inner": (2.0, 3.0), "high": (NODES - 2.0, NODES - 1.0)}
    rng = np.random.default_rng(3)
    value, slope = 0.7, np.array([1.3, -2.1])
    for _ in range(100):
        s = np.array([rng.uniform(*ranges[side]) for side in corner])
        (nx, wx, gx), (ny, wy, gy) = weights_at(s[0]), weights_at(s[1])
        field = value + slope[0] * nx[:, None] + slope[1] * ny[None, :]
        assert wx @ field @ wy == pytest.approx(value + slope @ s, abs=EXACT * 10.0)
        np.testing.assert_allclose([gx @ field @ wy, wx @ field @ gy], slope, atol=EXACT * 10.0)


@pytest.mark.parametrize("join", [0.5, NODES - 1.5])
def test_corrected_and_uncorrected_b_spline_join_with_equal_value_and_slope(join: float) -> None:
    def dense(s: float) -> np.ndarray:
        nodes, w, g = weights_at(s)
        out = np.zeros((2, NODES))
        out[:, nodes] = w, g
        return out

    np.testing.assert_allclose(dense(np.nextafter(join, 0.0)), dense(np.nextafter(join, NODES)), atol=1e-14)


def test_without_correction_the_b_spline_is_truncated_at_the_wall() -> None:
    for s in WALL_STRIPS:
        _, w, g = weights_at(s, correction=False)
        distance = min(s, NODES - 1 - s)
        assert w.sum() == pytest.approx(1.0 - 0.5 * (0.5 - distance) ** 2)
        assert abs(g.sum()) == pytest.approx(0.5 - distance)


@pytest.mark.parametrize("correction", [True, False])
def test_vectors_and_scalars_give_the_same_bits(correction: bool) -> None:
    """Three axes of different lengths at once; the other lanes have arbitrary values."""
    lengths, far = np.array([3, 6, 11]), np.inf
    bottom = vector(-far, -far, -far, -far, 0.5, 0.5, 0.5, -far)
    top = vector(far, far, far, far, *(lengths - 1.5), far)
    rng = np.random.default_rng(4)
    for _ in range(2000):
        walls = rng.integers(0, 2, 3) * (lengths - 1.0) + rng.choice([-0.4, -0.01, 0.01, 0.4], 3)
        inside = rng.uniform(0.0, lengths - 1.0)
        positions = np.clip(np.where(rng.uniform(size=3) < 0.3, walls, inside), 0.0, lengths - 1.0)
        s = np.concatenate((rng.normal(0.0, 1e3, 4), positions, [np.nan]))
        found = spline_lanes(s, bottom, top, correction)
        for axis, (position, n) in enumerate(zip(positions, lengths, strict=True)):
            assert [value[4 + axis] for value in found] == list(spline(position, n, correction))


every_basis = pytest.mark.parametrize("basis", list(SHAPE_FUNCTIONS))


def dense_weights(basis: str, s: np.ndarray, correction: bool = True) -> tuple[np.ndarray, np.ndarray]:
    """Weights and gradients (n, NODES) of all nodes along an axis at positions `s` (n,) inside the grid."""
    far = np.inf
    w, g = np.zeros((2, len(s), NODES))
    for position, w_p, g_p in zip(s, w, g, strict=True):
        lanes = vector(-far, -far, -far, -far, 0.5, 0.5, 0.5, -far), vector(*[far] * 4, *[NODES - 1.5] * 3, far)
        base, *rest = SHAPE_FUNCTIONS[basis].evaluate(vector(*[position] * 8), *lanes, correction)
        found = np.array(rest)[:, 5]
        width = SHAPE_FUNCTIONS[basis].WIDTH
        assert 0 <= base[5] <= NODES - width and not np.any(found[width:4]) and not np.any(found[4 + width :])
        nodes = int(base[5]) + np.arange(width)
        w_p[nodes], g_p[nodes] = found[:width], found[4 : 4 + width]
    return w, g


@every_basis
def test_all_shape_functions_reproduce_constants_and_coordinates_in_every_cell(basis: str) -> None:
    w, g = dense_weights(basis, EVERY_CELL)
    nodes = np.arange(NODES)
    assert np.all(w >= -1e-16)
    np.testing.assert_allclose(w.sum(axis=1), 1.0, atol=EXACT)
    np.testing.assert_allclose(w @ nodes, EVERY_CELL, atol=EXACT)
    np.testing.assert_allclose(g.sum(axis=1), 0.0, atol=EXACT)
    np.testing.assert_allclose(g @ nodes, 1.0, atol=EXACT)


@every_basis
@pytest.mark.parametrize("correction", [True, False])
def test_gradients_are_the_derivatives_of_the_weights(basis: str, correction: bool) -> None:
    step = 1e-6
    s = EVERY_CELL[1:-1]
    s = s[np.abs(2.0 * s - np.round(2.0 * s)) > 1e-3]  # away from the joins of pieces
    (up, _), (down, _), (_, g) = (dense_weights(basis, s + shift, correction) for shift in (step, -step, 0.0))
    np.testing.assert_allclose((up - down) / (2.0 * step), g, atol=1e-9)


@pytest.mark.parametrize("join", [1.0, 2.0, NODES - 2.0])
def test_pieces_of_the_cubic_b_spline_join_with_equal_value_slope_and_curvature(join: float) -> None:
    step = 1e-4
    low, high = (dense_weights("cubic", np.array([join + shift for shift in shifts]))
                 for shifts in ((-step, -1e-12), (1e-12, step)))  # fmt: skip
    np.testing.assert_allclose(low[0][1], high[0][0], atol=1e-11)
    np.testing.assert_allclose(low[1][1], high[1][0], atol=1e-11)
    np.testing.assert_allclose((low[1][1] - low[1][0]), (high[1][1] - high[1][0]), atol=4.0 * step**2)


def test_cubic_weights_far_from_walls() -> None:
    """Values of the cubic B-spline: 1/6, 2/3, 1/6 on a node; 1/48, 23/48, 23/48, 1/48 midway between two."""
    w, _ = dense_weights("cubic", np.array([2.0, 2.5]))
    np.testing.assert_allclose(w[0], [0.0, 1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0, 0.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(w[1], [0.0, 1.0 / 48.0, 23.0 / 48.0, 23.0 / 48.0, 1.0 / 48.0, 0.0], atol=1e-15)


def test_without_correction_the_cubic_b_spline_is_truncated_at_the_wall() -> None:
    xi = np.linspace(0.01, 0.99, 50)
    for s in (xi, NODES - 1.0 - xi):
        w, g = dense_weights("cubic", s, correction=False)
        np.testing.assert_allclose(w.sum(axis=1), 1.0 - (1.0 - xi) ** 3 / 6.0)
        np.testing.assert_allclose(np.abs(g.sum(axis=1)), 0.5 * (1.0 - xi) ** 2)


@every_basis
def test_stiffness_is_the_largest_sum_of_squared_gradients_over_weights(basis: str) -> None:
    s = np.linspace(2.001, 2.999, 999)
    w, g = dense_weights(basis, s)
    largest = (g**2 / np.where(w > 0.0, w, 1.0)).sum(axis=1).max()
    assert largest <= SHAPE_FUNCTIONS[basis].STIFFNESS
    assert largest > min(0.98 * SHAPE_FUNCTIONS[basis].STIFFNESS, 900.0)
