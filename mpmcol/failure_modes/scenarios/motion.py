"""Position update in free fall, volume under rotation, and elastic stress under large shear."""

from __future__ import annotations

from functools import partial

import numpy as np

from mpmcol.failure_modes.problems.disc import volume_drift
from mpmcol.failure_modes.problems.fall import thrown_block
from mpmcol.failure_modes.scenario import Observation, Scenario, Theory, failing, passing
from mpmcol.failure_modes.toolkit import PLAIN, WEIGHTLESS, Body, G, advance_steps, by_id, elastic_body, sand_body
from mpmcol.mpm.kernels.stress import make_stress_update
from mpmcol.setup.model import POSITION_FACTORS

SHEAR, STEP = 10.0, 5e-3  # largest shear strain, and its increment per step
PRESSURE = 1e4  # Pa
JAUMANN = "derived here from Eq. 33, 34: tau = G sin(gamma) (README.md, Jaumann rate)"
LEAD = "derived here: -+ 1/2 g dt^2 per step (README.md, position update)"


def lead(rule: str) -> float:
    """Distance of a falling block ahead of the exact parabola after 200 steps, over 1/2 g dt t."""
    solver, start = thrown_block((0.0, 0.0), PLAIN._replace(position_factor=POSITION_FACTORS[rule]))
    sum_dt2 = 0.0
    for _ in range(200):
        sum_dt2 += solver.dt**2
        advance_steps(solver, 1)
    fallen = float(np.mean(start.x[:, 1] - by_id(solver).x[:, 1]))
    return (fallen - 0.5 * G * solver.time**2) / (0.5 * G * sum_dt2)


def position_error(rule: str) -> float:
    """Distance of a falling block from the exact parabola, over 1/2 g dt t."""
    return abs(lead(rule))


def volume_gain(cfl: float, exponential: bool = False) -> float:
    """Relative growth of the volume of a disc in one turn."""
    return abs(volume_drift(cfl, exponential).counted)


def excess_over_theory(cfl: float) -> float:
    """Growth of the volume in excess of that of the motion, over the sum of omega^2 dt^2."""
    found = volume_drift(cfl)
    return (found.counted - found.exponential) / found.theory


def sheared(body: Body) -> Observation:
    """Simple shear of one material point under pressure: largest negative shear stress over G."""
    stress_update = make_stress_update(2, body.law)
    s, J, opening, history = (-PRESSURE, -PRESSURE, -PRESSURE, 0.0), 1.0, 0.0, (0.0, 0.0)
    shear, taus = np.arange(STEP, SHEAR, STEP), []
    for _ in shear:
        L = (0.0, 1.0, 0.0, 0.0, 0.0)
        s, J, opening, history, _ = stress_update(s, L, 1.0, J, opening, history, body.params, WEIGHTLESS, STEP)
        taus.append(s[3] / body.params.shear_modulus)
    return Observation(-min(taus), f"largest positive {max(taus):.3g}", (shear, np.array(taus)))


def largest_shear_stress() -> float:
    """Largest shear stress of the elastic law, over G."""
    found = sheared(elastic_body()).curve
    return float(found[1].max()) if found else float("nan")


SCENARIOS = (
    Scenario(
        name="position-update",
        mechanism="A position update with the velocity before or after the step lags behind or leads the exact motion "
        "under constant acceleration.",
        metric="distance from the parabola of free fall, over 1/2 g dt t",
        bound=1e-6,
        source="derived here: the trapezoidal rule is exact under constant acceleration",
        remedy="method.position_update = trapezoid (default)",
        trials=(
            failing("paper, Eq. 27 as printed", partial(position_error, "paper")),
            failing("end", partial(position_error, "end")),
            passing("trapezoid", partial(position_error, "trapezoid"), default=True),
        ),
        theory=(
            Theory("Eq. 27 as printed: lead over 1/2 g dt t", -1.0, partial(lead, "paper"), LEAD, 1e-6),
            Theory("end velocity: lead over 1/2 g dt t", 1.0, partial(lead, "end"), LEAD, 1e-6),
        ),
    ),
    Scenario(
        name="rotation-volume",
        mechanism="For a rotation det(I + dt L) is 1 + omega^2 dt^2, not 1: the volume of a rotating body grows.",
        metric="relative growth of the volume of a disc in one turn",
        bound=0.01,
        source="chosen here: 1 %; the elastic disc itself expands by 0.2 %",
        remedy="method.volume_update = exponential, or a proportionally smaller time step; not needed for a column of "
        "sand, which hardly rotates",
        trials=(
            failing("det(I + dt L), cfl = 0.5", partial(volume_gain, 0.5), default=True),
            passing("det(I + dt L), cfl = 0.2", partial(volume_gain, 0.2)),
            passing("exp(dt tr L), cfl = 0.5", partial(volume_gain, 0.5, exponential=True)),
        ),
        theory=(
            Theory(
                "growth in excess of the motion, over the sum of omega^2 dt^2",
                1.0,
                partial(excess_over_theory, 0.5),
                "derived here from Eq. 29: det(I + dt W) = 1 + omega^2 dt^2 for the spin W of a plane rotation",
            ),
        ),
        slow=True,
    ),
    Scenario(
        name="shear-jaumann",
        mechanism="With the Jaumann rate the elastic shear stress oscillates: beyond a shear strain of pi it acts in "
        "the direction of shear.",
        metric="largest negative shear stress up to a shear strain of 10, over G",
        bound=0.0,
        source="dissipation inequality: the shear stress opposes the shear",
        remedy="none needed for sand, whose elastic strains stay small; use a hyperelastic law for large elastic "
        "strains",
        trials=(
            failing("elastic", partial(sheared, elastic_body())),
            passing("mohr-coulomb", partial(sheared, sand_body()), default=True),
        ),
        theory=(Theory("largest shear stress of the elastic law, over G", 1.0, largest_shear_stress, JAUMANN),),
        axes=("shear strain (-)", "shear stress over G (-)"),
    ),
)
