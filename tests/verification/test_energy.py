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

import numpy as np
import pytest

from mpmcol.failure_modes.toolkit import (
    WEIGHTLESS,
    advance_to,
    elastic_body,
    elastic_energy,
    kinetic_energy,
    lattice,
    make_solver,
    points_at,
    walled_grid,
)
from mpmcol.mpm.kernels.loop import L_WORK
from mpmcol.mpm.settings import Scheme
from tests.support.sand_column import DAMPED, ledger_of

SCHEMES = [
    Scheme(stress_order="usf"),
    Scheme(stress_order="musl"),
    Scheme(affine=True),
    Scheme(basis="cubic"),
    Scheme(basis="linear"),
]
SCHEMES.insert(0, Scheme(volumetric_strain="cell"))


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
    [
        *((scheme, 2, axisymmetric) for scheme in SCHEMES for axisymmetric in (False, True)),
        (SCHEMES[0], 3, False),
        *(pytest.param(scheme, 3, False, marks=pytest.mark.slow) for scheme in SCHEMES[1:-1]),
    ],
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
