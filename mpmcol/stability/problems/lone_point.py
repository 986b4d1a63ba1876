"""A single elastic point: the time step up to which it is stable, from the kernels and from theory.

The stiffness of all points is the sum of one-point matrices, and so is the lumped mass; the largest frequency of any
body is at most that of the stiffest single point (the element eigenvalue theorem). For one point it follows from six
strains at most: omega^2 = eig(C B W^-1 B^T) / rho, with B from the weights' gradients and W from the weights.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from mpmcol.basis.quadratic import spline
from mpmcol.errors import NumericalFailure
from mpmcol.stability.blocks import (
    DENSITY,
    SIDES,
    WEIGHTLESS,
    E,
    advance_steps,
    elastic_body,
    lattice,
    make_solver,
    points_at,
    walled_grid,
)

CELLS = 9
NODES = CELLS + 1
STEPS = 200
AMPLITUDE = 1e-9  # of the first strain: all stays linear
GROWN = 10.0  # a mode 1 % above its bound grows by e^0.28 a step; within it nothing grows tenfold


@dataclass(frozen=True)
class LonePoint:
    """A point at `place` (in cells from the low corner); low sides named in `rollers` are smooth walls."""

    place: tuple[float, ...]
    nu: float = 0.2
    axisymmetric: bool = False
    rollers: str = ""
    taylor: float = 1.0
    flip_fraction: float = 1.0
    neighbours: int = 0  # points in line with it along each axis, half a cell apart: a body, which theory leaves out

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return len(self.place)


def growth(point: LonePoint, cfl: float) -> float:
    """Largest stress after STEPS steps over that at the start, infinite if the solver gives up."""
    away = lattice((0.0,) * point.dimension, (0.5 * (1 + point.neighbours),) * point.dimension, 0.5) - 0.25
    x = np.array([point.place]) + away
    points = points_at(x, 0.5, density=DENSITY, axisymmetric=point.axisymmetric)
    body = elastic_body(DENSITY, E, point.nu)
    modulus = body.wave_speed2 * DENSITY
    start = AMPLITUDE * modulus * np.random.default_rng(5).uniform(0.5, 1.0, (len(x), 6))
    points.sigma = start
    grid = walled_grid((0.0,) * point.dimension, 1.0, (CELLS,) * point.dimension, rollers=point.rollers)
    settings = WEIGHTLESS._replace(
        cfl=cfl, axisymmetric=point.axisymmetric, axis_gap=0.0, taylor=point.taylor, flip_fraction=point.flip_fraction
    )
    solver = make_solver(points, grid, settings, body=body)
    try:
        advance_steps(solver, STEPS)
    except NumericalFailure:
        return float("inf")
    return float(np.abs(solver.points.sigma).max() / np.abs(start).max())


def largest_stable_step(point: LonePoint) -> float:
    """Bisection for the largest stable dt c / h on the kernels, within half a per cent of itself."""
    low, high = 0.5 * one_point_bound(point), 1.5 * one_point_bound(point)
    while high - low > 0.005 * low:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if growth(point, middle) < GROWN else (low, middle)
    return 0.5 * (low + high)


def one_point_bound(point: LonePoint) -> float:
    """The largest stable dt c / h by theory; without the Taylor term one over the square root of two of it.

    A lone point without it hands its nodes no velocity gradient: stress follows from stress alone,
    sigma' = (1 - omega^2 dt^2) sigma, which is stable up to omega dt = sqrt(2) instead of 2.
    """
    strains, free_weights = _strain_matrix(point)
    compliance_free = _stiffness(point) @ (strains / free_weights) @ strains.T
    omega2 = float(np.linalg.eigvals(compliance_free).real.max())
    return (2.0 if point.taylor else np.sqrt(2.0)) / np.sqrt(omega2)


def _stiffness(point: LonePoint) -> np.ndarray:
    """C / (rho c^2) for strains xx yy zz xy yz xz, engineering shear."""
    ratio = point.nu / (1.0 - point.nu)
    normal = np.full((3, 3), ratio) + (1.0 - ratio) * np.eye(3)
    shear = 0.5 * (1.0 - ratio) * np.eye(3)
    return np.block([[normal, np.zeros((3, 3))], [np.zeros((3, 3)), shear]])


def _strain_matrix(point: LonePoint) -> tuple[np.ndarray, np.ndarray]:
    """Columns of B (6, n) for all free components of all nodes, and the nodes' weights (n,); h = 1."""
    d, axes = point.dimension, []
    for s in point.place:
        first, *numbers = spline(s, NODES, True)
        axes.append([(first + k, numbers[k], numbers[3 + k]) for k in range(3)])
    columns, weights = [], []
    for nodes in product(*axes):
        w = np.array([node[1] for node in nodes])
        weight = float(w.prod())
        if weight <= 0.0:
            continue
        slope = np.array([nodes[k][2] * np.delete(w, k).prod() for k in range(d)])
        for component in range(d):
            if nodes[component][0] == 0 and SIDES[component][0] in point.rollers:
                continue
            columns.append(_strain(slope, component, weight / point.place[0] if point.axisymmetric else 0.0))
            weights.append(weight)
    return np.array(columns).T, np.array(weights)


def _strain(slope: np.ndarray, component: int, hoop: float) -> np.ndarray:
    """Strain of a unit velocity component at one node."""
    gradient = np.zeros((3, 3))
    gradient[component, : len(slope)] = slope
    if component == 0:
        gradient[2, 2] += hoop
    shear = gradient + gradient.T
    return np.array([*np.diag(gradient), shear[0, 1], shear[1, 2], shear[0, 2]])
