"""Slope of a deposit, and the friction angle that it corresponds to."""

from __future__ import annotations

from math import atan, degrees

import numpy as np

from mpmcol.errors import UsageError
from mpmcol.measure.sections import Array
from mpmcol.measure.shape import ColumnShape

FLANK = 0.2, 0.8  # of the height: without the rounded top and the thin front
MIN_BINS = 3
STEEPEST = 45.0  # degrees: no friction angle mobilises tan(repose) > 1
BIAS = -15.0, -9.0  # of friction_from_repose for channels, degrees (table in the README of this folder)
BIAS_ASPECTS = 1.0, 3.0  # aspect ratios of these channels
BIAS_CELLS = 20.0  # their r_i / h; the flanks of coarser grids are steeper


def repose_angle(profile_x: Array, profile_y: Array) -> float | None:
    """Inclination of the flank of a deposit by linear regression, degrees.

    The flank is the first part from the top toward larger distances whose height is within FLANK of that of the top.

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
    offset = x[flank] - x[flank].mean()
    # sums, not numpy.polyfit: the last digits of LAPACK depend on the processor
    slope = float((offset * profile_y[top:][flank]).sum() / (offset**2).sum())
    return degrees(atan(-slope))


def inner_repose_angle(profile_x: Array, profile_y: Array) -> float | None:
    """As `repose_angle`, of the flank from the top toward the wall or axis; None unless the deposit ends before it."""
    top = int(profile_y.argmax())
    inner = profile_y[: top + 1]
    if not (inner < FLANK[0] * profile_y[top]).any():
        return None
    return repose_angle(profile_x[top] - profile_x[top::-1], inner[::-1])


def friction_from_repose(repose_deg: float) -> float:
    """Friction angle of a material whose steepest slope at rest has this angle: sin(phi) = tan(repose), degrees.

    In plane strain without dilatancy a Mohr-Coulomb material mobilises tau / sigma = sin(phi) in simple shear (Davis
    1968), so that a slope parallel to the direction of shear is at rest up to tan(repose) = sin(phi). A deposit of a
    collapse is flatter than this limit, since it decelerates before it comes to rest: from its angle of repose phi is
    underestimated, by 9 to 15 degrees for columns of a = 1 to 3 (table in the README of this folder).

    Args:
        repose_deg: inclination of the surface to the horizontal, degrees.

    Raises UsageError unless the angle is between 0 and 45 degrees: no friction angle mobilises tan(repose) > 1.
    """
    if not 0.0 < repose_deg < STEEPEST:
        raise UsageError(
            f"angle of repose {repose_deg:g} deg: expected an angle between 0 and {STEEPEST:g} deg to the horizontal"
        )
    return float(np.degrees(np.arcsin(np.tan(np.radians(repose_deg)))))


def friction_bias(shape: ColumnShape) -> tuple[float, float] | None:
    """Least and greatest difference of `friction_from_repose` from the friction angle of the material, degrees.

    Known for rectangular columns of a = 1 to 3 on a horizontal base in plane strain without walls, with at least
    BIAS_CELLS cells in r_i; None for others.
    """
    lowest, highest = BIAS_ASPECTS
    is_channel = shape.model == "plane" and not (shape.slope_deg or shape.obstacles)
    is_fine = shape.r_i >= (1.0 - 1e-6) * BIAS_CELLS * shape.spacing
    return BIAS if is_channel and is_fine and lowest <= (shape.rectangle_a or 0.0) <= highest else None
