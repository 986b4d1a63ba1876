"""Angular momentum of a free elastic block that tumbles and rings, for each transfer.

APIC (Jiang et al. 2015, doi:10.1145/2766996) counts sum x x m v and what the affine matrices hold,
sum m D (C - C^T), D = h^2 / 4. P2G hands both to the nodes, internal forces change nothing there, and G2P takes both
back: exactly, where points move by dt S v~ (the rule "end") and no wall is near. The Taylor matrix of TPIC is no such
share: with it the sum is kept to some per mille only. PIC forgets all rotation inside a cell.
"""

from __future__ import annotations

import numpy as np
import pytest

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
from mpmcol.mpm.particles import Points
from mpmcol.mpm.settings import Scheme
from mpmcol.mpm.solver import Solver

H, STEPS = 0.1, 200
SPIN = np.array([[0.0, -3.0, 1.0], [3.0, 0.0, -2.0], [-1.0, 2.0, 0.0]])
TRANSFERS = {"pic": 0.0, "tpic": 1.0, "apic": 1.0}  # Taylor term
END = WEIGHTLESS._replace(flip_fraction=0.0, position_factor=0.0, cfl=0.3)
both_dimensions = pytest.mark.parametrize("d", [2, 3])


def tumbling(transfer: str, d: int, basis: str = "quadratic") -> Solver:
    """A block in the middle of a grid, all its points away from the walls for the whole time."""
    spin = SPIN[:d, :d]
    points = points_at(lattice((0.8,) * d, (1.2,) * d, H / 2), H / 2, density=1.0)
    points.x[:] += 0.01 * np.random.default_rng(1).normal(size=points.x.shape)
    points.v[:] = (points.x - 1.0) @ spin.T + 0.3 * np.sin(9.0 * points.x)
    points.grad_v = np.pad(np.broadcast_to(spin, (len(points), d, d)), ((0, 0), (0, 3 - d), (0, 3 - d)))
    settings = END._replace(taylor=TRANSFERS[transfer])
    scheme = Scheme(affine=transfer == "apic", basis=basis)
    grid = walled_grid((0.0,) * d, H, (20,) * d)
    return make_solver(points, grid, settings, body=elastic_body(1.0, 1e3, 0.2), scheme=scheme)


def angular_momentum(points: Points, held: float) -> np.ndarray:
    """Antisymmetric matrix sum m (v x^T - x v^T) + `held` m (C - C^T)."""
    d = points.dimension
    C = points.grad_v[:, :d, :d]
    moment = points.v.T @ (points.m[:, None] * points.x) + held * np.einsum("p,pab->ab", points.m, C)
    return moment - moment.T


def relative_change(transfer: str, d: int, held: float = 0.25 * H**2, basis: str = "quadratic") -> float:
    solver = tumbling(transfer, d, basis)
    before = angular_momentum(solver.points, held)
    advance_steps(solver, STEPS)
    assert np.all((solver.points.x > 0.25) & (solver.points.x < 1.75))
    return float(np.abs(angular_momentum(solver.points, held) - before).max() / np.abs(before).max())


@both_dimensions
def test_apic_conserves_angular_momentum_to_roundoff(d: int) -> None:
    assert relative_change("apic", d) < 1e-12


@both_dimensions
def test_so_it_does_with_cubic_splines(d: int) -> None:
    """Their D is h^2 / 3."""
    assert relative_change("apic", d, held=H**2 / 3.0, basis="cubic") < 1e-12


@both_dimensions
def test_without_the_share_of_the_matrices_it_does_not(d: int) -> None:
    assert relative_change("apic", d, held=0.0) > 1e-5


@both_dimensions
def test_tpic_does_not_but_nearly(d: int) -> None:
    assert 1e-6 < relative_change("tpic", d) < 1e-2


@both_dimensions
def test_pic_loses_what_the_others_keep(d: int) -> None:
    """Angular momentum by its PIC count (positions and velocities only), and kinetic energy."""
    assert relative_change("pic", d, held=0.0) > 0.3
    left = {}
    for transfer in TRANSFERS:
        solver = tumbling(transfer, d)
        start = kinetic_energy(solver.points)
        advance_steps(solver, STEPS)
        left[transfer] = kinetic_energy(solver.points) / start
    assert left["pic"] < 0.5 * min(left["tpic"], left["apic"])
    assert left["tpic"] == pytest.approx(left["apic"], rel=0.05)
