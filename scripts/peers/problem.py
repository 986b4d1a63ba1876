"""The simulated problem as plain arrays, the same for every code."""

from __future__ import annotations

from dataclasses import dataclass
from math import radians, sin

import numpy as np

from mpmcol.mpm.grid import NODE
from mpmcol.mpm.particles import COLUMN
from mpmcol.mpm.solver import Solver

WALL_GAP = 0.1  # in h: smallest distance of a point from a wall
MASS_FLOOR = 1e-20  # nodes below this fraction of the smallest point mass are empty


@dataclass(frozen=True)
class Material:
    """Moduli (Pa), N_phi, N_psi, mean stress at the apex (Pa), square of the wave speed (m2/s2) of Eq. 36."""

    bulk: float
    shear: float
    n_phi: float
    n_psi: float
    apex: float
    wave_speed2: float


@dataclass(frozen=True)
class Problem:
    """n points and a grid in d = 2 (plane strain) or 3 dimensions; SI units, tension > 0, y is up.

    The first and the last nodes of each axis are on walls. The column is Mohr-Coulomb, the base elastic.
    """

    x: np.ndarray  # (n, d)
    v: np.ndarray  # (n, d)
    grad_v: np.ndarray  # (n, d, d): [a, b] = d v_a / d x_b
    sigma: np.ndarray  # (n, 6): xx yy zz xy yz xz
    m: np.ndarray  # (n,)
    V0: np.ndarray  # (n,)
    J: np.ndarray  # (n,)
    opening: np.ndarray  # (n,) opening strain
    kind: np.ndarray  # (n,) int32: 0 for the column, 1 for the base
    origin: np.ndarray  # (d,) first node
    h: float
    fixed: np.ndarray  # (n_1, ..., n_d, d) bool: components of the velocity that walls hold at zero
    material: Material
    alpha_d: float = 0.05
    cfl: float = 0.5
    gravity: float = 9.81  # along -y

    @property
    def dim(self) -> int:
        """Number of axes."""
        return self.x.shape[1]

    @property
    def n_nodes(self) -> tuple[int, ...]:
        """Nodes per axis."""
        return self.fixed.shape[:-1]

    @property
    def wall_bits(self) -> np.ndarray:
        """`fixed` as one uint8 per node, bit a for component a."""
        return np.packbits(self.fixed, axis=-1, bitorder="little")[..., 0]

    @property
    def speed(self) -> float:
        """Largest wave speed plus speed of all points, Eq. 35."""
        return float((np.sqrt(self.material.wave_speed2 * self.J) + np.linalg.norm(self.v, axis=1)).max())


def make_material(
    E: float, nu: float, phi_deg: float, density: float, psi_deg: float = 0.0, cohesion: float = 0.0
) -> Material:
    """From Young's modulus, Poisson's ratio, angles of friction and dilatancy, and cohesion."""
    bulk, shear, phi, psi = E / (3.0 * (1.0 - 2.0 * nu)), E / (2.0 * (1.0 + nu)), radians(phi_deg), radians(psi_deg)
    n_phi, n_psi = ((1.0 + sin(angle)) / (1.0 - sin(angle)) for angle in (phi, psi))
    return Material(bulk, shear, n_phi, n_psi, cohesion / np.tan(phi), (bulk + 4.0 / 3.0 * shear) / density)


def from_solver(solver: Solver) -> Problem:
    """Present state of an mpmcol solver in plane strain or 3D, Mohr-Coulomb over an elastic base of equal moduli."""
    points, grid, settings, body = solver.points, solver.grid, solver.settings, solver.bodies[COLUMN]
    d, params = points.dimension, body.params
    address = (grid.ax[:, None, None] + grid.ay[:, None] + grid.az) // NODE
    walls = grid.fixed[address] if d == 3 else grid.fixed[address[..., 0]]
    return Problem(
        x=points.x.copy(), v=points.v.copy(), grad_v=points.grad_v[:, :d, :d], sigma=points.sigma, m=points.m.copy(),
        V0=points.V0.copy(), J=points.J.copy(), opening=points.opening.copy(), kind=points.kind.astype(np.int32),
        origin=np.array([grid.origin_x, grid.origin_y, grid.origin_z][:d]), h=grid.h,
        fixed=np.stack([walls >> a & 1 for a in range(d)], axis=-1).astype(bool),
        material=Material(
            params.bulk_modulus, params.shear_modulus, params.n_phi, params.n_psi, params.apex, body.wave_speed2
        ),
        alpha_d=settings.alpha_d, cfl=settings.cfl, gravity=-settings.gravity_y,
    )  # fmt: skip
