"""Coulomb friction on a plate that is hit."""

from __future__ import annotations

from functools import partial

from mpmcol.failure_modes.problems.impact import MU, impact
from mpmcol.failure_modes.scenario import Observation, Scenario, failing, passing


def lost_friction(rows: int) -> Observation:
    """Part of mu times the normal impulse that the plate does not exert along it."""
    found = impact(rows)
    return Observation(abs(1.0 - found.tangential / (MU * found.normal)), f"normal impulse {found.normal:.4g} N s/m")


def lost_friction_of_acceleration(rows: int) -> Observation:
    """The same if friction is limited by mu times the force on the plate, without the momentum of its nodes."""
    found = impact(rows)
    return Observation(1.0 - found.of_acceleration / found.normal, f"of {found.normal:.4g} N s/m")


SCENARIOS = (
    Scenario(
        name="impact-friction",
        mechanism="Friction limited by mu times the normal acceleration of a node ignores the momentum with which it "
        "arrives: a thin sheet or single grains that hit a plate slide on with too little friction.",
        metric="lost part of the tangential impulse mu J_n",
        bound=0.05,
        source="chosen here: 5 %; Coulomb friction of a sliding sheet is mu J_n",
        remedy="the solver limits friction by mu times the whole normal impulse, mpmcol/mpm/contact.py; the "
        "loss of a sheet of eight rows would be 5 %",
        trials=(
            failing("normal impulse of the acceleration, one row", partial(lost_friction_of_acceleration, 1)),
            failing("normal impulse of the acceleration, two rows", partial(lost_friction_of_acceleration, 2)),
            passing("normal impulse with the momentum, one row", partial(lost_friction, 1), default=True),
        ),
    ),
)
