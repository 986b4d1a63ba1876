"""Local damping: what it takes from free fall, what its printed form adds, and why it feels a moving frame."""

from __future__ import annotations

from functools import partial

import numpy as np

from mpmcol.failure_modes.problems.fall import thrown_block
from mpmcol.failure_modes.scenario import Reading, Scene, Theory, Trial
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
TRANSITS = 20.0


def acceleration(alpha: float) -> float:
    """Of a falling block, over g."""
    solver, _ = thrown_block((0.0, SPEED), PLAIN._replace(alpha_d=alpha))
    advance_steps(solver, STEPS)
    return float((SPEED - solver.points.v[:, 1].mean()) / (G * solver.time))


def missing_acceleration(alpha: float) -> float:
    """What is missing of free fall, over g."""
    return abs(1.0 - acceleration(alpha))


def energy_gained(alpha: float) -> Reading:
    """By a falling block, over its kinetic energy at the start."""
    solver, start = thrown_block((0.0, SPEED), PLAIN._replace(alpha_d=alpha))
    kinetic, times, energies = kinetic_energy(start), [0.0], [0.0]
    whole = kinetic + potential_energy(start)
    for _ in range(20):
        advance_steps(solver, STEPS // 20)
        times.append(solver.time)
        energies.append((kinetic_energy(solver.points) + potential_energy(solver.points) - whole) / kinetic)
    return Reading(energies[-1], "", (np.array(times), np.array(energies)))


def drift_of_frame(alpha: float) -> Reading:
    """Speed that a ringing block loses which flies along without weight, over that speed."""
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
    return Reading(abs(1.0 - speeds[-1]), "", (np.array(times), np.array(speeds)))


SCENES = (
    Scene(
        name="damping-fall",
        mechanism="Local damping takes its share of every force, of weight in free fall, too: sand falls as on a "
        "lighter planet.",
        sign="what is missing of g",
        unit="",
        bound=0.01,
        source="free fall; a tenth of the scatter of experiments",
        remedy="stages.collapse.damping = 0; the paper's 0.05 is the default because its results are to be reproduced",
        trials=(
            Trial(f"damping = {ALPHA}", False, partial(missing_acceleration, ALPHA), default=True),
            Trial("damping = 0", True, partial(missing_acceleration, 0.0)),
        ),
        theory=(
            Theory("acceleration with damping 0.05, over g", 0.95, partial(acceleration, ALPHA), "1 - alpha_d", 1e-9),
        ),
    ),
    Scene(
        name="damping-printed",
        mechanism="Eq. 23 as printed, -alpha_d f sign(v), drives whatever moves against an axis along with its force.",
        sign="energy gained by a falling block, over its kinetic energy",
        unit="",
        bound=1e-9,
        source="damping never adds energy",
        remedy="-alpha_d |f| sign(v); the solver offers nothing else",
        trials=(
            # f < 0 and v < 0: the printed form is the right one with alpha_d of the other sign, on the same kernels
            Trial("as printed, by alpha_d = -0.05", False, partial(energy_gained, -ALPHA)),
            Trial("with |f|, alpha_d = 0.05", True, partial(energy_gained, ALPHA), default=True),
        ),
        axes=("time (s)", "energy gained over kinetic energy (-)"),
    ),
    Scene(
        name="moving-frame",
        mechanism="Local damping knows a state of rest: what flies along is braked by its own inner forces.",
        sign="speed lost by a ringing block in twenty transits of a wave, over its speed",
        unit="",
        bound=1e-9,
        source="momentum is conserved",
        remedy="stages.collapse.damping = 0; small where inner forces are small beside weight",
        trials=(
            Trial(f"damping = {ALPHA}", False, partial(drift_of_frame, ALPHA), default=True),
            Trial("damping = 0", True, partial(drift_of_frame, 0.0)),
        ),
        axes=("time (s)", "mean speed over that at the start (-)"),
    ),
)
