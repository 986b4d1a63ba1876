"""Coulomb friction on a plate that is hit, and on the side walls of a channel."""

from __future__ import annotations

from functools import partial

from mpmcol.failure_modes.problems.impact import MU, impact
from mpmcol.failure_modes.problems.side_walls import DECELERATION, STOP_STEPS, slide
from mpmcol.failure_modes.scenario import Observation, Scenario, Theory, failing, passing


def lost_friction(rows: int) -> Observation:
    """Part of mu times the normal impulse that the plate does not exert along it."""
    found = impact(rows)
    return Observation(abs(1.0 - found.tangential / (MU * found.normal)), f"normal impulse {found.normal:.4g} N s/m")


def lost_friction_of_acceleration(rows: int) -> Observation:
    """The same if friction is limited by mu times the force on the plate, without the momentum of its nodes."""
    found = impact(rows)
    return Observation(1.0 - found.of_acceleration / found.normal, f"of {found.normal:.4g} N s/m")


def remaining_speed(limited: bool) -> float:
    """Speed after the stop, over the initial one, of a block that the side walls of a channel slow."""
    return slide(limited).speed


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
    Scenario(
        name="side-walls-reversal",
        mechanism="The friction of side walls as a body force is opposite to the velocity: in the step in which it "
        "stops a point, a force that is not limited reverses the motion, and the point never comes to rest.",
        metric="largest speed after the stop, over the initial one",
        bound=1e-9,
        source=f"friction stops a body; the block would stop in {STOP_STEPS} steps; round-off",
        remedy="the solver limits the impulse to the momentum of each point, mpmcol/mpm/kernels/side_walls.py",
        trials=(
            failing("unlimited body force", partial(remaining_speed, False)),
            passing("impulse limited by the momentum", partial(remaining_speed, True), default=True),
        ),
        theory=(
            Theory(
                "deceleration (m/s2)",
                DECELERATION,
                lambda: slide(True).deceleration,
                "2 mu p / (rho W)",
                1e-6,
            ),
        ),
    ),
)
