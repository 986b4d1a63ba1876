"""Undisturbed surface, potential energy and boxes in 3D, with known results."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from mpmcol.measure import FRONTS, ColumnShape, undisturbed_radius
from tests.support.deposits_3d import BOX, DENSITY, FULL, QUARTER, ROUND, S, at, cylinder, lattice, measured


@pytest.mark.parametrize("shape", [QUARTER, FULL, ROUND])
@pytest.mark.parametrize("radius", [0.03, 0.05, 0.0625])
def test_the_undisturbed_radius_is_that_of_the_displacement_field_in_every_model(
    shape: ColumnShape, radius: float
) -> None:
    points = cylinder(shape)
    if shape is ROUND:
        points = np.unique(cylinder() * (1.0, 1.0, 0.0), axis=0)[:, :2]
    distance = np.hypot(points[:, 0], points[:, 2] if shape.dimension == 3 else 0.0)
    displacement = np.zeros_like(points)
    displacement[distance > radius, 1] = -0.011 * shape.r_i
    found = undisturbed_radius(points + displacement, displacement, shape)
    assert found == pytest.approx(radius, abs=1e-9 if shape is ROUND else 0.1 * S)
    still = undisturbed_radius(points + 0.9 * displacement, 0.9 * displacement, shape)
    assert still == pytest.approx(0.1, abs=0.5 * S)
    all_moved = np.full_like(points, 0.01)
    assert undisturbed_radius(points + all_moved, all_moved, shape) == 0.0


def test_one_displaced_point_of_the_top_surface_limits_the_undisturbed_radius() -> None:
    points = cylinder()
    displacement = np.zeros_like(points)
    displacement[points[:, 1] < 0.05] = 0.01  # below the surface
    assert undisturbed_radius(points + displacement, displacement, QUARTER) == pytest.approx(0.1, abs=0.5 * S)
    spot = np.argmin(np.linalg.norm(points - at(0.04, 0.06, 70.0), axis=1))
    displacement[spot] = (0.0, 0.0, 0.002)
    found = undisturbed_radius(points + displacement, displacement, QUARTER)
    assert found == pytest.approx(np.hypot(points[spot, 0], points[spot, 2]), abs=0.2 * S)


@pytest.mark.parametrize(
    "shape", [QUARTER, FULL, BOX, replace(BOX, model="full"), ROUND, replace(ROUND, model="plane")], ids=str
)
def test_the_potential_energy_is_that_of_the_points(shape: ColumnShape) -> None:
    size, radius = 0.001, shape.r_i
    x, y, z = np.meshgrid(*(np.arange(size / 2, end, size) for end in (radius, shape.h_i, radius)), indexing="ij")
    volume = size**3 * {"quarter": 1, "full": 4}.get(shape.model, 1)
    if shape.section == "box" and shape.dimension == 3:
        volume = volume * (z < shape.half_depth)
    elif shape.dimension == 3:
        volume = volume * (np.hypot(x, z) < radius)
    else:
        volume = size**2 * (x if shape is ROUND else 1.0) * (z < size)
    assert shape.potential_energy(9.81) == pytest.approx(DENSITY * 9.81 * (volume * y).sum(), rel=2e-3)


def box(length: Callable[[np.ndarray], np.ndarray], shape: ColumnShape = BOX) -> np.ndarray:
    """A layer with the height of the column that ends at the distance `length` of (x, z)."""
    points = lattice(0.2, BOX.h_i, lambda r, y, azimuth: y < np.inf, shape)
    return points[np.abs(points[:, 0]) < length(points[:, [0, 2]])]


@pytest.mark.parametrize("model", ["quarter", "full"])
def test_a_box_is_measured_along_x_in_its_central_strip(model: str) -> None:
    shape = replace(BOX, model=model)
    wings = box(lambda xz: np.where(np.abs(xz[:, 1]) < 0.025, 0.1, 0.18), shape)  # longer outside the strip
    result = measured(wings, shape)
    assert result.front == pytest.approx(dict.fromkeys(FRONTS, 0.1))
    assert result.profile_y[:18] == pytest.approx(np.full(18, BOX.h_i))
    assert (result.beta, result.area_factor) == pytest.approx((1.0, 1.0))
    assert result.front_range is not None
    low, high = result.front_range["front_max"]
    assert (low == high) or model == "full"  # a quarter has one side only
    assert replace(shape, depth=None).half_depth == shape.r_i


def test_the_two_sides_of_a_box_are_measured_separately() -> None:
    shape = replace(BOX, model="full")
    result = measured(box(lambda xz: np.where(xz[:, 0] < 0.0, 0.12, 0.16), shape), shape)
    assert result.front == pytest.approx(dict.fromkeys(FRONTS, 0.14))
    assert result.front_range == {name: pytest.approx((0.12, 0.16)) for name in FRONTS}


def test_the_undisturbed_length_of_a_box_is_measured_along_x_in_its_central_strip() -> None:
    points = box(lambda xz: np.full(len(xz), 0.1))
    displacement = np.zeros_like(points)
    displacement[(points[:, 0] > 0.04) | (points[:, 2] > 0.025)] = (0.002, 0.0, 0.0)
    assert undisturbed_radius(points + displacement, displacement, BOX) == pytest.approx(0.04)
