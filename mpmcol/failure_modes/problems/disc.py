"""A spinning elastic disc: deviation from rigid rotation, and growth of the computed volume.

R = 1, h = 0.1, four points per cell, nu = 0.2, CFL 0.4, c_p = 16.7 omega R.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from mpmcol.failure_modes.toolkit import (
    WEIGHTLESS,
    advance_steps,
    advance_to,
    elastic_body,
    kinetic_energy,
    lattice,
    make_solver,
    points_at,
    walled_grid,
)
from mpmcol.mpm.particles import Points
from mpmcol.mpm.settings import Scheme
from mpmcol.mpm.solver import Solver
from mpmcol.setup.stability_limit import TRANSFER_COEFFICIENTS

H, OMEGA, TURNS, NU, DENSITY = 0.1, 1.0, 3, 0.2, 1.0
YOUNG = DENSITY * (16.7 * OMEGA) ** 2 * (1.0 + NU) * (1.0 - 2.0 * NU) / (1.0 - NU)
TURN = 2.0 * np.pi / OMEGA


class Spin(NamedTuple):
    """Deviation of the velocity from rigid rotation in the last turn, over omega R."""

    residual: float  # rms
    smallest: float
    largest: float
    noise: float  # rms without uniform radial motion
    energy: float  # kinetic, final over initial
    angular_momentum: float  # final over initial


def rotation(x: np.ndarray) -> np.ndarray:
    """Velocity of unit rigid rotation at `x`."""
    return np.stack([-x[:, 1], x[:, 0]], axis=1)


def spinning_disc(transfer: str, cfl: float = 0.4, exponential: bool = False) -> Solver:
    """The disc in its initial state."""
    x = lattice((-1.1, -1.1), (1.1, 1.1), H / 2)
    points = points_at(x[np.hypot(*x.T) < 1.0], H / 2, density=DENSITY)
    points.v[:] = OMEGA * rotation(points.x)
    gradient = np.zeros((len(points), 3, 3))
    gradient[:, 1, 0], gradient[:, 0, 1] = OMEGA, -OMEGA
    points.grad_v = gradient
    taylor, flip = TRANSFER_COEFFICIENTS[transfer]
    settings = WEIGHTLESS._replace(cfl=cfl, taylor=taylor, flip_fraction=flip, exponential_volume=exponential)
    grid, body = walled_grid((-2.0, -2.0), H, (40, 40)), elastic_body(DENSITY, YOUNG, NU)
    return make_solver(points, grid, settings, body=body, scheme=Scheme(affine=transfer == "apic"))


@cache
def spin(transfer: str, turns: int = TURNS) -> Spin:
    """The disc after some turns."""
    solver = spinning_disc(transfer)
    energy = kinetic_energy(solver.points)
    momentum = _angular_momentum(solver.points)
    residuals, noises = [], []
    for k in range(61):
        advance_to(solver, (turns - 1 + k / 60) * TURN)
        residual, noise = deviations(solver.points)
        residuals.append(residual)
        noises.append(noise)

    points = solver.points
    rms = [float(np.sqrt(np.mean(np.square(each)))) for each in (residuals, noises)]
    left = _angular_momentum(points) / momentum
    return Spin(rms[0], min(residuals), max(residuals), rms[1], kinetic_energy(points) / energy, left)


def _angular_momentum(points: Points) -> float:
    return float(points.m @ np.sum(points.v * rotation(points.x), axis=1))


def deviations(points: Points) -> tuple[float, float]:
    """Rms velocity less rigid rotation, and less uniform radial motion as well, over omega R."""
    rigid, m = rotation(points.x), points.m
    inertia = m @ np.sum(rigid**2, axis=1)
    deviation = points.v - (m @ np.sum(points.v * rigid, axis=1)) / inertia * rigid
    noise = deviation - (m @ np.sum(deviation * points.x, axis=1)) / inertia * points.x
    residual, rest = (float(np.sqrt(m @ np.sum(v**2, axis=1) / m.sum())) / OMEGA for v in (deviation, noise))
    return residual, rest


class Drift(NamedTuple):
    """Relative growth of the mean volume in one turn."""

    counted: float  # by the solver, with det(I + dt L) or exp(dt tr L)
    exponential: float  # by exp(dt tr L) of the mean of the same motion
    theory: float  # sum of omega^2 dt^2


@cache
def volume_drift(cfl: float, exponential: bool = False) -> Drift:
    """Growth of the volume in one turn of the disc."""
    solver = spinning_disc("taylor-flip", cfl, exponential)
    logarithm, theory = 0.0, 0.0
    while solver.time < TURN:
        dt = solver.dt
        advance_steps(solver, 1)
        L, m = solver.points.grad_v, solver.points.m
        logarithm += dt * float(m @ np.trace(L, axis1=1, axis2=2) / m.sum())
        theory += (0.5 * dt * float(m @ (L[:, 1, 0] - L[:, 0, 1]) / m.sum())) ** 2
    return Drift(float(solver.points.J.mean()) - 1.0, float(np.expm1(logarithm)), theory)
