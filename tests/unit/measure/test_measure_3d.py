"""Measurements of 3D deposits with known fronts, heights and profiles."""

from __future__ import annotations

import json
from collections.abc import Callable

import numpy as np
import pytest

from mpmcol.measure import FRONTS, ColumnShape, deposit_profile, measure
from mpmcol.measure.sections import column_index
from tests.support.deposits_3d import (
    BOX,
    CONE_HEIGHT,
    CONE_RADIUS,
    DENSITY,
    FULL,
    QUARTER,
    ROUND,
    H,
    S,
    at,
    cone,
    cylinder,
    lattice,
    measured,
)


def layer(front: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """A layer two cells thick that ends at the distance `front` of the azimuth."""
    return lattice(0.3, 2 * H, lambda r, y, azimuth: r < front(azimuth))


@pytest.mark.parametrize("shape", [QUARTER, FULL])
def test_the_initial_cylinder_has_no_runout(shape: ColumnShape) -> None:
    result = measured(cylinder(shape), shape)
    assert result.front == pytest.approx(dict.fromkeys(FRONTS, 0.1), abs=0.5 * S)  # resolution of the lattice
    assert result.front_range is not None and result.zeta_range is not None
    for name, (low, high) in result.front_range.items():
        assert 0.1 - S < low < result.front[name] < high < 0.1 + S
        assert result.zeta_range[name] == pytest.approx((low / 0.1 - 1.0, high / 0.1 - 1.0))
    assert result.beta == pytest.approx(1.0)
    assert result.area_factor == pytest.approx(1.0, rel=0.02)
    assert result.profile_y[1:18] == pytest.approx(np.full(17, 0.06), rel=0.02)


@pytest.mark.parametrize("shape", [QUARTER, FULL])
def test_a_cone(shape: ColumnShape) -> None:
    result = measured(cone(shape), shape)
    # the threshold of h / 2 is reached where a slope of 1 in 4 is 10 mm before the tip
    assert result.front["front_height"] == pytest.approx(0.19, abs=0.3 * H)
    assert result.front["front_max"] == pytest.approx(0.2, abs=H)
    assert result.front["front_connected"] == result.front["front_max"]
    assert result.front_range is not None
    assert result.front_range["front_height"] == pytest.approx((0.19, 0.19), abs=0.6 * H)
    assert result.height == pytest.approx(CONE_HEIGHT, abs=S)
    assert result.area_factor == pytest.approx((0.2 / 0.19) ** 2 / 3.0, rel=0.05)


@pytest.mark.parametrize("shape", [QUARTER, FULL])
def test_the_profile_is_the_mean_over_azimuth_and_conserves_the_volume(shape: ColumnShape) -> None:
    points = cone(shape)
    x, y = deposit_profile(points, np.full(len(points), DENSITY * S**3), shape)
    assert np.abs(y - CONE_HEIGHT * (1 - x / CONE_RADIUS))[:38].max() < 0.25 * H
    area = x * H
    area[0] = 13.0 / 24.0 * H**2  # integral of r times the linear weight of the first bin, reflected at the axis
    volume = shape.angle * (y * area).sum()
    assert volume == pytest.approx(len(points) * S**3, rel=1e-3)
    assert volume == pytest.approx(shape.angle / 2.0 * CONE_RADIUS**2 * CONE_HEIGHT / 3.0, rel=0.01)


def test_a_quarter_and_its_mirror_images_in_a_full_model_are_equal() -> None:
    detached = np.vstack([at(0.23, 0.001, 3.0), at(0.21, 0.03, 47.0), at(0.003, 0.09, 47.0)])
    quarter = np.vstack([lattice(0.2, 0.05, lambda r, y, azimuth: y < 0.05 - 0.3 * r + 0.01 * azimuth), detached])
    full = np.vstack([quarter * (i, 1.0, k) for i in (-1.0, 1.0) for k in (-1.0, 1.0)])
    one, four = measured(quarter), measured(full, FULL)
    assert four.front == pytest.approx(one.front, rel=1e-12)
    assert four.front_range == {name: pytest.approx(ends) for name, ends in (one.front_range or {}).items()}
    assert (four.height, four.area_factor) == pytest.approx((one.height, one.area_factor), rel=1e-12)
    assert four.profile_y == pytest.approx(one.profile_y, rel=1e-9)


def test_an_axisymmetric_deposit_rotated_about_its_axis_gives_the_same_results() -> None:
    r, y = (values.ravel() for values in np.meshgrid(np.arange(S / 2, 0.2, S), np.arange(S / 2, 0.05, S)))
    rng = np.random.default_rng(1)
    plane = np.column_stack([r, y])[y < 0.05 - 0.25 * r] + rng.uniform(-0.2, 0.2, (np.sum(y < 0.05 - 0.25 * r), 2)) * S
    plane = np.vstack([plane, [[0.23, 0.001], [0.15, 0.03], [0.002, 0.08]]])  # one detached, two in flight
    mass = DENSITY * S**2 * plane[:, 0]
    azimuth = np.radians(0.5 + np.arange(90))
    rotated = np.column_stack(
        [
            np.outer(np.cos(azimuth), plane[:, 0]).ravel(),
            np.tile(plane[:, 1], 90),
            np.outer(np.sin(azimuth), plane[:, 0]).ravel(),
        ]
    )
    flat, solid = measure(plane, mass, None, ROUND), measure(rotated, np.tile(mass * np.pi / 180.0, 90), None, QUARTER)
    assert solid.front == pytest.approx(flat.front, rel=1e-9)
    assert solid.front_range == {name: pytest.approx((front, front)) for name, front in flat.front.items()}
    assert (solid.height, solid.area_factor) == pytest.approx((flat.height, flat.area_factor))
    assert solid.profile_y[1:] == pytest.approx(flat.profile_y[1:])
    assert flat.front["front_max"] > flat.front["front_connected"] > 0.15 and flat.height < 0.06


def test_an_elliptical_front_has_a_mean_and_a_range() -> None:
    def ellipse(azimuth: np.ndarray) -> np.ndarray:
        return 0.28 * 0.18 / np.hypot(0.18 * np.cos(azimuth), 0.28 * np.sin(azimuth))

    result = measured(layer(ellipse))
    edges = np.radians(10.0 * np.arange(9))  # edge of each sector that is closest to the long axis
    last = ellipse(edges)
    # a layer of 2 h is h / 2 high on average where it fills a quarter of the sector
    quarter = ellipse(edges + np.radians(2.5))
    assert result.front_range is not None
    for name, expected in {"front_max": last, "front_connected": last, "front_height": quarter}.items():
        assert result.front[name] == pytest.approx(expected.mean(), abs=0.2 * H)
        assert result.front_range[name] == pytest.approx((expected.min(), expected.max()), abs=0.4 * H)


def test_a_detached_point_counts_in_its_own_sector_and_only_for_front_max() -> None:
    alone, both = measured(cone()), measured(np.vstack([cone(), at(0.25, 0.001, 33.0)]))
    sector = np.hypot(*cone()[:, [0, 2]].T)[(np.degrees(np.arctan2(*cone()[:, [2, 0]].T)) // 10) == 3].max()
    assert 9 * (both.front["front_max"] - alone.front["front_max"]) == pytest.approx(0.25 - sector)
    assert both.front_range is not None and both.front_range["front_max"][1] == both.max_distance == pytest.approx(
        0.25 + S / 2
    )
    assert both.front["front_connected"] == alone.front["front_connected"]
    assert both.front["front_height"] == pytest.approx(alone.front["front_height"], abs=1e-5)


def test_material_in_one_direction_does_not_connect_another() -> None:
    tongue = layer(lambda azimuth: np.where(np.degrees(azimuth) < 40.0, 0.1, 0.2))
    point = at(0.15, 0.001, 5.0)  # 50 mm ahead of the pile in its sector, but not of that in others
    result = measured(np.vstack([tongue, point]))
    assert result.front_range is not None
    assert result.front_range["front_connected"] == pytest.approx((0.1, 0.2), abs=S)
    assert result.front["front_connected"] == pytest.approx((4 * 0.1 + 5 * 0.2) / 9, abs=S)
    assert result.front["front_max"] - result.front["front_connected"] == pytest.approx(0.05 / 9, rel=0.1)


def test_sectors_narrower_than_a_cell_have_the_mean_profile() -> None:
    thin = layer(lambda azimuth: 0.1 + 0.0 * azimuth)
    r, degrees = np.hypot(thin[:, 0], thin[:, 2]), np.degrees(np.arctan2(thin[:, 2], thin[:, 0]))
    # a gap beside the points closest to the axis, which all lie in one sector
    holed = thin[(r < 1.2 * H) | (r > 4 * H) | (np.abs(degrees - 45.0) > 5.0)]
    assert 0 < len(thin) - len(holed) < 0.01 * len(thin)
    assert measured(holed).front["front_height"] == pytest.approx(measured(thin).front["front_height"], rel=1e-3)


def test_points_in_flight_above_different_columns_do_not_connect_each_other() -> None:
    # each less than a cell above the previous one, no two above the same 2 by 2 cells
    stairs = np.array([[0.5, 13.0, 0.5], [2.5, 14.4, 0.5], [0.5, 15.8, 2.5], [2.5, 17.2, 2.5]]) * H
    tower = np.column_stack([np.full((4, 1), 0.5 * H), stairs[:, 1], np.full((4, 1), 0.5 * H)])
    assert measured(np.vstack([cylinder(), stairs])).height == pytest.approx(13.0 * H + S / 2)
    assert measured(np.vstack([cylinder(), tower])).height == pytest.approx(17.2 * H + S / 2)


def test_a_crack_at_the_axis_does_not_reduce_the_height() -> None:
    pile = cone()
    cracked = pile[(pile[:, 0] > H) | (np.abs(pile[:, 1] - 0.02) > 1.2 * H)]
    assert len(cracked) < len(pile)
    assert measured(cracked).height == pytest.approx(measured(pile).height)


@pytest.mark.parametrize("shape", [QUARTER, FULL, BOX])
def test_empty_sectors_and_deposits_without_points_are_measured(shape: ColumnShape) -> None:
    nothing = measure(np.zeros((0, 3)), np.zeros(0), np.zeros((0, 3)), shape)
    assert nothing.front == dict.fromkeys(FRONTS, 0.0)
    assert nothing.front_range == dict.fromkeys(FRONTS, (0.0, 0.0))
    assert (nothing.height, nothing.area_factor, nothing.undisturbed_radius) == (0.0, 0.0, 0.0)
    points = np.vstack([at(0.1, S / 2, 4.0), at(0.1, S / 2, 6.0), [[np.nan, 0.0, 0.0]]])
    few = measured(points, shape)
    assert few.front["front_max"] == pytest.approx(
        few.max_distance / (1 if shape is BOX else round(shape.angle * 18 / np.pi))
    )
    assert "NaN" not in json.dumps(few.scalars())


@pytest.mark.parametrize(("point", "degrees"), [([0.15, S / 2, -1e-9], 5.0), ([-1e-9, S / 2, 0.15], 85.0)])
def test_a_point_beyond_a_wall_by_round_off_is_in_the_adjacent_sector(point: list[float], degrees: float) -> None:
    deposit = layer(lambda azimuth: np.where(np.abs(np.degrees(azimuth) - degrees) < 5.0, 0.2, 0.1))
    assert measured(np.vstack([deposit, [point]])).front == measured(deposit).front


def test_columns_have_distinct_indices_from_zero() -> None:
    x, _, z = np.meshgrid([-2.5, -0.5, 0.5, 1.5], [0.0, 1.0], [-1.5, 0.5], indexing="ij")
    numbers = column_index(np.column_stack([x.ravel(), 0.0 * x.ravel(), z.ravel()]), 1.0, FULL)
    assert numbers.min() == 0 and len(np.unique(numbers)) == 8


def test_results_have_mean_and_range_in_3d_and_single_numbers_in_2d() -> None:
    scalars = json.loads(json.dumps(measured(cone()).scalars()))
    for name in FRONTS:
        assert set(scalars["zeta"][name]) == set(scalars["front"][name]) == {"mean", "min", "max"}
        assert scalars["front"][name]["min"] < scalars["front"][name]["mean"] < scalars["front"][name]["max"]
        assert scalars["zeta"][name]["max"] == pytest.approx(scalars["front"][name]["max"] / 0.1 - 1.0)
    flat = measure(np.array([[0.001, 0.001]]), np.ones(1), None, ROUND).scalars()
    assert set(flat) == set(scalars) and all(isinstance(value, float) for value in flat["zeta"].values())
