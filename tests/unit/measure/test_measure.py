"""Measurements of deposits with known runout, height and shape."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from mpmcol.measure import (
    ColumnShape,
    Measurement,
    deposit_profile,
    fronts_and_height,
    measure,
    stop_time,
    undisturbed_radius,
)
from mpmcol.measure.sections import connected_to_base

H = 0.002
PLANE = ColumnShape("plane", "one-sided", r_i=0.09, h_i=0.09, spacing=H, density=2650.0, point_size=H / 2)
ROUND = replace(PLANE, model="axisymmetric")


def lattice(length: float, height: float, inside: Callable[..., np.ndarray], shape: ColumnShape) -> np.ndarray:
    size = shape.point_size
    x, y = np.meshgrid(np.arange(size / 2, length, size), np.arange(size / 2, height, size), indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel()])
    return points[inside(points[:, 0], points[:, 1])]


def masses(points: np.ndarray, shape: ColumnShape) -> np.ndarray:
    width = points[:, 0] if shape.model == "axisymmetric" else 1.0
    return shape.density * shape.point_size**2 * width * np.ones(len(points))


def measured(points: np.ndarray, shape: ColumnShape = PLANE) -> Measurement:
    return measure(points, masses(points, shape), None, shape)


def rectangle(shape: ColumnShape = PLANE) -> np.ndarray:
    return lattice(shape.r_i, shape.h_i, lambda x, y: x < np.inf, shape)


def wedge(shape: ColumnShape = PLANE, length: float = 0.24, height: float = 0.06) -> np.ndarray:
    return lattice(length, height, lambda x, y: y < height * (1 - x / length), shape)


@pytest.mark.parametrize("shape", [PLANE, ROUND, replace(PLANE, release="two-sided")])
def test_the_initial_column_has_no_runout_and_area_factor_one(shape: ColumnShape) -> None:
    result = measured(rectangle(shape), shape)
    assert result.front == pytest.approx(dict.fromkeys(result.front, 0.09), abs=1e-12)
    assert result.zeta == pytest.approx(dict.fromkeys(result.zeta, 0.0), abs=1e-12)
    assert result.beta == pytest.approx(1.0)
    assert result.area_factor == pytest.approx(1.0)
    assert result.spread == pytest.approx(0.0, abs=1e-12)
    assert result.undisturbed_radius is None


def test_a_plane_wedge() -> None:
    result = measured(wedge())
    assert result.height == pytest.approx(0.06, abs=H / 2)
    assert result.front["front_max"] == pytest.approx(0.24, abs=2 * H)
    assert result.front["front_connected"] == result.front["front_max"]
    # the threshold is max(h / 2, r_i / 100) = 1 mm, which a slope of 1 in 4 reaches 4 mm before its tip
    assert result.front["front_height"] == pytest.approx(0.236, abs=H / 2)
    assert result.area_factor == pytest.approx(0.5 * 0.24 / 0.236, rel=0.02)
    assert result.zeta["front_max"] == pytest.approx(0.24 / 0.09 - 1.0, abs=0.05)
    assert result.spread == pytest.approx(result.zeta["front_max"] - result.zeta["front_height"])


def test_a_cone_with_masses_per_radian() -> None:
    result = measured(wedge(ROUND), ROUND)
    assert result.height == pytest.approx(0.06, abs=H / 2)
    assert result.area_factor == pytest.approx((0.24 / result.front["front_height"]) ** 2 / 3.0, rel=0.02)


@pytest.mark.parametrize("shape", [PLANE, ROUND])
def test_the_profile_is_the_height_of_the_wedge_and_conserves_its_volume(shape: ColumnShape) -> None:
    points = wedge(shape)
    x, y = deposit_profile(points, masses(points, shape), shape)
    interior = (x > 2 * H) & (x < 0.23)
    assert np.abs(y - 0.06 * (1 - x / 0.24))[interior].max() < 0.3 * H
    assert y[-1] == 0.0
    area = x * H if shape.model == "axisymmetric" else np.full_like(x, H)
    if shape.model == "axisymmetric":
        # contributions of the points at r / h = 1/4, 3/4 and 5/4 to the first bin
        area[0] = (1 * 0.25 + 0.75 * 0.75 + 0.25 * 1.25) * H**2 / 2
    assert (y * area).sum() * shape.density == pytest.approx(masses(points, shape).sum())


@pytest.mark.parametrize("stretch", [1.0, 1.25, 1.4, 1.5, 1.9])
def test_the_profile_of_a_stretched_lattice_is_level(stretch: float) -> None:
    points = rectangle() * [stretch, 1.0 / stretch]
    _, y = deposit_profile(points, np.full(len(points), PLANE.density * PLANE.point_size**2), PLANE)
    level = PLANE.h_i / stretch
    assert np.abs(y[:35] / level - 1.0).max() < 0.1  # sharp bins would be off by up to 40 %


@pytest.mark.parametrize("shape", [PLANE, ROUND])
def test_the_profile_of_the_initial_column_is_its_height_in_every_bin(shape: ColumnShape) -> None:
    points = rectangle(shape)
    _, y = deposit_profile(points, masses(points, shape), shape)
    assert y[:44] == pytest.approx(0.09)


def test_detached_points_ahead_of_the_front_count_only_for_front_max() -> None:
    pile, detached = wedge(), np.array([[0.30, 0.0005], [0.301, 0.0005]])
    alone, both = measured(pile), measured(np.vstack([pile, detached]))
    assert both.front["front_max"] == pytest.approx(0.301 + H / 4)
    assert both.front["front_connected"] == alone.front["front_connected"]
    assert both.front["front_height"] == pytest.approx(alone.front["front_height"])
    assert both.spread > 5 * alone.spread


@pytest.mark.parametrize(("gap", "reached"), [(0.9 * H, True), (1.1 * H, False)])
def test_the_connected_front_ends_at_a_gap_wider_than_one_cell(gap: float, reached: bool) -> None:
    pile = rectangle()
    point = np.array([[0.09 + gap + H / 4, 0.0005]])  # its edge is at a distance of `gap` from that of the pile
    front = measured(np.vstack([pile, point])).front["front_connected"]
    assert front == pytest.approx(0.09 + gap + H / 2 if reached else 0.09)


def test_a_crack_at_the_wall_does_not_reduce_the_height() -> None:
    pile = wedge()
    cracked = pile[(pile[:, 0] > H) | (np.abs(pile[:, 1] - 0.03) > 1.2 * H)]
    assert len(cracked) < len(pile)
    assert measured(cracked).height == pytest.approx(measured(pile).height)


def test_points_in_flight_count_neither_for_the_height_nor_for_the_connected_front() -> None:
    pile = rectangle()
    in_flight = np.array([[0.0005, 0.2], [0.091, 0.05]])  # above the column, and in the air beside it
    result = measured(np.vstack([pile, in_flight]))
    assert result.height == pytest.approx(0.09)
    assert result.front["front_max"] == pytest.approx(0.0915)
    assert result.front["front_connected"] == pytest.approx(0.09)


@pytest.mark.parametrize(("height", "reached"), [(1.6, True), (3.0, False)])
def test_a_layer_that_rests_slightly_above_the_base_is_connected(height: float, reached: bool) -> None:
    layer = lattice(0.02, 0.004, lambda x, y: x < np.inf, PLANE) + np.array([0.09, height * H])
    front = measured(np.vstack([rectangle(), layer])).front["front_connected"]
    assert front == pytest.approx(0.11 if reached else 0.09)


def test_the_height_threshold_is_a_hundredth_of_the_radius_on_fine_grids() -> None:
    coarse = replace(PLANE, r_i=0.5)  # r_i / 100 = 5 mm exceeds h / 2
    assert measured(wedge(), coarse).front["front_height"] == pytest.approx(0.22, abs=H)


@pytest.mark.parametrize(("per_axis", "threshold"), [(1, 0.0015), (2, 0.0015), (3, 0.001)])
def test_the_height_threshold_is_one_layer_of_points(per_axis: int, threshold: float) -> None:
    """At most half a cell: with one point per cell, thinner deposits cannot be distinguished from a layer of points."""
    shape = replace(PLANE, spacing=0.003, point_size=0.003 / per_axis)
    front = measured(wedge(shape), shape).front["front_height"]
    assert front == pytest.approx(0.24 * (1.0 - threshold / 0.06), abs=0.001)


def test_the_front_by_height_is_contiguous_from_the_pile() -> None:
    heap = lattice(0.01, 0.01, lambda x, y: x < np.inf, PLANE) + np.array([0.30, 0.0])
    assert measured(heap).front["front_height"] == pytest.approx(0.31)
    assert measured(np.vstack([wedge(), heap])).front["front_height"] == pytest.approx(0.236, abs=H / 2)


def test_no_points_and_points_with_non_finite_positions() -> None:
    nothing = measure(np.zeros((0, 2)), np.zeros(0), np.zeros((0, 2)), PLANE)
    assert nothing.front == {"front_max": 0.0, "front_connected": 0.0, "front_height": 0.0}
    assert (nothing.height, nothing.area_factor, nothing.undisturbed_radius) == (0.0, 0.0, 0.0)
    points = np.vstack([rectangle(), [[np.nan, 0.0]], [[np.inf, 0.1]]])
    result = measure(points, masses(points, PLANE), np.zeros_like(points), PLANE)
    assert result.zeta["front_max"] == pytest.approx(0.0, abs=1e-12)
    assert "NaN" not in json.dumps(result.scalars())


def test_a_point_beyond_the_wall_by_round_off_is_in_the_first_bin() -> None:
    points = rectangle()
    points[0, 0] = -1e-9
    assert measured(points).beta == pytest.approx(1.0)


def test_positions_with_three_components_are_accepted() -> None:
    points = rectangle()
    deep = np.column_stack([points, np.zeros(len(points))])
    assert measure(deep, masses(points, PLANE), None, PLANE).zeta == measured(points).zeta


def test_the_undisturbed_radius_ends_where_the_top_surface_has_moved_by_a_hundredth_of_r_i() -> None:
    points = rectangle()
    displacement = np.zeros_like(points)
    displacement[points[:, 0] > 0.05, 0] = 0.011 * PLANE.r_i
    assert undisturbed_radius(points + displacement, displacement, PLANE) == pytest.approx(0.05)
    assert undisturbed_radius(points + 0.9 * displacement, 0.9 * displacement, PLANE) == pytest.approx(0.09)


def test_the_undisturbed_radius_depends_on_the_top_surface_only() -> None:
    points = rectangle()
    displacement = np.zeros_like(points)
    displacement[points[:, 1] < 0.08, 0] = 0.01
    assert undisturbed_radius(points + displacement, displacement, PLANE) == pytest.approx(0.09)
    assert undisturbed_radius(points + 0.01, np.full_like(points, 0.01), PLANE) == 0.0


def test_the_stop_time_is_none_while_the_front_moves() -> None:
    time, front = np.linspace(0.0, 1.0, 11), np.minimum(np.linspace(0.0, 1.0, 11), 0.7)
    assert stop_time(time, front, 1e-3) == pytest.approx(0.7)
    assert stop_time(time, time, 1e-3) is None


def test_a_front_that_moves_by_less_than_a_cell_has_no_stop_time() -> None:
    time = np.linspace(0.0, 1.0, 11)
    assert stop_time(time, 1.0 + 0.9e-3 * time, 1e-3) is None
    assert stop_time(time, np.minimum(1.0 + 3e-3 * time, 1.0 + 1.5e-3), 1e-3) == pytest.approx(0.2)


@pytest.mark.parametrize("model", ["plane", "axisymmetric"])
def test_the_height_of_an_outline_away_from_the_wall_is_that_of_its_crest(model: str) -> None:
    ridge = ((0.1, 0.0), (0.3, 0.0), (0.2, 0.1))
    shape = replace(PLANE, model=model, r_i=0.3, h_i=0.1, section="outline", outline=ridge)
    result = measured(lattice(0.3, 0.1, lambda x, y: y < 0.1 - np.abs(x - 0.2), shape), shape)
    assert result.beta == pytest.approx(1.0, abs=H / 0.1)
    assert result.front["front_height"] == pytest.approx(0.297, abs=H)  # where the height is r_i / 100
    volume = 0.01 if model == "plane" else 0.01 * 0.2 / (0.3 / 2.0)
    assert result.area_factor == pytest.approx(volume / (0.3 * 0.1), rel=0.03)


@pytest.mark.parametrize("columns", [3, 10**6])
def test_the_connected_pile_is_that_of_each_column_taken_alone(columns: int) -> None:
    """Points on a coarse lattice, many at the same place; columns with small and with large numbers."""
    generator = np.random.default_rng(3)
    for _ in range(50):
        y = 0.37 * PLANE.point_size * generator.integers(0, 80, 40)
        column = generator.integers(0, columns, 40)
        together = connected_to_base(y, column, PLANE)
        for own in (column == number for number in np.unique(column)):
            order = np.argsort(y[own])
            gaps = np.diff(y[own][order], prepend=PLANE.spacing - 0.5 * PLANE.point_size) - PLANE.point_size
            reached = np.logical_and.accumulate(gaps <= PLANE.spacing)
            np.testing.assert_array_equal(together[own][order], reached)


@pytest.mark.parametrize("shape", [PLANE, ROUND])
def test_fronts_and_height_of_the_history_are_those_of_the_measurement(shape: ColumnShape) -> None:
    flying = np.array([[0.3, 0.001], [0.05, 0.2]])
    points = np.vstack((wedge(shape), flying))
    result = measured(points, shape)
    assert fronts_and_height(points, masses(points, shape), shape) == (result.front, result.height)
    assert fronts_and_height(points[:0], masses(points[:0], shape), shape)[1] == 0.0
