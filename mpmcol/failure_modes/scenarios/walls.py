"""Single particles near walls and the axis, where the corrected shape functions are linear.

The weight of the nearest interior node vanishes with the distance, its gradient does not, so that the particle becomes
stiffer; near the axis the hoop strain adds to it.
"""

from __future__ import annotations

from functools import partial

from mpmcol.failure_modes.problems.single_particle import growth
from mpmcol.failure_modes.scenario import Scenario, passing
from mpmcol.failure_modes.scenarios.single_particle import DEFAULT_CFL, limit_trials, stability_scenario
from mpmcol.mpm.kernels.transfer_common import WALL_GAP
from mpmcol.setup.stability_limit import BETWEEN, FREE, SMOOTH, LonePoint
from mpmcol.setup.time_step import AXIS_GAP

IN_3D = (BETWEEN, BETWEEN)
AXIS, ONE_WALL = (SMOOTH, FREE), (SMOOTH, FREE, FREE)
DEFAULT_SUFFICES = "a particle inside a body shares the mass of its nodes and stays stable at the default"


def _scenario(name: str, position: str, particle: LonePoint, default_passes: bool, remedy: str) -> Scenario:
    """The particle at its stability limit, and within a body at the default time step."""
    in_body = partial(growth, particle, DEFAULT_CFL, neighbours=5)
    return stability_scenario(
        name,
        f"A single particle {position}: the weight of its interior node decreases with the distance, "
        "the gradient does not.",
        particle,
        remedy,
        (
            *limit_trials(particle, default_passes),
            passing(f"cfl = {DEFAULT_CFL}, particle in a body", in_body, default=True),
        ),
    )


SCENARIOS = (
    _scenario(
        "wall-one", f"{WALL_GAP} h from a smooth wall, the smallest distance that the solver allows, nu = 0.2",
        LonePoint((WALL_GAP, *IN_3D), walls=ONE_WALL), True,
        "the solver keeps points 0.1 h away from walls; at 0.05 h the limit would be 0.45",
    ),
    _scenario(
        "wall-corner", f"{WALL_GAP} h from each of three smooth walls, nu = 0.3",
        LonePoint((WALL_GAP,) * 3, nu=0.3, walls=(SMOOTH,) * 3), False,
        f"time.cfl = 0.44, as the warning of a run states; {DEFAULT_SUFFICES}",
    ),
    _scenario(
        "axis-default", f"{AXIS_GAP} h from the axis, the smallest distance with four points per cell, nu = 0.2",
        LonePoint((AXIS_GAP, BETWEEN), axisymmetric=True, walls=AXIS), True,
        "the solver keeps points 0.2 h away from the axis; at 0.05 h the limit would be 0.28",
    ),
    _scenario(
        "axis-stiff", f"{AXIS_GAP} h from the axis, nu = 0.35",
        LonePoint((AXIS_GAP, BETWEEN), nu=0.35, axisymmetric=True, walls=AXIS), False,
        f"time.cfl = 0.44, as the warning of a run states; {DEFAULT_SUFFICES}",
    ),
    _scenario(
        "axis-dense", "h / 8 from the axis, the first of sixteen points per cell, nu = 0.2",
        LonePoint((0.125, BETWEEN), axisymmetric=True, walls=AXIS), False,
        f"time.cfl = 0.41, as the warning of a run states, or four points per cell; {DEFAULT_SUFFICES}",
    ),
)  # fmt: skip
