"""The collapse of a small column of sand on an elastic base, its energy ledger, and a digest of its state."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from mpmcol.failure_modes.toolkit import (
    PLAIN,
    G,
    advance_steps,
    advance_to,
    elastic_body,
    elastic_energy,
    joined,
    kinetic_energy,
    lattice,
    make_solver,
    points_at,
    potential_energy,
    sand_body,
    walled_grid,
)
from mpmcol.mpm.kernels.loop import L_DAMPING, L_FILTER, L_GRID, L_NODE_WORK, L_WALLS, L_WORK
from mpmcol.mpm.particles import COLUMN
from mpmcol.mpm.settings import PAPER, Scheme, Settings
from mpmcol.mpm.solver import Body, Solver
from mpmcol.simulation.summary import state_checksum

WIDTH, HEIGHT, BASE = 0.08, 0.16, 0.02
LENGTH, SPACING = {2: 0.5, 3: 0.24}, {2: 0.01, 3: 0.02}
YOUNG = 1e6
DAMPED = PLAIN._replace(alpha_d=0.05)
SAND = sand_body(youngs_modulus=YOUNG)
STEPS = 400  # of a state digest
OTHER_SCHEME = Scheme(stress_order="musl", affine=True, basis="cubic", volumetric_strain="cell")


def filtered(settings: Settings, sand: Body, h: float) -> Settings:
    """The settings with the stress filter of a case at the spacing h (m)."""
    wave_speed = sand.wave_speed2**0.5
    return settings._replace(
        filter_rate=0.5 * wave_speed / h,
        filter_shear_rate=0.3 * G / wave_speed,
        filter_modulus=sand.params.bulk_modulus,
    )


FILTERED = filtered(DAMPED, SAND, SPACING[2])


def collapse(settings: Settings, d: int = 2, h: float | None = None, scheme: Scheme = PAPER, margin: int = 0) -> Solver:
    """An unstressed column of sand on an elastic base, free to collapse: next to a wall, in 3D between two walls.

    If `margin` > 0, the base is inactive beyond `margin` tiles from the column.
    """
    h = h or SPACING[d]
    axisymmetric, length = settings.axisymmetric, LENGTH[d]
    below = lattice((0.0, -BASE, 0.0)[:d], (length, 0.0, length)[:d], h / 2)
    above = lattice((0.0,) * d, (WIDTH, HEIGHT, WIDTH)[:d], h / 2)
    base = points_at(below, h / 2, axisymmetric=axisymmetric)
    column = points_at(above, h / 2, COLUMN, axisymmetric=axisymmetric)
    cells = round(length / h), round(0.24 / h), round(length / h)
    grid = walled_grid((0.0, -BASE, 0.0)[:d], h, cells[:d], rollers="left right back front", no_slip="bottom")
    soft = {"youngs_modulus": YOUNG}
    solver = make_solver(
        joined(base, column), grid, settings, sand_body(**soft), body=elastic_body(**soft), scheme=scheme
    )
    solver.margin = margin
    return solver


class Ledger(NamedTuple):
    """Terms of the energy balance, over the initial potential energy of the column above the base."""

    potential: float
    kinetic: float
    work: float
    damping: float
    walls: float
    transfer: float
    stored: float
    jump: float  # part of `transfer` that is work of the stress
    filtered: float  # part of `work` that the stress filter took

    @property
    def residual(self) -> float:
        return self.potential + self.kinetic + self.work + self.damping + self.walls + self.transfer


@cache
def ledger_of(
    settings: Settings, d: int = 2, h: float | None = None, scheme: Scheme = PAPER, margin: int = 0
) -> Ledger:
    solver = collapse(settings, d, h, scheme, margin)
    points, column = solver.points, solver.points.kind == COLUMN
    scale = G * points.m[column] @ points.x[column, 1]
    potential, kinetic = potential_energy(points), kinetic_energy(points)
    advance_to(solver, 0.5)
    sums, change = solver.ledger, kinetic_energy(solver.points) - kinetic
    jump = sums[L_NODE_WORK] - sums[L_WORK]
    parts = (
        potential_energy(solver.points) - potential,
        change,
        sums[L_WORK],
        sums[L_DAMPING],
        sums[L_WALLS],
        sums[L_GRID] - change + jump,
        elastic_energy(solver.points, YOUNG),
        jump,
        sums[L_FILTER],
    )
    return Ledger(*(np.array(parts) / scale))


def state_digest(d: int, chunk: int = STEPS, scheme: Scheme = PAPER, margin: int = 0) -> str:
    """Hash of all points, the clock and the ledger after STEPS steps in d dimensions, `chunk` steps a call."""
    solver = collapse(FILTERED, d, scheme=scheme, margin=margin)
    for done in range(0, STEPS, chunk):
        advance_steps(solver, min(chunk, STEPS - done))
    assert solver.steps == STEPS
    return state_checksum(solver)
