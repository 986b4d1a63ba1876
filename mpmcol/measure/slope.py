"""Slope of a deposit."""

from __future__ import annotations

import numpy as np

from mpmcol.measure.sections import Array

FLANK = 0.2, 0.8  # of the height: without the rounded top and the thin front
MIN_BINS = 3


def repose_angle(profile_x: Array, profile_y: Array) -> float | None:
    """Inclination of the flank of a deposit by linear regression, degrees.

    The flank is the first part outward from the top whose height is within FLANK of that of the top.

    Args:
        profile_x: bin centres from the wall or axis outward, (bins,), m.
        profile_y: height of each bin, (bins,), m.

    Returns:
        None where the flank has fewer than MIN_BINS bins.
    """
    if not profile_y.any():
        return None
    top = int(profile_y.argmax())
    x, y = profile_x[top:], profile_y[top:] / profile_y[top]
    lowest, highest = FLANK
    end = int(np.argmax(y < lowest)) if (y < lowest).any() else len(y)
    flank = np.flatnonzero(y[:end] <= highest)
    if len(flank) < MIN_BINS:
        return None
    flank = np.arange(flank[0], end)
    slope = np.polyfit(x[flank], profile_y[top:][flank], 1)[0]
    return float(np.degrees(np.arctan(-slope)))
