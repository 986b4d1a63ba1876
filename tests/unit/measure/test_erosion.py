"""Erosion of a bed of which a known part has moved."""

from __future__ import annotations

import numpy as np
import pytest

from mpmcol.measure import ColumnShape, measure_erosion

S, R = 0.01, 0.1  # m: size of a point, r_i
SHAPE = ColumnShape("plane", "one-sided", r_i=R, h_i=0.1, spacing=2 * S, density=2000.0, point_size=S, bed=4 * S)


def bed() -> np.ndarray:
    """Points of a bed of 5 by 0.04 r_i, its surface at y = 0."""
    x, y = np.meshgrid(S * (np.arange(50) + 0.5), -S * (np.arange(4) + 0.5), indexing="ij")
    return np.column_stack([x.ravel(), y.ravel()])


@pytest.mark.parametrize(("share", "rows"), [(1.01, 2), (0.99, 0)])
def test_mass_and_depth_of_what_moved_by_a_hundredth_of_r_i(share: float, rows: int) -> None:
    released = bed()
    displacement = np.zeros_like(released)
    displacement[(released[:, 0] < 0.2) & (released[:, 1] > -2 * S), 0] = share * 0.01 * R
    erosion = measure_erosion(released + displacement, np.full(len(released), 0.5), displacement, SHAPE)
    assert erosion.eroded_mass == pytest.approx(0.5 * 20 * rows)
    assert erosion.eroded_depth == pytest.approx(rows * S)


def test_an_empty_bed_is_not_eroded() -> None:
    nothing = np.zeros((0, 2))
    assert vars(measure_erosion(nothing, np.zeros(0), nothing, SHAPE)) == {"eroded_mass": 0.0, "eroded_depth": 0.0}


@pytest.mark.parametrize(("rows", "through"), [(4, True), (3, False)])
def test_the_depth_is_at_most_the_thickness_of_the_bed(rows: int, through: bool) -> None:
    """Points next to the floor may have sunk by less than half their size before the release."""
    released = bed()
    released[released[:, 1] < -3 * S, 1] -= 0.4 * S
    displacement = np.zeros_like(released)
    displacement[released[:, 1] > -rows * S, 0] = R
    erosion = measure_erosion(released + displacement, np.ones(len(released)), displacement, SHAPE)
    assert erosion.eroded_depth == pytest.approx(rows * S) and erosion.reaches_floor(SHAPE) is through
