"""Building blocks of small problems: lattices of points, grids with boundary conditions, solvers, energies.

Points of an elastic body are of kind BASE and points of sand of kind COLUMN, so that all problems of a dimension share
one compiled time loop.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmcol.errors import NumericalFailure
from mpmcol.mpm.boundary import NO_SLIP, ROLLER, apply_boundaries, face
from mpmcol.mpm.constitutive import elastic, mohr_coulomb
from mpmcol.mpm.grid import Grid, allocate_grid
from mpmcol.mpm.lanes import ID, KIND, V0
from mpmcol.mpm.particles import BASE, Points
from mpmcol.mpm.settings import PAPER, Scheme, Settings
from mpmcol.mpm.solver import Body, Solver
from mpmcol.simulation.failure import diagnose, failure_message

G = 9.81
DENSITY, E, NU, PHI = 2650.0, 10e6, 0.2, 33.0
PLAIN = Settings(gravity_y=-G)
WEIGHTLESS = PLAIN._replace(gravity_y=0.0)
SIDES = (("left", "right"), ("bottom", "top"), ("back", "front"))  # low and high end of x, y, z
K_ACTIVE = (1.0 - np.sin(np.radians(PHI))) / (1.0 + np.sin(np.radians(PHI)))


def elastic_body(density: float = DENSITY, youngs_modulus: float = E, poissons_ratio: float = NU) -> Body:
    """An elastic body, by default with the elastic parameters of Table 1."""
    material = elastic.Material(density=density, youngs_modulus=youngs_modulus, poissons_ratio=poissons_ratio)
    return Body(elastic, elastic.make_params(material), material.wave_speed**2)


def sand_body(
    density: float = DENSITY, youngs_modulus: float = E, poissons_ratio: float = NU, **plastic: float
) -> Body:
    """Mohr-Coulomb sand, by default cohesionless with the parameters of Table 1."""
    keys: dict[str, Any] = {"friction_deg": PHI, "dilatancy_deg": 0.0} | plastic
    material = mohr_coulomb.Material(
        law="mohr-coulomb",
        density=density,
        youngs_modulus=youngs_modulus,
        poissons_ratio=poissons_ratio,
        **keys,
    )
    return Body(mohr_coulomb, mohr_coulomb.make_params(material), material.wave_speed**2)


def lattice(lower: tuple[float, ...], upper: tuple[float, ...], spacing: float) -> np.ndarray:
    """Centres (n, d) of squares or cubes of side `spacing` that tile the rectangle or box."""
    axes = [
        low + spacing * (np.arange(round((high - low) / spacing)) + 0.5) for low, high in zip(lower, upper, strict=True)
    ]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(lower))


def points_at(
    x: np.ndarray, spacing: float, kind: int = BASE, density: float = DENSITY, axisymmetric: bool = False
) -> Points:
    """Points at rest at `x` (n, d), each representing a square or cube of side `spacing`."""
    n, d = x.shape
    points = Points(n, d)
    points.x[:] = x
    points.rows[:, V0] = spacing**d * (x[:, 0] if axisymmetric else 1.0)
    points.m[:] = density * points.V0
    points.rows[:, KIND] = kind
    return points


def joined(*parts: Points) -> Points:
    """The points of several bodies, with new ids."""
    points = Points(sum(len(part) for part in parts), parts[0].dimension)
    number = points.id
    points.rows[:] = np.concatenate([part.rows for part in parts])
    points.rows[:, ID] = number
    return points


def walled_grid(
    origin: tuple[float, ...], h: float, cells: tuple[int, ...], rollers: str = "", no_slip: str = ""
) -> Grid:
    """A grid with boundary conditions on the named sides ("left right bottom top back front").

    rollers: sides that fix the normal velocity. no_slip: sides that fix all components.
    """
    grid = allocate_grid(origin, h, cells)
    apply_boundaries(
        grid,
        (
            face(grid, NO_SLIP if name in no_slip else ROLLER, axis, side)
            for axis in range(len(cells))
            for side, name in enumerate(SIDES[axis])
            if name in no_slip or name in rollers
        ),
    )
    return grid


def make_solver(
    points: Points,
    grid: Grid,
    settings: Settings,
    sand: Body | None = None,
    *,
    body: Body | None = None,
    scheme: Scheme = PAPER,
) -> Solver:
    """A solver with the laws of sand (kind COLUMN) and of an elastic body (kind BASE)."""
    return Solver(points, grid, settings, sand or sand_body(), body or elastic_body(), scheme)


def advance_to(solver: Solver, end: float) -> None:
    """Step until the time passes `end` (s); raises NumericalFailure if a point fails a check."""
    while solver.time < end:
        _raise_on_failure(solver, solver.advance(end))


def advance_steps(solver: Solver, steps: int) -> None:
    """Make exactly `steps` steps; raises NumericalFailure if a point fails a check."""
    last = solver.steps + steps
    while solver.steps < last:
        _raise_on_failure(solver, solver.advance(np.inf, max_steps=last - solver.steps))


def _raise_on_failure(solver: Solver, fault: int) -> None:
    if fault >= 0:
        failure = diagnose(solver, fault, "problem")
        raise NumericalFailure(failure_message(failure), failure)


def by_id(solver: Solver) -> Points:
    """The points in their initial order."""
    points = Points(len(solver.points), solver.points.dimension)
    points.rows[:] = solver.points.rows[np.argsort(solver.points.id)]
    return points


def kinetic_energy(points: Points) -> float:
    """Kinetic energy, J (per metre or radian in two dimensions)."""
    return float(0.5 * np.sum(points.m * np.sum(points.v**2, axis=1)))


def potential_energy(points: Points, gravity: float = G) -> float:
    """Potential energy relative to y = 0, J (per metre or radian in two dimensions)."""
    return float(gravity * np.sum(points.m * points.x[:, 1]))


def elastic_energy(points: Points, youngs_modulus: float = E, poissons_ratio: float = NU) -> float:
    """Strain energy of linear elasticity, J (per metre or radian in two dimensions)."""
    s = points.sigma
    trace = s[:, :3].sum(axis=1)
    norm2 = np.sum(s[:, :3] ** 2, axis=1) + 2.0 * np.sum(s[:, 3:] ** 2, axis=1)
    density = ((1.0 + poissons_ratio) * norm2 - poissons_ratio * trace**2) / (2.0 * youngs_modulus)
    return float(np.sum(points.V * density))
