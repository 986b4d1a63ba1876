"""Axial vibration of an elastic bar with one fixed end: period and energy.

The bar is a quarter of a wavelength long (25 cells, two points per cell), with nu = 0 and rollers on its sides, so that
the problem is one-dimensional along any axis. E = 100, rho = 1, L = 25, v = 0.1 sin(pi x / 2 L), hence T = 10.

The time step is constant. With the step of Eq. 35, which varies with the speed of the points, ten periods lose 0.25 %
more energy at CFL 0.5 (Taylor: 0.9963 instead of 0.9986), although the speed is 1 % of the wave speed.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from mpmcol.failure_modes.toolkit import (
    SIDES,
    WEIGHTLESS,
    advance_steps,
    elastic_body,
    elastic_energy,
    kinetic_energy,
    lattice,
    make_solver,
    points_at,
    walled_grid,
)
from mpmcol.mpm.kernels.loop import DT
from mpmcol.mpm.settings import PAPER, Scheme
from mpmcol.setup.stability_limit import TRANSFER_COEFFICIENTS

LENGTH, YOUNG, SPEED, PERIOD = 25.0, 100.0, 0.1, 10.0
WAVE_SPEED = 10.0


class Vibration(NamedTuple):
    """Energy, period and motion of the bar."""

    energy: float  # final over initial
    period: float
    cross_motion: float  # largest velocity across the bar at the end
    times: np.ndarray  # of the steps
    kinetic: np.ndarray  # energy at these times, over the initial one


@cache
def vibration(
    transfer: str, cfl: float, d: int = 2, along: int = 0, scheme: Scheme = PAPER, periods: float = 10.0
) -> Vibration:
    """A bar along the given axis with its lower end fixed; raises NumericalFailure if it diverges."""
    b, upper, cells = np.pi / (2.0 * LENGTH), [2.0] * d, [2] * d
    upper[along], cells[along] = LENGTH, 29
    points = points_at(lattice((0.0,) * d, tuple(upper), 0.5), 0.5, density=1.0)
    points.v[:, along] = SPEED * np.sin(b * points.x[:, along])
    gradient = np.zeros((len(points), 3, 3))
    gradient[:, along, along] = SPEED * b * np.cos(b * points.x[:, along])
    points.grad_v = gradient
    rollers = [side for axis, sides in enumerate(SIDES[:d]) for side in (sides[:1] if axis == along else sides)]
    grid = walled_grid((0.0,) * d, 1.0, tuple(cells), rollers=" ".join(rollers))
    taylor, flip = TRANSFER_COEFFICIENTS[transfer]
    settings = WEIGHTLESS._replace(cfl=cfl, wall_impulse=False, taylor=taylor, flip_fraction=flip)
    solver = make_solver(points, grid, settings, body=elastic_body(1.0, YOUNG, 0.0), scheme=scheme)
    start = kinetic_energy(points)
    times, speeds, kinetic = [], [], []
    for _ in range(round(periods * PERIOD * WAVE_SPEED / cfl)):
        solver.clock[DT] = cfl / WAVE_SPEED
        advance_steps(solver, 1)
        times.append(solver.time)
        speeds.append(solver.points.m @ solver.points.v[:, along])
        kinetic.append(kinetic_energy(solver.points) / start)
    end = kinetic_energy(solver.points) + elastic_energy(solver.points, YOUNG, 0.0)
    across = np.abs(np.delete(solver.points.v, along, axis=1)).max()
    t = np.array(times)
    return Vibration(end / start, period_of(t, np.array(speeds)), across, t, np.array(kinetic))


def period_of(t: np.ndarray, v: np.ndarray) -> float:
    """Twice the mean interval between zero crossings, by linear regression; NaN with fewer than two crossings."""
    k = np.flatnonzero(v[1:] * v[:-1] < 0.0)
    if len(k) < 2:
        return float("nan")
    crossing = t[k] - v[k] * (t[k + 1] - t[k]) / (v[k + 1] - v[k])
    return float(2.0 * np.polyfit(np.arange(len(crossing)), crossing, 1)[0])
