"""Mesh-dependent strain localisation under softening."""

from __future__ import annotations

from functools import partial

import numpy as np

from mpmcol.failure_modes.problems.compression import compressed
from mpmcol.failure_modes.scenario import Observation, Scenario, Theory, failing, passing

COARSE, FINE, RATE = 0.02, 0.01, 20.0
AFTER_PEAK = slice(3, 10)  # shortening of 1.5 to 5 %


def strength_change(rate: float) -> Observation:
    """Relative change of the strength after the peak, from the coarse grid to the fine one with this softening rate."""
    coarse, fine = compressed(COARSE, RATE), compressed(FINE, rate)
    ratio = float(np.mean(fine.strength[AFTER_PEAK]) / np.mean(coarse.strength[AFTER_PEAK]))
    return Observation(abs(ratio - 1.0), f"band {1e3 * fine.band:.0f} mm", (fine.shortening, fine.strength))


def reference() -> Observation:
    """The coarse grid, with which the fine one is compared."""
    coarse = compressed(COARSE, RATE)
    return Observation(0.0, f"band {1e3 * coarse.band:.0f} mm", (coarse.shortening, coarse.strength))


def band_ratio() -> float:
    """Width of the shear band on the fine grid over that on the coarse one."""
    return compressed(FINE, RATE).band / compressed(COARSE, RATE).band


SCENARIOS = (
    Scenario(
        name="softening",
        mechanism="Softening sand localises in a shear band a few cells wide: on a finer grid the band is narrower "
        "and softens earlier.",
        metric="relative change of the strength after the peak when the spacing is halved",
        bound=0.07,
        source="chosen here, between a softening rate that is scaled with the spacing and one that is not",
        remedy="material.softening_rate in proportion to grid.spacing, so that a band softens after the same slip",
        trials=(
            failing(f"beta = {RATE:g}, h = 10 mm", partial(strength_change, RATE), default=True),
            passing(f"beta = {RATE * FINE / COARSE:g}, h = 10 mm", partial(strength_change, RATE * FINE / COARSE)),
            passing(f"beta = {RATE:g}, h = 20 mm (reference)", reference),
        ),
        theory=(
            Theory(
                "width of the band, h = 10 mm over h = 20 mm",
                FINE / COARSE,
                band_ratio,
                "derived here: the local softening law contains no length, so that the band width is proportional to h",
            ),
        ),
        slow=True,
        axes=("shortening over height (-)", "stress over cohesion (-)"),
    ),
)
