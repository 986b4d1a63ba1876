"""Strain that gathers in one band as wide as the grid wants it."""

from __future__ import annotations

from functools import partial

import numpy as np

from mpmcol.failure_modes.problems.compression import compressed
from mpmcol.failure_modes.scenario import Reading, Scene, Theory, Trial

COARSE, FINE, RATE = 0.02, 0.01, 20.0
AFTER_PEAK = slice(3, 10)  # shortening of 1.5 to 5 %


def change(rate: float) -> Reading:
    """Of the strength after the peak, from the coarse grid to the fine one with this softening rate."""
    coarse, fine = compressed(COARSE, RATE), compressed(FINE, rate)
    ratio = float(np.mean(fine.strength[AFTER_PEAK]) / np.mean(coarse.strength[AFTER_PEAK]))
    return Reading(abs(ratio - 1.0), f"band {1e3 * fine.band:.0f} mm", (fine.shortening, fine.strength))


def coarse_curve() -> Reading:
    """The coarse grid, to which the fine ones are compared."""
    coarse = compressed(COARSE, RATE)
    return Reading(0.0, f"band {1e3 * coarse.band:.0f} mm", (coarse.shortening, coarse.strength))


def band_ratio() -> float:
    """Width of the band on the fine grid over that on the coarse one."""
    return compressed(FINE, RATE).band / compressed(COARSE, RATE).band


SCENES = (
    Scene(
        name="softening",
        mechanism="Sand that softens shears in one band of some cells: a finer grid has a thinner band, which softens "
        "earlier.",
        sign="change of the strength after the peak when the spacing is halved",
        unit="",
        bound=0.07,
        source="between a rate that knows the spacing and one that does not",
        remedy="material.softening_rate in proportion to grid.spacing, so that a band softens after the same slip",
        trials=(
            Trial(f"beta = {RATE:g}, h = 10 mm", False, partial(change, RATE), default=True),
            Trial(f"beta = {RATE * FINE / COARSE:g}, h = 10 mm", True, partial(change, RATE * FINE / COARSE)),
            Trial(f"beta = {RATE:g}, h = 20 mm, which the others are compared with", True, coarse_curve),
        ),
        theory=(
            Theory(
                "width of the band, h = 10 mm over h = 20 mm", FINE / COARSE, band_ratio, "width ~ h (physics 5.2, 21)"
            ),
        ),
        slow=True,
        axes=("shortening over height (-)", "stress over cohesion (-)"),
    ),
)
