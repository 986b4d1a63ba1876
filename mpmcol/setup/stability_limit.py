"""Single-particle stability limit of the explicit update, as a function of position, material and transfer scheme.

The stiffness matrix K of all particles is the sum of single-particle matrices K_p, and so is the lumped mass matrix M.
With K_p <= omega_p^2 M_p, K <= max(omega_p^2) M: the largest frequency of any body is at most that of its
stiffest particle (element eigenvalue theorem; B. M. Irons and G. Treharne, A bound theorem in eigenvalues and its
practical applications, 3rd Conf. on Matrix Methods in Structural Mechanics, Wright-Patterson AFB, Ohio, 1971).

One step of a single particle, with the stress updated last, maps its velocity, velocity gradient and stress linearly to
the next ones; it is stable while no eigenvalue of this map exceeds one in modulus.

Away from walls this means omega dt <= 2 with the Taylor term, where omega^2 = eig(C B W^-1 B^T) / rho, with B from the
gradients of the weights and W from the weights. Without the Taylor term the nodes receive no velocity gradient, so the
stress is mapped by itself, s' = (1 - omega^2 dt^2) s, which is stable for omega dt <= sqrt(2). APIC lies in between:
its affine matrix responds to stress by D^-1 s, where the gradient responds by B W^-1 B^T s.

Lengths are in units of h, velocities in units of c, the speed of compression waves, and stresses in rho c^2.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from itertools import product

import numpy as np

from mpmcol.mpm.boundary import FREE, BoundaryType
from mpmcol.mpm.shape_functions import SHAPE_FUNCTIONS
from mpmcol.mpm.simd import splat

TRANSFER_COEFFICIENTS = {  # of the Taylor term, and of FLIP in the velocity update
    "taylor-flip": (1.0, 1.0),
    "flip": (0.0, 1.0),
    "pic": (0.0, 0.0),
    "tpic": (1.0, 0.0),
    "apic": (1.0, 0.0),
}
MIDWAY = 4.499  # almost midway between two nodes, where quadratic and cubic B-splines are stiffest
NODES = 10  # per axis
GROWTH_LIMIT = 1.001  # modulus of an eigenvalue; one plus a margin for round-off
TOLERANCE = 1e-4  # of the limit


@dataclass(frozen=True)
class SingleParticle:
    """A particle alone in a grid.

    position: in cells from the low corner of the grid. nu: Poisson's ratio. faces: boundary at the first node of each
    axis (default: all free).
    """

    position: tuple[float, ...]
    nu: float = 0.2
    faces: tuple[BoundaryType, ...] = ()
    axisymmetric: bool = False
    transfer: str = "taylor-flip"
    flip_fraction: float = 1.0
    basis: str = "quadratic"
    correction: bool = True


@cache
def single_particle_limit(particle: SingleParticle) -> float:
    """The largest stable dt c / h, by bisection."""
    one_step = _step_map(particle)
    low, high = 0.0, 2.0
    while high - low > TOLERANCE:
        middle = 0.5 * (low + high)
        stable = np.abs(np.linalg.eigvals(one_step(middle))).max() < GROWTH_LIMIT
        low, high = (middle, high) if stable else (low, middle)
    return low


def _step_map(particle: SingleParticle) -> Callable[[float], np.ndarray]:
    """Function of dt that returns the matrix of one step.

    It acts on velocity (d), velocity gradient (d d) and stress (xx yy zz xy yz xz). Nodal vectors are stacked node by
    node.
    """
    d, (weights, slopes, distances, free) = len(particle.position), _nodes(particle)
    taylor, flip = TRANSFER_COEFFICIENTS[particle.transfer]
    flip *= particle.flip_fraction
    mean = np.hstack([w * np.eye(d) for w in weights])
    gradient, strain = _gradient(slopes), STRAIN[d] @ _gradient(slopes)
    if particle.axisymmetric:
        strain[2] += mean[0] / particle.position[0]
    velocity, stress = np.split(np.eye(d + d * d + 6), [d + d * d])
    nodal_velocity = np.vstack([np.hstack([np.eye(d), taylor * np.kron(np.eye(d), x)]) for x in distances]) @ velocity
    nodal_force = -(strain / np.repeat(weights, d)).T @ stress
    if particle.transfer == "apic":
        inertia = np.linalg.inv((weights * distances.T) @ distances)
        gradient = _gradient(weights[:, None] * distances @ inertia)

    def one_step(dt: float) -> np.ndarray:
        updated = free * (nodal_velocity + dt * nodal_force)
        increment = dt * free * nodal_force - (1.0 - free) * nodal_velocity  # includes the reaction of boundaries
        return np.vstack(
            [
                flip * (velocity[:d] + mean @ increment) + (1.0 - flip) * mean @ updated,
                gradient @ updated,
                stress + dt * _stiffness(particle.nu) @ strain @ updated,
            ]
        )

    return one_step


def _nodes(particle: SingleParticle) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Nodes in the support of the particle.

    Returns weights (n,), gradients (n, d), positions relative to the particle (n, d), and 0 for held velocity
    components, 1 for others (n d, 1).
    """
    d, nodes = len(particle.position), []
    faces = particle.faces or (FREE,) * d
    for along in product(*(_axis(s, particle) for s in particle.position)):
        w = np.array([node[1] for node in along])
        slope = [along[k][2] * np.delete(w, k).prod() for k in range(d)]
        on_face = [node[0] == 0 for node in along]
        fixed = any(on and face.holds == "all" for on, face in zip(on_face, faces, strict=True))
        held = [fixed or (on and face.holds == "normal") for on, face in zip(on_face, faces, strict=True)]
        nodes.append((w.prod(), slope, np.array([node[0] for node in along]) - particle.position, held))
    weights, slopes, distances, held_components = map(np.array, zip(*nodes, strict=True))
    return weights, slopes, distances, 1.0 - held_components.reshape(-1, 1)


def _axis(s: float, particle: SingleParticle) -> list[tuple[int, float, float]]:
    """Number, weight and gradient of the nodes along one axis whose weight is not zero."""
    evaluate = SHAPE_FUNCTIONS[particle.basis].evaluate
    first, *numbers = evaluate(splat(s), splat(0.5), splat(NODES - 1.5), particle.correction)
    w, g = np.array(numbers)[:, 0].reshape(2, -1)
    return [(int(first[0]) + k, w[k], g[k]) for k in range(len(w)) if w[k] > 0.0]


def _gradient(slopes: np.ndarray) -> np.ndarray:
    """Matrix (d d, n d) of the gradient of a nodal field, from the gradients of the weights (n, d)."""
    return np.hstack([np.kron(np.eye(slopes.shape[1]), slope[:, None]) for slope in slopes])


def _strain_of_gradient(d: int) -> np.ndarray:
    """Matrix (6, d d) from a velocity gradient to strain rates xx yy zz xy yz xz (engineering shear)."""
    strain = np.zeros((6, d, d))
    for row, (a, b) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))):
        if max(a, b) < d:
            strain[row, a, b] = strain[row, b, a] = 1.0
    return strain.reshape(6, d * d)


STRAIN = {d: _strain_of_gradient(d) for d in (2, 3)}


def _stiffness(nu: float) -> np.ndarray:
    """Elastic stiffness (6, 6) over rho c^2, for strains xx yy zz xy yz xz (engineering shear)."""
    ratio = nu / (1.0 - nu)
    normal = np.full((3, 3), ratio) + (1.0 - ratio) * np.eye(3)
    return np.block([[normal, np.zeros((3, 3))], [np.zeros((3, 3)), 0.5 * (1.0 - ratio) * np.eye(3)]])
