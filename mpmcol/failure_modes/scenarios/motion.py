"""Position rules in free fall, volume of what turns, stress of what is sheared without end."""

from __future__ import annotations

from functools import partial

import numpy as np

from mpmcol.failure_modes.problems.disc import volume_drift
from mpmcol.failure_modes.problems.fall import thrown_block
from mpmcol.failure_modes.scenario import Reading, Scene, Theory, Trial
from mpmcol.failure_modes.toolkit import PLAIN, WEIGHTLESS, Body, G, advance_steps, by_id, elastic_body, sand_body
from mpmcol.mpm.kernels.stress_2d import make_formula
from mpmcol.setup.model import POSITION_FACTORS

SHEAR, STEP = 10.0, 5e-3
PRESSURE = 1e4  # Pa


def lag(rule: str) -> float:
    """How far a falling block is ahead of its parabola after 200 steps, over 1/2 g dt t."""
    solver, start = thrown_block((0.0, 0.0), PLAIN._replace(position_factor=POSITION_FACTORS[rule]))
    sum_dt2 = 0.0
    for _ in range(200):
        sum_dt2 += solver.dt**2
        advance_steps(solver, 1)
    fallen = float(np.mean(start.x[:, 1] - by_id(solver).x[:, 1]))
    return (fallen - 0.5 * G * solver.time**2) / (0.5 * G * sum_dt2)


def position_error(rule: str) -> float:
    """Of a falling block, over 1/2 g dt t."""
    return abs(lag(rule))


def drift(cfl: float, exponential: bool = False) -> float:
    """Relative growth of the disc's volume in a turn."""
    return abs(volume_drift(cfl, exponential).counted)


def excess_over_theory(cfl: float) -> float:
    """Growth of the volume as counted beyond that of the motion, over the sum of omega^2 dt^2."""
    found = volume_drift(cfl)
    return (found.counted - found.exponential) / found.theory


def sheared(body: Body) -> Reading:
    """Simple shear of one point under pressure: the most negative shear stress on the way, over G."""
    formula = make_formula(body.law)
    s, J, opening, history = (-PRESSURE, -PRESSURE, -PRESSURE, 0.0), 1.0, 0.0, (0.0, 0.0)
    shear, taus = np.arange(STEP, SHEAR, STEP), []
    for _ in shear:
        L = (0.0, 1.0, 0.0, 0.0, 0.0)
        s, J, opening, history, _ = formula(s, L, 1.0, J, opening, history, body.params, WEIGHTLESS, STEP)
        taus.append(s[3] / body.params.shear_modulus)
    return Reading(-min(taus), f"largest {max(taus):.3g}", (shear, np.array(taus)))


def largest_shear_stress() -> float:
    """Of the elastic law, over G."""
    found = sheared(elastic_body()).curve
    return float(found[1].max()) if found else float("nan")


SCENES = (
    Scene(
        name="position-rule",
        mechanism="A point moved with the velocity before or after the step lags behind or runs ahead of its own "
        "acceleration.",
        sign="distance from the parabola of free fall, over 1/2 g dt t",
        unit="",
        bound=1e-6,
        source="the trapezoid is exact under constant acceleration",
        remedy="method.position_update = trapezoid, the default",
        trials=(
            Trial("paper, Eq. 27 as printed", False, partial(position_error, "paper")),
            Trial("end", False, partial(position_error, "end")),
            Trial("trapezoid", True, partial(position_error, "trapezoid"), default=True),
        ),
        theory=(
            Theory("lag of Eq. 27 as printed, over 1/2 g dt t", -1.0, partial(lag, "paper"), "physics 5.2, 11", 1e-6),
            Theory("lead of the end velocity, over 1/2 g dt t", 1.0, partial(lag, "end"), "physics 5.2, 11", 1e-6),
        ),
    ),
    Scene(
        name="rotation-volume",
        mechanism="det(I + dt L) of a rotation is 1 + omega^2 dt^2, not 1: what turns seems to grow, turn by turn.",
        sign="relative growth of a disc's volume in one turn",
        unit="",
        bound=0.01,
        source="a hundredth; the disc itself grows by 0.2 %, breathing",
        remedy="method.volume_update = exponential, or a smaller time step, in proportion; a column of sand, which "
        "hardly turns, needs neither",
        trials=(
            Trial("det(I + dt L), cfl = 0.5", False, partial(drift, 0.5), default=True),
            Trial("det(I + dt L), cfl = 0.2", True, partial(drift, 0.2)),
            Trial("exp(dt tr L), cfl = 0.5", True, partial(drift, 0.5, exponential=True)),
        ),
        theory=(
            Theory(
                "growth beyond that of the motion, over the sum of omega^2 dt^2",
                1.0,
                partial(excess_over_theory, 0.5),
                "physics 4.3",
            ),
        ),
    ),
    Scene(
        name="shear-jaumann",
        mechanism="The Jaumann rate turns the elastic stress on for ever: sheared by more than pi, the material "
        "pushes back.",
        sign="most negative shear stress on the way to a shear of 10, over G",
        unit="",
        bound=0.0,
        source="a material resists the way it is sheared",
        remedy="harmless in sand, whose elastic strain stays small; not a law for rubber",
        trials=(
            Trial("elastic", False, partial(sheared, elastic_body())),
            Trial("mohr-coulomb", True, partial(sheared, sand_body()), default=True),
        ),
        theory=(Theory("largest shear stress of the elastic law, over G", 1.0, largest_shear_stress, "G sin(gamma)"),),
        axes=("shear strain (-)", "shear stress over G (-)"),
    ),
)
