"""The angle of repose of heaps of known slope."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from mpmcol.errors import UsageError
from mpmcol.measure import ColumnShape, friction_bias, friction_from_repose, measure, repose_angle
from mpmcol.measure.slope import inner_repose_angle

X = 0.005 * (np.arange(60) + 0.5)


@pytest.mark.parametrize("degrees", [20.0, 33.0])
def test_of_a_slope_with_a_rounded_top_and_a_thin_front(degrees: float) -> None:
    height = np.clip(0.1 - np.tan(np.radians(degrees)) * X, 0.0, None)
    height[height > 0.085] = 0.085  # above 80 %: does not count
    thin = (height < 0.015) & (height > 0.0)
    height[thin] = 0.01  # below 20 %: does not count
    assert repose_angle(X, height) == pytest.approx(degrees, abs=1e-6)


def ridge(low: float, high: float) -> np.ndarray:
    """Heights of a heap with its top at x = 0.15 m, and its flanks toward smaller and larger x inclined so (deg)."""
    slopes = np.tan(np.radians(np.where(X < 0.15, low, high)))
    return np.clip(0.05 - slopes * np.abs(X - 0.15), 0.0, None)


@pytest.mark.parametrize(("low", "high"), [(25.0, 35.0), (35.0, 25.0), (30.0, 30.0)])
def test_both_flanks_of_a_heap_are_measured(low: float, high: float) -> None:
    assert repose_angle(X, ridge(low, high)) == pytest.approx(high, abs=0.5)
    assert inner_repose_angle(X, ridge(low, high)) == pytest.approx(low, abs=0.5)


def test_a_deposit_that_reaches_the_wall_has_one_flank() -> None:
    column = np.clip(0.1 - np.tan(np.radians(30.0)) * np.abs(X - 0.05), 0.0, None)
    assert inner_repose_angle(X, column) is None and inner_repose_angle(X, np.zeros_like(X)) is None


@pytest.mark.parametrize(("low", "high"), [(25.0, 35.0), (35.0, 25.0)])
def test_a_measurement_has_both_angles_and_their_mean(low: float, high: float) -> None:
    shape = ColumnShape("plane", "one-sided", r_i=0.3, h_i=0.05, spacing=0.005, density=1000.0, point_size=0.001)
    x, y = (values.ravel() for values in np.meshgrid(np.arange(0.0005, 0.3, 0.001), np.arange(0.0005, 0.05, 0.001)))
    inside = y < np.interp(x, X, ridge(low, high))
    points = np.column_stack([x, y])[inside]
    measured = measure(points, np.full(len(points), 1e-3), None, shape)
    assert measured.repose_low_x_deg == pytest.approx(low, abs=1.0)
    assert measured.repose_high_x_deg == pytest.approx(high, abs=1.0)
    assert measured.repose_angle_deg == pytest.approx(30.0, abs=1.0)


def test_a_box_that_spreads_to_both_sides_has_two_flanks() -> None:
    shape = ColumnShape(
        "full",
        "two-sided",
        r_i=0.1,
        h_i=0.05,
        spacing=0.005,
        density=1000.0,
        point_size=0.0025,
        section="box",
        depth=0.01,
    )
    axis = np.arange(-0.2 + 0.00125, 0.2, 0.0025)
    x, y, z = (
        values.ravel() for values in np.meshgrid(axis, np.arange(0.00125, 0.05, 0.0025), [-0.003, -0.001, 0.001])
    )
    slope = np.tan(np.radians(np.where(x < 0.0, 25.0, 35.0)))
    points = np.column_stack([x, y, z])[y < 0.05 - slope * np.abs(x)]
    measured = measure(points, np.full(len(points), 1e-3), None, shape)
    assert measured.repose_low_x_deg is not None and measured.repose_high_x_deg is not None
    tangents = np.tan(np.radians([measured.repose_low_x_deg, measured.repose_high_x_deg]))
    assert tangents[0] / tangents[1] == pytest.approx(np.tan(np.radians(25.0)) / np.tan(np.radians(35.0)), rel=0.1)


def test_a_second_heap_does_not_count() -> None:
    heap = np.clip(0.05 - 0.5 * X, 0.0, None)
    second = np.where((X > 0.2) & (X < 0.25), 0.03, 0.0)
    assert repose_angle(X, heap + second) == pytest.approx(np.degrees(np.arctan(0.5)))


def test_a_block_or_nothing_has_none() -> None:
    assert repose_angle(X, np.where(X < 0.1, 0.05, 0.0)) is None
    assert repose_angle(X, np.zeros_like(X)) is None


@pytest.mark.parametrize("friction", [10.0, 33.0, 89.0])
def test_the_friction_angle_of_the_steepest_slope_at_rest(friction: float) -> None:
    """On planes parallel to the shear the Mohr circle of plane flow without dilatancy has tau / sigma = sin(phi)."""
    sine = np.sin(np.radians(friction))
    centre, radius = 1.0, sine  # s = 1, t = s sin(phi); the planes of largest shear do not change in length
    steepest = np.degrees(np.arctan2(radius, centre))
    assert friction_from_repose(steepest) == pytest.approx(friction)


@pytest.mark.parametrize("repose", [0.0, -3.0, 45.0, 60.0, float("nan")])
def test_an_angle_that_no_friction_holds_is_refused(repose: float) -> None:
    with pytest.raises(UsageError, match="angle of repose .* expected an angle between 0 and 45 deg"):
        friction_from_repose(repose)


@pytest.mark.parametrize(
    ("shape", "bias"),
    [
        ({}, (-15.0, -9.0)),
        ({"h_i": 3.0}, (-15.0, -9.0)),
        ({"h_i": 3.1}, None),
        ({"h_i": 0.9}, None),
        ({"model": "axisymmetric"}, None),
        ({"spacing": 0.06}, None),
        ({"slope_deg": 10.0}, None),
        ({"section": "outline", "outline": ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))}, None),
    ],
)
def test_the_bias_is_known_for_channels_only(shape: dict[str, Any], bias: tuple[float, float] | None) -> None:
    """The table in the README of the folder has channels of a = 1 to 3: differences of -8.9 to -14.8 degrees."""
    values: dict[str, Any] = {"model": "plane", "release": "one-sided", "r_i": 1.0, "h_i": 1.0, "spacing": 0.05}
    assert friction_bias(ColumnShape(**{**values, "density": 1.0, "point_size": 0.05, **shape})) == bias


def test_the_angle_is_that_of_least_squares() -> None:
    height = ridge(25.0, 35.0) * (1.0 + 0.1 * np.sin(1e4 * X))
    top = int(height.argmax())
    share = height[top:] / height[top]
    end = int(np.argmax(share < 0.2))
    flank = top + np.arange(int(np.argmax(share <= 0.8)), end)
    slope = np.polyfit(X[flank], height[flank], 1)[0]
    assert repose_angle(X, height) == pytest.approx(np.degrees(np.arctan(-slope)), rel=1e-12)
