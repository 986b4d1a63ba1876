"""The basis beside walls: partition of unity, linear fields, and the join of corrected and plain spline."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from mpmcol.basis.quadratic import spline, splines
from mpmcol.simd import vector

NODES = 6
EXACT = 1e-13
EVERY_CELL = np.linspace(1e-9, NODES - 1 - 1e-9, 1001)
WALL_STRIPS = np.concatenate([EVERY_CELL[EVERY_CELL < 0.5], EVERY_CELL[EVERY_CELL > NODES - 1.5]])


def weights_at(s: float, correction: bool = True) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Node numbers, weights and gradients of one axis, three each."""
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
def test_corrected_and_plain_spline_join_with_equal_value_and_slope(join: float) -> None:
    def dense(s: float) -> np.ndarray:
        nodes, w, g = weights_at(s)
        out = np.zeros((2, NODES))
        out[:, nodes] = w, g
        return out

    np.testing.assert_allclose(dense(np.nextafter(join, 0.0)), dense(np.nextafter(join, NODES)), atol=1e-14)


def test_without_correction_the_spline_is_cut_off_at_the_wall() -> None:
    for s in WALL_STRIPS:
        _, w, g = weights_at(s, correction=False)
        distance = min(s, NODES - 1 - s)
        assert w.sum() == pytest.approx(1.0 - 0.5 * (0.5 - distance) ** 2)
        assert abs(g.sum()) == pytest.approx(0.5 - distance)


@pytest.mark.parametrize("correction", [True, False])
def test_all_lanes_have_the_bits_of_the_single_spline(correction: bool) -> None:
    """Three axes of different lengths at once, beside other lanes that hold anything."""
    lengths, far = np.array([3, 6, 11]), np.inf
    bottom = vector(-far, -far, -far, -far, 0.5, 0.5, 0.5, -far)
    top = vector(far, far, far, far, *(lengths - 1.5), far)
    rng = np.random.default_rng(4)
    for _ in range(2000):
        walls = rng.integers(0, 2, 3) * (lengths - 1.0) + rng.choice([-0.4, -0.01, 0.01, 0.4], 3)
        inside = rng.uniform(0.0, lengths - 1.0)
        places = np.clip(np.where(rng.uniform(size=3) < 0.3, walls, inside), 0.0, lengths - 1.0)
        s = np.concatenate((rng.normal(0.0, 1e3, 4), places, [np.nan]))
        found = splines(s, bottom, top, correction)
        for axis, (place, n) in enumerate(zip(places, lengths, strict=True)):
            assert [value[4 + axis] for value in found] == list(spline(place, n, correction))
