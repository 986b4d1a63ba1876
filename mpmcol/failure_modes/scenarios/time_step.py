"""Time steps beyond the bound of a single point, in one dimension, plane strain, axisymmetry and three dimensions."""

from __future__ import annotations

from functools import partial

from mpmcol.failure_modes.problems.single_particle import GROWN, growth, largest_stable_step
from mpmcol.failure_modes.scenario import Scene, Theory, Trial
from mpmcol.setup.stability_limit import BETWEEN, FREE, SMOOTH, LonePoint, one_point_bound

SIGN, UNIT = "largest stress after 200 steps over that at the start", ""
SOURCE = "a mode that is stable does not grow; one 5 % beyond its bound grows by e^0.6 a step"
THEORY = "element eigenvalue theorem, eigenvalues of one point's stiffness (physics 5.1)"
DEFAULT_CFL = 0.5
POINTS = {
    "1d": (LonePoint((BETWEEN, BETWEEN), nu=0.0), "one dimension (nu = 0)"),
    "plane": (LonePoint((BETWEEN, BETWEEN)), "plane strain"),
    "axisymmetric": (
        LonePoint((1.501, BETWEEN), axisymmetric=True, walls=(SMOOTH, FREE)),
        "axisymmetry, 1.5 h off the axis",
    ),
    "3d": (LonePoint((BETWEEN, BETWEEN, BETWEEN)), "three dimensions"),
}


def lone_point_trials(point: LonePoint, default_stands: bool = True) -> tuple[Trial, ...]:
    """5 % beyond the bound, 5 % below it, and at the default."""
    bound = one_point_bound(point)
    return (
        Trial(f"cfl = {1.05 * bound:.3f}, 5 % beyond the bound", False, partial(growth, point, 1.05 * bound)),
        Trial(f"cfl = {0.95 * bound:.3f}, 5 % below it", True, partial(growth, point, 0.95 * bound)),
        Trial(f"cfl = {DEFAULT_CFL}", default_stands, partial(growth, point, DEFAULT_CFL), default=True),
    )


def bound_theory(point: LonePoint) -> tuple[Theory, ...]:
    """The bound by bisection on the kernels against that of theory."""
    number = "largest stable dt c / h by bisection"
    return (Theory(number, one_point_bound(point), partial(largest_stable_step, point), THEORY),)


SCENES = tuple(
    Scene(
        name=f"time-step-{name}",
        mechanism=f"A lone point between nodes, in {where}: its strain overshoots in every step and grows.",
        sign=SIGN,
        unit=UNIT,
        bound=GROWN,
        source=SOURCE,
        trials=lone_point_trials(point),
        theory=bound_theory(point),
        remedy="time.cfl below 0.67 in 3D and 0.73 in 2D (nu = 0.2); the default 0.5 keeps a quarter in hand",
    )
    for name, (point, where) in POINTS.items()
)
