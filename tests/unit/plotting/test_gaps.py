"""Gaps between points in images are filled, and the space between separated parts is not."""

from __future__ import annotations

import numpy as np
import pytest

from mpmcol.plotting.render.gaps import fill_gaps

DIAMETER = 10


def columns(gap: int) -> tuple[np.ndarray, np.ndarray]:
    """Two columns of points, red and blue, with this gap between them, pixels."""
    covered = np.zeros((60, 100), bool)
    covered[10:50, 20:40] = covered[10:50, 40 + gap : 60 + gap] = True
    colors = np.zeros((60, 100, 3), np.uint8)
    colors[:, :40, 0], colors[:, 40:, 2] = 200, 100
    colors[~covered] = 255
    return colors, covered


@pytest.mark.parametrize("gap", [1, 5, 10])
def test_a_narrow_gap_is_filled_with_the_colours_around_it(gap: int) -> None:
    colors, covered = columns(gap)
    before = colors.copy()
    filled = fill_gaps(colors, covered, DIAMETER)
    assert filled[10:50, 20 : 60 + gap].all() and not filled[:10].any() and not filled[:, :20].any()
    middle = colors[30, 40 + gap // 2]
    assert middle[1] == 0 and 0 < middle[0] < 200 and 0 < middle[2] < 100
    np.testing.assert_array_equal(colors[covered], before[covered])
    np.testing.assert_array_equal(colors[~filled], before[~filled])


def test_a_wide_gap_remains() -> None:
    colors, covered = columns(20)
    before = colors.copy()
    np.testing.assert_array_equal(fill_gaps(colors, covered, DIAMETER), covered)
    np.testing.assert_array_equal(colors, before)


def test_an_empty_image_remains() -> None:
    colors, covered = np.full((20, 30, 3), 255, np.uint8), np.zeros((20, 30), bool)
    assert not fill_gaps(colors, covered, DIAMETER).any() and np.all(colors == 255)


def test_points_at_the_border_of_the_image_remain() -> None:
    colors, covered = np.full((20, 30, 3), 255, np.uint8), np.zeros((20, 30), bool)
    covered[:, :5] = covered[:3] = True
    assert (fill_gaps(colors, covered, 2) >= covered).all()


def test_nothing_is_added_between_points_and_a_border_of_the_image_near_them() -> None:
    colors, covered = np.full((40, 60, 3), 255, np.uint8), np.zeros((40, 60), bool)
    covered[10:36, 10:50] = True
    assert np.array_equal(fill_gaps(colors, covered, 10), covered) and np.all(colors == 255)
