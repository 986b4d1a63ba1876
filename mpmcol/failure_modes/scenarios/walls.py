"""Lone points beside walls and the axis: hats are stiffer there than splines, and the axis adds the hoop strain."""

from __future__ import annotations

from functools import partial

from mpmcol.failure_modes.problems.single_particle import GROWN, growth
from mpmcol.failure_modes.scenario import Scene, Trial
from mpmcol.failure_modes.scenarios.time_step import DEFAULT_CFL, SIGN, SOURCE, UNIT, bound_theory, lone_point_trials
from mpmcol.mpm.kernels.transfer_common import WALL_GAP
from mpmcol.setup.stability_limit import BETWEEN, FREE, SMOOTH, LonePoint
from mpmcol.setup.time_step import AXIS_GAP

IN_3D = (BETWEEN, BETWEEN)
AXIS, BESIDE = (SMOOTH, FREE), (SMOOTH, FREE, FREE)
BODIES = "columns come to rest in the same place with either, for only a lone grain has its nodes for itself"


def _scene(name: str, where: str, point: LonePoint, default_stands: bool, remedy: str) -> Scene:
    """A lone point there, tried on both sides of its bound and at the default; a body there shares its nodes' mass."""
    mechanism = f"A lone point {where}: its hat's weight falls with the distance, its gradient does not."
    body = partial(growth, point, DEFAULT_CFL, neighbours=5)
    trials = (
        *lone_point_trials(point, default_stands),
        Trial(f"cfl = {DEFAULT_CFL}, the point in a body", True, body, default=True),
    )
    return Scene(
        name=name,
        mechanism=mechanism,
        sign=SIGN,
        unit=UNIT,
        bound=GROWN,
        source=SOURCE,
        remedy=remedy,
        trials=trials,
        theory=bound_theory(point),
    )


SCENES = (
    _scene(
        "wall-one", f"{WALL_GAP} h from a smooth wall, where the solver keeps it, nu = 0.2",
        LonePoint((WALL_GAP, *IN_3D), walls=BESIDE), True,
        "points are kept 0.1 h off walls; at 0.05 h the bound would be 0.45",
    ),
    _scene(
        "wall-corner", f"{WALL_GAP} h from each of three smooth walls, nu = 0.3",
        LonePoint((WALL_GAP,) * 3, nu=0.3, walls=(SMOOTH,) * 3), False,
        f"time.cfl = 0.44, as the run says; {BODIES}",
    ),
    _scene(
        "axis-default", f"{AXIS_GAP} h from the axis, where the solver keeps it with four points a cell, nu = 0.2",
        LonePoint((AXIS_GAP, BETWEEN), axisymmetric=True, walls=AXIS), True,
        "points are kept 0.2 h off the axis; at 0.05 h the bound would be 0.28",
    ),
    _scene(
        "axis-stiff", f"{AXIS_GAP} h from the axis, nu = 0.35",
        LonePoint((AXIS_GAP, BETWEEN), nu=0.35, axisymmetric=True, walls=AXIS), False,
        f"time.cfl = 0.44, as the run says; {BODIES}",
    ),
    _scene(
        "axis-dense", "h / 8 from the axis, where the first of sixteen points a cell is, nu = 0.2",
        LonePoint((0.125, BETWEEN), axisymmetric=True, walls=AXIS), False,
        f"time.cfl = 0.41, as the run says, or four points a cell; {BODIES}",
    ),
)  # fmt: skip
