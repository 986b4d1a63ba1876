"""The largest time step that a point alone bears, from its place, its material and how it gives velocity to the nodes.

The stiffness of all points is the sum of one-point matrices, and so is the lumped mass; the largest frequency of any
body is at most that of its stiffest single point (the element eigenvalue theorem). A step of one point, its stress
updated last, maps its velocity, velocity gradient and stress linearly to the next ones; it is stable while no
eigenvalue of that map is larger than one. Away from walls this is omega dt = 2 with the Taylor term, where
omega^2 = eig(C B W^-1 B^T) / rho with B from the weights' gradients and W from the weights. Without the Taylor term the
nodes know no velocity gradient, and stress follows from stress alone, sigma' = (1 - omega^2 dt^2) sigma, which is
stable up to omega dt = sqrt(2). APIC is between them: its affine matrix answers stress by D^-1 sigma, the gradient by
B W^-1 B^T sigma.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from itertools import product

import numpy as np

from mpmcol.mpm.shape_functions import SHAPE_FUNCTIONS
from mpmcol.mpm.simd import splat

TRANSFERS = {  # Taylor term, share of FLIP
    "taylor-flip": (1.0, 1.0),
    "flip": (0.0, 1.0),
    "pic": (0.0, 0.0),
    "tpic": (1.0, 0.0),
    "apic": (1.0, 0.0),
}
BETWEEN = 4.499  # almost half-way between two nodes, where quadratic and cubic splines are stiffest
NODES = 10  # an axis
FREE, SMOOTH, STICKING = "free", "smooth", "sticking"  # first nodes: as others, held across the wall, held at all
GROWS = 1.001  # an eigenvalue beyond round-off of one


@dataclass(frozen=True)
class LonePoint:
    """A point at `place`, in cells from the low corner of a grid whose first nodes are what `walls` says, axis by axis.

    No walls: all are free. nu: Poisson's ratio.
    """

    place: tuple[float, ...]
    nu: float = 0.2
    walls: tuple[str, ...] = ()
    axisymmetric: bool = False
    transfer: str = "taylor-flip"
    flip_fraction: float = 1.0
    basis: str = "quadratic"
    correction: bool = True


@cache
def one_point_bound(point: LonePoint) -> float:
    """The largest stable dt c / h by bisection, within 1e-4; c is the speed of compression waves."""
    one_step = _step_map(point)
    low, high = 0.0, 2.0
    while high - low > 1e-4:
        middle = 0.5 * (low + high)
        stable = np.abs(np.linalg.eigvals(one_step(middle))).max() < GROWS
        low, high = (middle, high) if stable else (low, middle)
    return low


def _step_map(point: LonePoint) -> Callable[[float], np.ndarray]:
    """Of dt: what a step makes of velocity (d), its gradient (d d) and stress over rho c2 (xx yy zz xy yz xz); h = 1.

    The nodes' components stand in one row, node by node.
    """
    d, (weights, slopes, place, free) = len(point.place), _nodes(point)
    taylor, flip = TRANSFERS[point.transfer]
    flip *= point.flip_fraction
    mean = np.hstack([w * np.eye(d) for w in weights])
    gradient, strain = _gradient(slopes), STRAIN[d] @ _gradient(slopes)
    if point.axisymmetric:
        strain[2] += mean[0] / point.place[0]
    velocity, stress = np.split(np.eye(d + d * d + 6), [d + d * d])
    handed = np.vstack([np.hstack([np.eye(d), taylor * np.kron(np.eye(d), x)]) for x in place]) @ velocity
    pushed = -(strain / np.repeat(weights, d)).T @ stress
    if point.transfer == "apic":
        inertia = np.linalg.inv((weights * place.T) @ place)
        gradient = _gradient(weights[:, None] * place @ inertia)

    def one_step(dt: float) -> np.ndarray:
        moved = free * (handed + dt * pushed)
        faster = dt * free * pushed - (1.0 - free) * handed  # walls hand on their impulse
        return np.vstack(
            [
                flip * (velocity[:d] + mean @ faster) + (1.0 - flip) * mean @ moved,
                gradient @ moved,
                stress + dt * _stiffness(point.nu) @ strain @ moved,
            ]
        )

    return one_step


def _nodes(point: LonePoint) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Weights (n,), gradients (n, d) and places from the point (n, d) of its nodes; 0 where they are held (n d, 1)."""
    d, found = len(point.place), []
    walls = point.walls or (FREE,) * d
    for nodes in product(*(_axis(s, point) for s in point.place)):
        w = np.array([node[1] for node in nodes])
        slope = [nodes[k][2] * np.delete(w, k).prod() for k in range(d)]
        on_wall = [node[0] == 0 for node in nodes]
        sticks = any(on and wall == STICKING for on, wall in zip(on_wall, walls, strict=True))
        held = [sticks or (on and wall == SMOOTH) for on, wall in zip(on_wall, walls, strict=True)]
        found.append((w.prod(), slope, np.array([node[0] for node in nodes]) - point.place, held))
    weights, slopes, place, fixed = map(np.array, zip(*found, strict=True))
    return weights, slopes, place, 1.0 - fixed.reshape(-1, 1)


def _axis(s: float, point: LonePoint) -> list[tuple[int, float, float]]:
    """Nodes with weight of an axis: number, weight, gradient."""
    first, *numbers = SHAPE_FUNCTIONS[point.basis].evaluate(splat(s), splat(0.5), splat(NODES - 1.5), point.correction)
    w, g = np.array(numbers)[:, 0].reshape(2, -1)
    return [(int(first[0]) + k, w[k], g[k]) for k in range(len(w)) if w[k] > 0.0]


def _gradient(slopes: np.ndarray) -> np.ndarray:
    """Gradient (d d, n d) of a field from the nodes' components, with slopes (n, d)."""
    return np.hstack([np.kron(np.eye(slopes.shape[1]), slope[:, None]) for slope in slopes])


def _strain_of_gradient(d: int) -> np.ndarray:
    """Strain xx yy zz xy yz xz (engineering shear) from a velocity gradient (d d,)."""
    strain = np.zeros((6, d, d))
    for row, (a, b) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))):
        if max(a, b) < d:
            strain[row, a, b] = strain[row, b, a] = 1.0
    return strain.reshape(6, d * d)


STRAIN = {d: _strain_of_gradient(d) for d in (2, 3)}


def _stiffness(nu: float) -> np.ndarray:
    """C / (rho c2) for strains xx yy zz xy yz xz, engineering shear."""
    ratio = nu / (1.0 - nu)
    normal = np.full((3, 3), ratio) + (1.0 - ratio) * np.eye(3)
    return np.block([[normal, np.zeros((3, 3))], [np.zeros((3, 3)), 0.5 * (1.0 - ratio) * np.eye(3)]])
