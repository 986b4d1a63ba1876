"""Particles near walls and the axis, where the corrected shape functions are linear, and walls without thickness.

The weight of the nearest interior node vanishes with the distance, its gradient does not, so that the particle becomes
stiffer; near the axis the hoop strain adds to it.
"""

from __future__ import annotations

from functools import partial

from mpmcol.failure_modes.problems.single_particle import growth
from mpmcol.failure_modes.problems.thin_wall import transmitted_speed
from mpmcol.failure_modes.scenario import Scenario, failing, passing
from mpmcol.failure_modes.scenarios.single_particle import DEFAULT_CFL, limit_trials, stability_scenario
from mpmcol.mpm.boundary import AXIS_GAP, FREE, ROLLER, WALL_GAP
from mpmcol.setup.stability_limit import MIDWAY, SingleParticle

IN_3D = (MIDWAY, MIDWAY)
AXIS, ONE_WALL = (ROLLER, FREE), (ROLLER, FREE, FREE)
DEFAULT_SUFFICES = "a particle inside a body shares the mass of its nodes and stays stable at the default"


def _scenario(name: str, position: str, particle: SingleParticle, default_passes: bool, remedy: str) -> Scenario:
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
        SingleParticle((WALL_GAP, *IN_3D), faces=ONE_WALL), True,
        "the solver keeps points 0.1 h away from walls; at 0.05 h the limit would be 0.45",
    ),
    _scenario(
        "wall-corner", f"{WALL_GAP} h from each of three smooth walls, nu = 0.3",
        SingleParticle((WALL_GAP,) * 3, nu=0.3, faces=(ROLLER,) * 3), False,
        f"time.cfl = 0.44, as the warning of a run states; {DEFAULT_SUFFICES}",
    ),
    _scenario(
        "axis-default", f"{AXIS_GAP} h from the axis, the smallest distance with four points per cell, nu = 0.2",
        SingleParticle((AXIS_GAP, MIDWAY), axisymmetric=True, faces=AXIS), True,
        "the solver keeps points 0.2 h away from the axis; at 0.05 h the limit would be 0.28",
    ),
    _scenario(
        "axis-stiff", f"{AXIS_GAP} h from the axis, nu = 0.35",
        SingleParticle((AXIS_GAP, MIDWAY), nu=0.35, axisymmetric=True, faces=AXIS), False,
        f"time.cfl = 0.44, as the warning of a run states; {DEFAULT_SUFFICES}",
    ),
    _scenario(
        "axis-dense", "h / 8 from the axis, the first of sixteen points per cell, nu = 0.2",
        SingleParticle((0.125, MIDWAY), axisymmetric=True, faces=AXIS), False,
        f"time.cfl = 0.41, as the warning of a run states, or four points per cell; {DEFAULT_SUFFICES}",
    ),
    Scenario(
        "wall-thin",
        "An elastic block hits one side of a wall, and another one touches the other side: splines are three nodes "
        "wide, so that both have common nodes on the two sides of a single line of held nodes.",
        "largest speed of the block behind the wall, over that of the one that hits it", 1e-9,
        "a rigid wall transmits nothing; round-off",
        "walls of whole cells, at least two, with shape functions that end on their faces, as [[walls]] of a case has",
        (
            failing("one line of held nodes", partial(transmitted_speed, 0)),
            passing("two cells, as in a case", partial(transmitted_speed, 2), default=True),
        ),
    ),
)  # fmt: skip
