"""Erosion of a bed of which a known part has moved."""

from __future__ import annotations

import numpy as np
import pytest

from mpmcol.measure import ColumnShape, Material, measure_erosion, surface_over_bed

S, R = 0.01, 0.1  # m: size of a point, r_i
SHAPE = ColumnShape(
    "plane", "one-sided", r_i=R, h_i=0.1, spacing=2 * S, density=2000.0, point_size=S, bed=4 * S, bed_density=1500.0
)
NO_COLUMN = Material(np.zeros((0, 2)), np.zeros(0), np.zeros((0, 2)))


def bed() -> np.ndarray:
    """Points of a bed of 5 by 0.04 r_i, its surface at y = 0."""
    x, y = np.meshgrid(S * (np.arange(50) + 0.5), -S * (np.arange(4) + 0.5), indexing="ij")
    return np.column_stack([x.ravel(), y.ravel()])


@pytest.mark.parametrize(("share", "rows"), [(1.01, 2), (0.99, 0)])
def test_mass_and_depth_of_what_moved_by_a_hundredth_of_r_i(share: float, rows: int) -> None:
    released = bed()
    displacement = np.zeros_like(released)
    displacement[(released[:, 0] < 0.2) & (released[:, 1] > -2 * S), 0] = share * 0.01 * R
    erosion = measure_erosion(
        NO_COLUMN, Material(released + displacement, np.full(len(released), 0.5), displacement), SHAPE
    )
    assert erosion.eroded_mass == pytest.approx(0.5 * 20 * rows)
    assert erosion.eroded_depth == pytest.approx(rows * S)


def test_an_empty_bed_is_not_eroded() -> None:
    assert not any(vars(measure_erosion(NO_COLUMN, NO_COLUMN, SHAPE)).values())


@pytest.mark.parametrize(("rows", "through"), [(4, True), (3, False)])
def test_the_depth_is_at_most_the_thickness_of_the_bed(rows: int, through: bool) -> None:
    """Points next to the floor may have sunk by less than half their size before the release."""
    released = bed()
    released[released[:, 1] < -3 * S, 1] -= 0.4 * S
    displacement = np.zeros_like(released)
    displacement[released[:, 1] > -rows * S, 0] = R
    erosion = measure_erosion(NO_COLUMN, Material(released + displacement, np.ones(len(released)), displacement), SHAPE)
    assert erosion.eroded_depth == pytest.approx(rows * S) and erosion.reaches_floor(SHAPE) is through


def block(length: float, rows: int) -> Material:
    """Points of a column of this length (m) and number of rows that has not moved."""
    x, y = np.meshgrid(S * (np.arange(round(length / S)) + 0.5), S * (np.arange(rows) + 0.5), indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel()])
    return Material(points, np.full(len(points), SHAPE.density * S**2), np.zeros_like(points))


def moved_bed(rows: int, start: float, end: float, shift: float) -> Material:
    """The bed, of which the upper rows from `start` to `end` have moved by `shift` along x, onto its surface (m)."""
    released = bed()
    moved = (released[:, 0] > start) & (released[:, 0] < end) & (released[:, 1] > -rows * S)
    displacement = np.zeros_like(released)
    displacement[moved] = shift, rows * S
    return Material(released + displacement, np.full(len(released), SHAPE.bed_density * S**2), displacement)


def test_the_surface_over_the_bed_is_lower_where_material_was_taken_and_higher_where_it_lies() -> None:
    x, height = surface_over_bed(block(0.06, 3), moved_bed(2, 0.12, 0.2, shift=0.2), SHAPE)
    for low, high, expected in ((0.0, 0.04, 3 * S), (0.08, 0.1, 0.0), (0.14, 0.18, -2 * S), (0.34, 0.38, 2 * S)):
        assert height[(x > low) & (x < high)] == pytest.approx(expected)
    assert (height * SHAPE.spacing).sum() == pytest.approx(0.06 * 3 * S)  # the volume of the column


def test_lowering_and_front_of_the_deposit_over_the_old_surface() -> None:
    erosion = measure_erosion(block(0.06, 3), moved_bed(2, 0.3, 0.38, shift=0.1), SHAPE)
    assert erosion.surface_drop == pytest.approx(2 * S)
    assert erosion.deposit_front == pytest.approx(0.06, abs=SHAPE.spacing / 2.0)


def test_material_that_the_flow_pushes_ahead_belongs_to_the_deposit() -> None:
    erosion = measure_erosion(block(0.12, 4), moved_bed(2, 0.06, 0.12, shift=0.06), SHAPE)
    assert erosion.surface_drop == 0.0
    assert erosion.deposit_front == pytest.approx(0.18, abs=SHAPE.spacing / 2.0)
