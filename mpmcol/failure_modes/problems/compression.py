"""Biaxial compression of a block of cohesive, softening sand between two heavy rough platens, without gravity.

The block sticks to the platens, so that shear bands form across it. Plane strain, psi = 0: only the friction angle
softens, from 50 to 25 degrees, and with it the strength 2 c cos(phi) / (1 - sin(phi)) from 5.5 to 3.1 c.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from mpmcol.failure_modes.toolkit import (
    DENSITY,
    NU,
    WEIGHTLESS,
    E,
    advance_to,
    elastic_body,
    joined,
    lattice,
    make_solver,
    points_at,
    walled_grid,
)
from mpmcol.mpm.constitutive import mohr_coulomb_softening
from mpmcol.mpm.kernels.loop import L_WORK
from mpmcol.mpm.particles import COLUMN
from mpmcol.mpm.solver import Body

WIDTH, HEIGHT, PLATEN = 0.2, 0.32, 0.08  # m
SPEED = 0.02  # m/s of each platen
SHORTENING, INTERVALS = 0.1, 20  # final shortening over height, and its intervals
COHESION = 5e3  # Pa
HEAVY = 1e4  # density and modulus of the platens over those of sand, so that they hardly decelerate


class Compression(NamedTuple):
    """Response of the block in each interval."""

    shortening: np.ndarray  # over the height
    strength: np.ndarray  # mean axial stress over cohesion
    band: float  # m: area with more than half of the largest plastic strain over the width of the block


def softening_body(rate: float) -> Body:
    """The sand of the block; `rate` is the softening rate."""
    material = mohr_coulomb_softening.Material(
        density=DENSITY, youngs_modulus=E, poissons_ratio=NU, friction_peak_deg=50.0, friction_residual_deg=25.0,
        softening_rate=rate, cohesion=COHESION,
    )  # fmt: skip
    return Body(mohr_coulomb_softening, mohr_coulomb_softening.make_params(material), material.wave_speed**2)


@cache
def compressed(h: float, rate: float) -> Compression:
    """Compression on a grid of spacing `h`; the friction angle decays with exp(-rate eps)."""
    left, low = 0.4, 0.08
    right, middle, high = left + WIDTH, low + PLATEN, low + PLATEN + HEIGHT
    block = points_at(lattice((left, middle), (right, high), h / 2), h / 2, COLUMN)
    lower = lattice((left - WIDTH, low), (right + WIDTH, middle), h / 2)
    upper = lattice((left - WIDTH, high), (right + WIDTH, high + PLATEN), h / 2)
    below, above = (points_at(x, h / 2, density=HEAVY * DENSITY) for x in (lower, upper))
    below.v[:, 1], above.v[:, 1] = SPEED, -SPEED
    centre = 0.5 * (middle + high)
    block.v[:, 1] = -2.0 * SPEED * (block.x[:, 1] - centre) / HEIGHT
    platens = elastic_body(HEAVY * DENSITY, HEAVY * E)
    grid = walled_grid((0.0, 0.0), h, (round(1.0 / h), round(0.64 / h)))
    solver = make_solver(
        joined(block, below, above), grid, WEIGHTLESS._replace(alpha_d=0.1), softening_body(rate), body=platens
    )
    work, end = [0.0], SHORTENING * HEIGHT / (2.0 * SPEED)
    for k in range(1, INTERVALS + 1):
        advance_to(solver, end * k / INTERVALS)
        work.append(float(solver.ledger[L_WORK]))
    stress = np.diff(work) / (WIDTH * HEIGHT * SHORTENING / INTERVALS)
    shortening = SHORTENING * (np.arange(INTERVALS) + 0.5) / INTERVALS
    sand = solver.points.kind == COLUMN
    strain, area = solver.points.history[sand, 0], solver.points.V[sand]
    return Compression(shortening, stress / COHESION, float(area[strain > 0.5 * strain.max()].sum() / WIDTH))
