"""A spinning elastic disc: what is left of rigid rotation in its third turn, for each transfer.

R = 1, h = 0.1, four points per cell, nu = 0.2, CFL 0.4, c_p = 16.7 omega R. Residual: mass-weighted rms of
the velocity less the rigid rotation of the same angular momentum, over omega R. An independent code found, at
one instant after three turns, 3.7 % for FLIP, 1.39 % for Taylor P2G with FLIP and 1.20 % with PIC, with
kinetic energies of 0.897, 0.956 and 0.958 and angular momenta of 0.986, 1.021 and 1.022. Its stiffness is not
on record; this one meets those energies and momenta. With APIC it found 1.23 %, 0.958 and 1.021.

The residual of the Taylor transfers is no noise: it is the disc's breathing under its own spin, which swings
between 0.1 and 1.7 % and would be there in an exact solution. Without it (the uniform part of the radial
velocity), 0.16 % is left with Taylor, against 3.6 % with FLIP.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
import pytest

from mpmcol.state import Points, Scheme
from tests.verification.blocks import (
    WEIGHTLESS,
    advance_to,
    elastic_body,
    kinetic_energy,
    lattice,
    make_solver,
    points_at,
    walled_grid,
)

H, OMEGA, TURNS, NU, DENSITY = 0.1, 1.0, 3, 0.2, 1.0
YOUNG = DENSITY * (16.7 * OMEGA) ** 2 * (1.0 + NU) * (1.0 - 2.0 * NU) / (1.0 - NU)
PIC = {"flip_fraction": 0.0}
TRANSFERS = {"flip": {"taylor": 0.0}, "taylor-flip": {}, "tpic": PIC, "apic": PIC}


class Spin(NamedTuple):
    residual: float  # rms over the third turn
    smallest: float
    largest: float
    noise: float  # rms over the third turn, without breathing
    energy: float
    angular_momentum: float


def rotation(x: np.ndarray) -> np.ndarray:
    """Velocity of unit rigid rotation at `x`."""
    return np.stack([-x[:, 1], x[:, 0]], axis=1)


@cache
def spin(transfer: str) -> Spin:
    x = lattice((-1.1, -1.1), (1.1, 1.1), H / 2)
    points = points_at(x[np.hypot(*x.T) < 1.0], H / 2, density=DENSITY)
    points.v[:] = OMEGA * rotation(points.x)
    gradient = np.zeros((len(points), 3, 3))
    gradient[:, 1, 0], gradient[:, 0, 1] = OMEGA, -OMEGA
    points.grad_v = gradient
    settings = WEIGHTLESS._replace(cfl=0.4, **TRANSFERS[transfer])
    solver = make_solver(
        points,
        walled_grid((-2.0, -2.0), H, (40, 40)),
        settings,
        body=elastic_body(DENSITY, YOUNG, NU),
        scheme=Scheme(affine=transfer == "apic"),
    )
    energy = kinetic_energy(points)
    momentum = points.m @ np.sum(points.v * rotation(points.x), axis=1)
    turn = 2.0 * np.pi / OMEGA
    residuals, noises = [], []
    for k in range(61):
        advance_to(solver, (TURNS - 1 + k / 60) * turn)
        residual, noise = deviations(solver.points)
        residuals.append(residual)
        noises.append(noise)

    points = solver.points
    left = points.m @ np.sum(points.v * rotation(points.x), axis=1)
    rms = [float(np.sqrt(np.mean(np.square(each)))) for each in (residuals, noises)]
    return Spin(rms[0], min(residuals), max(residuals), rms[1], kinetic_energy(points) / energy, left / momentum)


def deviations(points: Points) -> tuple[float, float]:
    """Rms of the velocity less rigid rotation, and less uniform radial motion too, over omega R."""
    rigid, m = rotation(points.x), points.m
    inertia = m @ np.sum(rigid**2, axis=1)
    deviation = points.v - (m @ np.sum(points.v * rigid, axis=1)) / inertia * rigid
    noise = deviation - (m @ np.sum(deviation * points.x, axis=1)) / inertia * points.x
    residual, rest = (float(np.sqrt(m @ np.sum(v**2, axis=1) / m.sum())) / OMEGA for v in (deviation, noise))
    return residual, rest


@pytest.mark.parametrize(
    ("transfer", "residual", "energy", "angular_momentum"),
    [
        ("flip", 0.037, 0.897, 0.986),
        ("taylor-flip", 0.0139, 0.956, 1.021),
        ("tpic", 0.0120, 0.958, 1.022),
        ("apic", 0.0123, 0.958, 1.021),
    ],
)
def test_residual_energy_and_angular_momentum(
    transfer: str, residual: float, energy: float, angular_momentum: float
) -> None:
    result = spin(transfer)
    assert result.smallest < residual < result.largest < 1.5 * residual
    assert result.energy == pytest.approx(energy, abs=0.007)
    assert result.angular_momentum == pytest.approx(angular_momentum, abs=0.003)


def test_noise_of_the_transfers() -> None:
    assert spin("flip").residual == pytest.approx(0.037, rel=0.05)
    assert spin("tpic").noise < spin("taylor-flip").noise < 0.1 * spin("flip").noise
    assert spin("taylor-flip").noise < 0.002
    assert spin("taylor-flip").residual < 0.0139
