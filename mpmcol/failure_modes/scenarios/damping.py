"""Local damping: effect on free fall, sign error of the printed form, and dependence on the frame of reference."""

from __future__ import annotations

from functools import partial

import numpy as np

from mpmcol.failure_modes.problems.fall import thrown_block
from mpmcol.failure_modes.scenario import Observation, Scenario, Theory, failing, passing
from mpmcol.failure_modes.toolkit import (
    PLAIN,
    WEIGHTLESS,
    G,
    advance_steps,
    advance_to,
    elastic_body,
    kinetic_energy,
    lattice,
    make_solver,
    points_at,
    potential_energy,
    walled_grid,
)

ALPHA = 0.05  # of stages.collapse
SPEED, STEPS = -3.0, 1000
FRAME, WAVE, H = 1.0, 0.1, 0.1  # m/s, m/s, m
TRANSITS = 20.0  # of an elastic wave through the block


def acceleration(alpha: float) -> float:
    """Acceleration of a falling block, over g."""
    solver, _ = thrown_block((0.0, SPEED), PLAIN._replace(alpha_d=alpha))
    advance_steps(solver, STEPS)
    return float((SPEED - solver.points.v[:, 1].mean()) / (G * solver.time))


def acceleration_error(alpha: float) -> float:
    """Deviation from free fall, over g."""
    return abs(1.0 - acceleration(alpha))


def energy_gain(alpha: float) -> Observation:
    """Energy gained by a falling block, over its initial kinetic energy."""
    solver, start = thrown_block((0.0, SPEED), PLAIN._replace(alpha_d=alpha))
    kinetic, times, energies = kinetic_energy(start), [0.0], [0.0]
    initial = kinetic + potential_energy(start)
    for _ in range(20):
        advance_steps(solver, STEPS // 20)
        times.append(solver.time)
        energies.append((kinetic_energy(solver.points) + potential_energy(solver.points) - initial) / kinetic)
    return Observation(energies[-1], "", (np.array(times), np.array(energies)))


def speed_loss(alpha: float) -> Observation:
    """Relative loss of speed of a vibrating block that moves freely without gravity."""
    points = points_at(lattice((0.5, 0.5), (1.5, 1.5), H / 2), H / 2)
    points.v[:, 0] = FRAME + WAVE * np.sin(np.pi * (points.x[:, 0] - 1.0))
    body = elastic_body()
    settings = WEIGHTLESS._replace(alpha_d=alpha)
    solver = make_solver(points, walled_grid((0.0, 0.0), H, (30, 20)), settings, body=body)
    times, speeds, end = [0.0], [1.0], TRANSITS / np.sqrt(body.wave_speed2)
    for k in range(1, 21):
        advance_to(solver, end * k / 20.0)
        times.append(solver.time)
        speeds.append(float(solver.points.v[:, 0].mean() / FRAME))
    return Observation(abs(1.0 - speeds[-1]), "", (np.array(times), np.array(speeds)))


SCENARIOS = (
    Scenario(
        name="damping-fall",
        mechanism="Local damping reduces every nodal force, including the weight in free fall: the acceleration is (1 "
        "- alpha_d) g.",
        metric="deviation of the acceleration from g, over g",
        bound=0.01,
        source="chosen here: 1 %, a tenth of the scatter of experiments (Bougouin & Lacaze 2018: prefactors 2.7 +- "
        "0.3 and 3.7 +- 0.3)",
        remedy="stages.collapse.damping = 0; the default is 0.05, the value of the paper, to reproduce its results",
        trials=(
            failing(f"damping = {ALPHA}", partial(acceleration_error, ALPHA), default=True),
            passing("damping = 0", partial(acceleration_error, 0.0)),
        ),
        theory=(
            Theory(
                "acceleration over g, damping = 0.05", 0.95, partial(acceleration, ALPHA), "Eq. 23: 1 - alpha_d", 1e-9
            ),
        ),
    ),
    Scenario(
        name="damping-printed",
        mechanism="Eq. 23 as printed, -alpha_d f sign(v), accelerates components with f < 0 and v < 0.",
        metric="energy gained by a falling block, over its initial kinetic energy",
        bound=1e-9,
        source="damping does not add energy",
        remedy="-alpha_d |f| sign(v), the only form in the solver",
        trials=(
            # f < 0 and v < 0: the printed form equals the correct one with the opposite sign of alpha_d
            failing("as printed (alpha_d = -0.05)", partial(energy_gain, -ALPHA)),
            passing("with |f|, alpha_d = 0.05", partial(energy_gain, ALPHA), default=True),
        ),
        axes=("time (s)", "energy gain over initial kinetic energy (-)"),
    ),
    Scenario(
        name="moving-frame",
        mechanism="Local damping depends on the frame of reference: internal forces slow down a moving body.",
        metric="relative speed lost by a vibrating block in twenty transits of an elastic wave",
        bound=1e-9,
        source="conservation of momentum",
        remedy="stages.collapse.damping = 0; the effect is small where internal forces are small compared with the "
        "weight",
        trials=(
            failing(f"damping = {ALPHA}", partial(speed_loss, ALPHA), default=True),
            passing("damping = 0", partial(speed_loss, 0.0)),
        ),
        axes=("time (s)", "mean speed over initial speed (-)"),
    ),
)
