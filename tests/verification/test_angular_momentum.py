"""Angular momentum of a free elastic block that rotates and vibrates, for each transfer.

In APIC (Jiang et al. 2015, doi:10.1145/2766996) the angular momentum is sum x x m v plus that of the affine matrices C,
sum m D (C - C^T) with D = h^2 / 4. P2G and G2P transfer both exactly if points move by dt S v~ (position update "end")
and no wall is near; internal forces do not change the sum. The velocity gradient of TPIC has no such interpretation, so
with TPIC the sum is conserved to a few per mille only. PIC loses all rotation inside a cell.
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
both_dimensions = pytest.mark.parametrize("d", [2, pytest.param(3, marks=pytest.mark.slow)])


def rotating_block(transfer: str, d: int, basis: str = "quadratic") -> Solver:
    """A rotating block in the middle of a grid, far from its faces."""
    spin = SPIN[:d, :d]
    points = points_at(lattice((0.8,) * d, (1.2,) * d, H / 2), H / 2, density=1.0)
    points.x[:] += 0.01 * np.random.default_rng(1).normal(size=points.x.shape)
    points.v[:] = (points.x - 1.0) @ spin.T + 0.3 * np.sin(9.0 * points.x)
    points.grad_v = np.pad(np.broadcast_to(spin, (len(points), d, d)), ((0, 0), (0, 3 - d), (0, 3 - d)))
    settings = END._replace(taylor=TRANSFERS[transfer])
    scheme = Scheme(affine=transfer == "apic", basis=basis)
    grid = walled_grid((0.0,) * d, H, (20,) * d)
    return make_solver(points, grid, settings, body=elastic_body(1.0, 1e3, 0.2), scheme=scheme)


def angular_momentum(points: Points, D: float) -> np.ndarray:
    """Antisymmetric matrix sum m (v x^T - x v^T) + D m (C - C^T)."""
    d = points.dimension
    C = points.grad_v[:, :d, :d]
    moment = points.v.T @ (points.m[:, None] * points.x) + D * np.einsum("p,pab->ab", points.m, C)
    return moment - moment.T


def relative_change(transfer: str, d: int, D: float = 0.25 * H**2, basis: str = "quadratic") -> float:
    solver = rotating_block(transfer, d, basis)
    before = angular_momentum(solver.points, D)
    advance_steps(solver, STEPS)
    assert np.all((solver.points.x > 0.25) & (solver.points.x < 1.75))
    return float(np.abs(angular_momentum(solver.points, D) - before).max() / np.abs(before).max())


@both_dimensions
def test_apic_conserves_angular_momentum_to_roundoff(d: int) -> None:
    assert relative_change("apic", d) < 1e-12


@pytest.mark.slow
@both_dimensions
def test_apic_conserves_angular_momentum_with_cubic_shape_functions(d: int) -> None:
    """D = h^2 / 3 for cubic B-splines."""
    assert relative_change("apic", d, D=H**2 / 3.0, basis="cubic") < 1e-12


@both_dimensions
def test_the_share_of_the_affine_matrices_is_needed(d: int) -> None:
    assert relative_change("apic", d, D=0.0) > 1e-5


@both_dimensions
def test_tpic_conserves_angular_momentum_approximately(d: int) -> None:
    assert 1e-6 < relative_change("tpic", d) < 1e-2


@both_dimensions
def test_pic_loses_angular_momentum_and_energy(d: int) -> None:
    """Angular momentum of positions and velocities only, and kinetic energy."""
    assert relative_change("pic", d, D=0.0) > 0.3
    left = {}
    for transfer in TRANSFERS:
        solver = rotating_block(transfer, d)
        start = kinetic_energy(solver.points)
        advance_steps(solver, STEPS)
        left[transfer] = kinetic_energy(solver.points) / start
    assert left["pic"] < 0.5 * min(left["tpic"], left["apic"])
    assert left["tpic"] == pytest.approx(left["apic"], rel=0.05)
