"""What transfers between points and grid lose, keep, and stir up."""

from __future__ import annotations

from functools import partial

import numpy as np

from mpmcol.errors import NumericalFailure
from mpmcol.failure_modes.problems.bar import PERIOD, vibration
from mpmcol.failure_modes.problems.disc import spin
from mpmcol.failure_modes.scenario import STOPPED, Reading, Scene, Trial
from mpmcol.failure_modes.toolkit import (
    WEIGHTLESS,
    advance_steps,
    elastic_body,
    kinetic_energy,
    lattice,
    make_solver,
    points_at,
    walled_grid,
)
from mpmcol.mpm.kernels.loop import L_KINETIC
from mpmcol.mpm.shape_functions.quadratic import spline

NODES = 9
BAR = "physics 3.1: the same bar in an independent one-dimensional code"


def energy_lost(transfer: str, cfl: float) -> Reading:
    """Of the bar in three periods."""
    bar = vibration(transfer, cfl, periods=3.0)
    return Reading(1.0 - bar.energy, f"energy left {bar.energy:.4g}", (bar.times / PERIOD, bar.kinetic))


def energy_peak(transfer: str, cfl: float) -> Reading:
    """The largest kinetic energy of the bar in three periods over that at the start."""
    try:
        bar = vibration(transfer, cfl, periods=3.0)
    except NumericalFailure as failure:
        return Reading(STOPPED, f"stopped after {failure.failure['time'] / PERIOD:.2g} periods")
    return Reading(float(bar.kinetic.max()), "", (bar.times / PERIOD, bar.kinetic))


def disc_noise(transfer: str) -> float:
    """Of the spinning disc in its first turn."""
    return spin(transfer, turns=1).noise


def noise_left(flip_fraction: float) -> Reading:
    """Share of the energy of a noise that the grid cannot see, after 300 steps; 16 points per cell."""
    x = lattice((2.0, 2.0), (5.0, 5.0), 0.25)
    points = points_at(x, 0.25, density=1.0)
    points.v[:] = _unseen(np.random.default_rng(11).normal(0.0, 1e-3, x.shape), x)
    start = kinetic_energy(points)
    settings = WEIGHTLESS._replace(flip_fraction=flip_fraction)
    solver = make_solver(points, walled_grid((0.0, 0.0), 1.0, (NODES - 1,) * 2), settings, body=elastic_body(1.0, 1e2))
    advance_steps(solver, 300)
    left = kinetic_energy(solver.points) / start
    return Reading(left, f"at the nodes {solver.ledger[L_KINETIC] / start:.1g}")


def _unseen(v: np.ndarray, x: np.ndarray) -> np.ndarray:
    """What is left of velocities (n, 2) of equal points at `x` without what they give to the nodes."""
    weights = np.zeros((len(x), NODES, NODES))
    for place, w in zip(x, weights, strict=True):
        (i, *a), (j, *b) = (spline(float(s), NODES, True) for s in place)
        w[i : i + 3, j : j + 3] = np.outer(a[:3], b[:3])
    seen = weights.reshape(len(x), -1)
    return v - seen @ np.linalg.lstsq(seen, v, rcond=None)[0]


SCENES = (
    Scene(
        name="pic-damping",
        mechanism="PIC gives points the smooth field of the nodes in every step: the more steps, the more motion is "
        "lost.",
        sign="energy lost in three periods of a vibrating bar, cfl = 0.1",
        unit="",
        bound=0.1,
        source=f"{BAR}: PIC keeps 6e-5 in ten periods, which is 5 % in three, Taylor-FLIP 0.9995",
        remedy="transfer = taylor-flip, the default",
        trials=(
            Trial("pic", False, partial(energy_lost, "pic", 0.1)),
            Trial("taylor-flip", True, partial(energy_lost, "taylor-flip", 0.1), default=True),
            Trial("tpic", True, partial(energy_lost, "tpic", 0.1)),
        ),
        axes=("time over period (-)", "kinetic energy over that at the start (-)"),
    ),
    Scene(
        name="flip-transient",
        mechanism="FLIP beyond the bound of a single point: a bar rings up many times over and calms down again, or "
        "not.",
        sign="largest kinetic energy of a vibrating bar over that at the start, cfl = 0.95",
        unit="",
        bound=2.0,
        source=f"{BAR}: FLIP x37 at 0.9, Taylor-FLIP none; ratio of 2 as the sign of a step too long (physics 5.2, 1)",
        remedy="transfer = taylor-flip, the default; and time.cfl below 0.7",
        trials=(
            Trial("flip", False, partial(energy_peak, "flip", 0.95)),
            Trial("taylor-flip", True, partial(energy_peak, "taylor-flip", 0.95), default=True),
        ),
        axes=("time over period (-)", "kinetic energy over that at the start (-)"),
    ),
    Scene(
        name="flip-noise",
        mechanism="FLIP keeps what each point does against its neighbours: a spinning disc simmers.",
        sign="rms velocity without rotation and breathing, over omega R",
        unit="",
        bound=0.01,
        source="physics 3.1: FLIP 3.7 %, the Taylor transfers 1.2 to 1.4 % with the breathing, which is no noise",
        remedy="transfer = taylor-flip, the default",
        trials=(
            Trial("flip", False, partial(disc_noise, "flip")),
            Trial("taylor-flip", True, partial(disc_noise, "taylor-flip"), default=True),
            Trial("tpic", True, partial(disc_noise, "tpic")),
        ),
    ),
    Scene(
        name="null-space",
        mechanism="With many points a cell the nodes cannot see every motion of the points, so nothing ever stops it.",
        sign="energy left of an unseen noise after 300 steps, 16 points per cell",
        unit="",
        bound=0.5,
        source="physics 5.2, 6: with FLIP in the update it stays for good; with a share A it fades as A^(2 n)",
        remedy="method.flip_fraction = 0.99 (a column's front is then 2 to 9 % shorter), or transfer = tpic; what the "
        "noise does to a quiet column is small",
        trials=(
            Trial("taylor-flip", False, partial(noise_left, 1.0), default=True),
            Trial("taylor-flip, flip_fraction = 0.99", True, partial(noise_left, 0.99)),
            Trial("tpic", True, partial(noise_left, 0.0)),
        ),
    ),
)
