"""Gaps between points where material is stretched: filled in the image with the colours around them."""

from __future__ import annotations

import numpy as np

WIDEST_GAP = 1.2  # of the diameter of a point as drawn: wider gaps are between parts that have separated


def fill_gaps(colors: np.ndarray, covered: np.ndarray, diameter: float) -> np.ndarray:
    """Fill the gaps between points in place, and return the mask of points and gaps, (rows, columns).

    Gaps that are narrower than WIDEST_GAP diameters are filled with the mean of the covered pixels nearby: the pixels
    that a morphological closing adds to the mask.

    Args:
        colors: (rows, columns, 3), 0 to 255.
        covered: mask of the pixels that points cover, (rows, columns).
        diameter: of a point, pixels.
    """
    from scipy.ndimage import maximum_filter, minimum_filter, uniform_filter  # here, since it takes long to import

    size = round(WIDEST_GAP * diameter) // 2 * 2 + 1  # odd
    mask = covered.astype(np.uint8)
    # beyond the image there is no material: a dilation that reached its border would stay
    closed = minimum_filter(maximum_filter(mask, size, mode="constant"), size, mode="constant") > 0
    closed |= covered
    gaps = closed & ~covered
    if gaps.any():
        rows, columns = (slice(max(found.min() - size, 0), found.max() + size + 1) for found in np.nonzero(gaps))
        inside = np.s_[rows, columns]
        weight = covered[inside].astype(np.float32)
        total = np.maximum(uniform_filter(weight, size), np.float32(1e-6))
        for channel in range(3):
            mean = uniform_filter(colors[*inside, channel] * weight, size) / total
            colors[*inside, channel][gaps[inside]] = np.rint(mean[gaps[inside]]).astype(np.uint8)
    return closed
