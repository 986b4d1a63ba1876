"""Slopes in a grid that is not aligned with them."""

from __future__ import annotations

from functools import partial

from mpmcol.failure_modes.problems.slope import SLOPE_DEG, acceleration
from mpmcol.failure_modes.scenario import Scenario, failing, passing


def lost_acceleration(with_steps: bool) -> float:
    """Part of g sin(slope) by which a block on a smooth slope does not accelerate."""
    return abs(1.0 - acceleration(with_steps))


SCENARIOS = (
    Scenario(
        name="slope-steps",
        mechanism="A smooth slope in a grid aligned with gravity is a row of steps: their faces are horizontal and "
        "vertical, so that they exert no force along the slope other than by its edges, and a block does not slide.",
        metric="lost part of the acceleration g sin(slope)",
        bound=0.01,
        source=f"chosen here: 1 %; a block slides without friction at g sin(slope), here {SLOPE_DEG:.3g} degrees",
        remedy="geometry.slope_deg turns gravity, and the grid is aligned with the base",
        trials=(
            failing("steps of one cell", partial(lost_acceleration, True)),
            passing("gravity turned", partial(lost_acceleration, False), default=True),
        ),
    ),
)
