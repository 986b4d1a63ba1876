"""A stress-free block in free flight."""

from __future__ import annotations

from mpmcol.failure_modes.toolkit import PLAIN, by_id, elastic_body, lattice, make_solver, points_at, walled_grid
from mpmcol.mpm.particles import Points
from mpmcol.mpm.settings import Settings
from mpmcol.mpm.solver import Solver

H = 0.1
STIFF = elastic_body(density=1000.0, youngs_modulus=1e9, poissons_ratio=0.0)  # c_p = 1000 m/s


def thrown_block(v: tuple[float, ...], settings: Settings = PLAIN) -> tuple[Solver, Points]:
    """A stress-free block, three cells wide, in the middle of a large grid, and its initial points."""
    d = len(v)
    x = lattice((2.03, 4.01, 2.07)[:d], (2.33, 4.31, 2.37)[:d], H / 2)
    points = points_at(x, H / 2, density=1000.0)
    points.v[:] = v
    solver = make_solver(points, walled_grid((0.0,) * d, H, (45, 90, 45)[:d]), settings, body=STIFF)
    return solver, by_id(solver)
