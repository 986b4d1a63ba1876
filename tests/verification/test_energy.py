"""The energy ledger of a collapse closes.

In one step the nodes turn the kinetic energy K of P2G into K~. With f = f_int + m g and the mean nodal
velocity u = (v + v~) / 2 (half of v where a wall stops the node),

    K~ - K = dt f_int . u  +  dt m g . u  -  damping  -  walls.

dt f_int . u is minus the work of the stress on the motion of the nodes (L_NODE_WORK), dt m g . u minus the
change of the potential energy of the points (their trapezoid rule moves them by dt S u), `damping` the work
of -alpha_d |f| sign(v) (L_DAMPING, >= 0), and `walls` the kinetic energy of the nodal components that walls
stop and the work of the forces on them (L_WALLS). Summed over all steps K~ - K is L_GRID.

The material takes L_WORK: the mean stress of each step on the velocity gradient after it, stored or
dissipated. It differs from L_NODE_WORK by the stress times the jump that the transfer makes in the gradient,
and points hold another kinetic energy than nodes. Both are what P2G and G2P lose:

    transfer = KE at the start - KE now + L_GRID + L_NODE_WORK - L_WORK,

so that residual = dPE + dKE + L_WORK + L_DAMPING + L_WALLS + transfer = 0.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
import pytest

from mpmcol.failure_modes.toolkit import (
    PLAIN,
    WEIGHTLESS,
    G,
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
from mpmcol.mpm.kernels.loop import L_DAMPING, L_GRID, L_NODE_WORK, L_WALLS, L_WORK
from mpmcol.mpm.particles import COLUMN
from mpmcol.mpm.settings import PAPER, Scheme, Settings
from mpmcol.mpm.solver import Solver

WIDTH, HEIGHT, BASE = 0.08, 0.16, 0.02
LENGTH, SPACING = {2: 0.5, 3: 0.24}, {2: 0.01, 3: 0.02}
YOUNG = 1e6
DAMPED = PLAIN._replace(alpha_d=0.05)
SCHEMES = [
    Scheme(stress_order="usf"),
    Scheme(stress_order="musl"),
    Scheme(affine=True),
    Scheme(basis="cubic"),
    Scheme(basis="linear"),
]
SCHEMES.insert(0, Scheme(volumetric_strain="cell"))


def collapse(settings: Settings, d: int = 2, h: float | None = None, scheme: Scheme = PAPER, margin: int = 0) -> Solver:
    """An unstressed column of sand on an elastic base, free to collapse: beside a wall, in 3D in a corner of two.

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
    solver = make_solver(joined(base, column), grid, settings, sand_body(**soft), elastic_body(**soft), scheme)
    solver.margin = margin
    return solver


class Ledger(NamedTuple):
    """All over the initial potential energy of the column above the base."""

    potential: float
    kinetic: float
    work: float
    damping: float
    walls: float
    transfer: float
    stored: float
    jump: float  # the share of `transfer` that is work of the stress

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
    )
    return Ledger(*(np.array(parts) / scale))


@pytest.mark.parametrize("wall_impulse", [True, False], ids=["impulse", "no impulse"])
@pytest.mark.parametrize(("d", "axisymmetric"), [(2, False), (2, True), (3, False)], ids=["plane", "axi", "space"])
def test_the_ledger_of_a_collapse_closes(d: int, axisymmetric: bool, wall_impulse: bool) -> None:
    """To 1e-6 of the initial potential energy (0.5 % is asked for): points held off the walls are lifted.

    Without impulse the walls stop the same motion in every step, and the points give it to the nodes again.
    """
    ledger = ledger_of(DAMPED._replace(axisymmetric=axisymmetric, wall_impulse=wall_impulse), d)
    assert ledger.potential < -0.4
    assert 0.7 < ledger.work / -ledger.potential < 1.0
    assert 0.02 < ledger.damping < 0.05
    assert abs(ledger.walls) < (1e-3 if wall_impulse else {2: 0.05, 3: 0.2}[d])
    assert -0.01 < ledger.transfer + ledger.walls < 0.06
    assert 0.0 < ledger.stored < 0.01
    assert abs(ledger.residual) <= 1e-6


@pytest.mark.parametrize(
    ("scheme", "d", "axisymmetric"),
    [(scheme, *model) for scheme in SCHEMES for model in ((2, False), (2, True), (3, False))][:-1],
    ids=str,
)
def test_the_ledger_of_every_scheme_closes(scheme: Scheme, d: int, axisymmetric: bool) -> None:
    """Its terms are the same: the work on the nodes is that of the stress that made the forces, whenever it was made.

    Where the stress takes other velocities than those of the nodes' motion, the jump is larger: 2 to 5 %. Left out:
    linear hats in space, with which the column runs out of its domain.
    """
    ledger = ledger_of(DAMPED._replace(axisymmetric=axisymmetric), d, scheme=scheme)
    assert ledger.potential < -0.4
    assert 0.7 < ledger.work / -ledger.potential < 1.0
    assert abs(ledger.jump) < (0.02 if scheme.stress_order == "usl" else 0.05)
    assert abs(ledger.residual) <= 1e-6


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("part", ["kinetic", "potential", "work", "damping", "walls", "transfer"])
def test_every_part_of_the_ledger_is_needed(part: str, d: int) -> None:
    ledger = ledger_of(DAMPED, d)
    assert abs(ledger.residual - getattr(ledger, part)) > 1e-5


def test_the_jump_in_work_falls_with_the_grid_spacing() -> None:
    """0.9 % of the initial potential energy with 8 cells across the column, 0.4 % with 16."""
    coarse, fine = (ledger_of(DAMPED, h=h).jump for h in (0.01, 0.005))
    assert 0.0 < fine < 0.7 * coarse < 0.7 * 0.01


@pytest.mark.parametrize("direction", [(1.0, 0.0), (0.6, 0.0, 0.8), (0.6, -0.48, 0.64)], ids=["x", "xz", "xyz"])
def test_the_work_of_an_elastic_body_is_its_stored_energy(direction: tuple[float, ...]) -> None:
    """A block that rings: half of its energy goes to and fro, measured against stress and strain alone."""
    h, body, d = 0.1, elastic_body(), len(direction)
    points = points_at(lattice((0.5,) * d, (1.5,) * d, h / 2), h / 2)
    points.v[:] = 0.1 * np.sin(np.pi * ((points.x - 1.0) @ direction))[:, None] * direction
    scale = kinetic_energy(points)
    solver = make_solver(points, walled_grid((0.0,) * d, h, (20,) * d), WEIGHTLESS, body=body)
    shares = []
    for k in range(1, 21):
        advance_to(solver, 0.1 * k / np.sqrt(body.wave_speed2))
        shares.append([solver.ledger[L_WORK], elastic_energy(solver.points)])
    work, stored = np.array(shares).T / scale
    assert stored.max() > 0.8
    np.testing.assert_allclose(work, stored, atol=2e-3)
