"""MPM in Warp like `example` in Taichi: an array per quantity, atomic scatter, unsorted points; on the CPU.

Warp runs a kernel on the CPU as one loop in the calling thread, in which its atomic operations are ordinary ones.
"""

from typing import ClassVar

import numpy as np
import warp as wp

from scripts.peers.problem import MASS_FLOOR, WALL_GAP, Problem
from scripts.peers.warp_physics import make_move_node, make_stencil, make_update_stress, make_weigh

REAL = {"f32": wp.float32, "f64": wp.float64}

wp.config.log_level = wp.LOG_WARNING  # no line for each compiled kernel


class WarpExample:
    """One simulation in single or double precision (`f32`, `f64`)."""

    STATE: ClassVar = ("x", "v", "grad_v", "sigma", "m", "V0", "J", "opening")

    def __init__(self, problem: Problem, precision: str = "f64") -> None:
        real = REAL[precision]
        self.h, self.cfl, self.n, self.n_nodes = problem.h, problem.cfl, len(problem.x), problem.wall_bits.size
        points, nodes = make_structs(problem.dim, real)
        self.points, self.nodes = points(), nodes()
        self._load(problem, real)
        self.speed = wp.array([problem.speed], dtype=real, device="cpu")
        self.next_speed = wp.zeros_like(self.speed)
        self.p2g = make_p2g(problem, real, points, nodes)
        self.update_grid = make_update_grid(problem, real, nodes)
        self.g2p = make_g2p(problem, real, points, nodes)

    def _load(self, problem: Problem, real: type) -> None:
        d = problem.dim
        vec = wp.types.vector(d, real)
        types = {"x": vec, "v": vec, "grad_v": wp.types.matrix((d, d), real), "kind": int}
        for name in ("x", "v", "grad_v", "m", "V0", "J", "opening", "kind"):
            setattr(self.points, name, wp.array(getattr(problem, name), dtype=types.get(name, real), device="cpu"))
        self.points.sigma = wp.array(problem.sigma[:, : 2 * d], dtype=wp.types.vector(2 * d, real), device="cpu")
        self.nodes.m = wp.zeros(self.n_nodes, dtype=real, device="cpu")
        self.nodes.v, self.nodes.a = (wp.zeros(self.n_nodes, dtype=vec, device="cpu") for _ in range(2))
        self.nodes.walls = wp.array(problem.wall_bits.ravel(), dtype=wp.uint8, device="cpu")

    @property
    def dt(self) -> float:
        """Next time step, s."""
        return self.cfl * self.h / float(self.speed.numpy()[0])

    def state(self) -> dict[str, np.ndarray]:
        """Arrays of the points."""
        return {name: getattr(self.points, name).numpy() for name in self.STATE}

    def advance(self, steps: int) -> None:
        """Do `steps` steps, Eq. 13-36."""
        for _ in range(steps):
            for values in (self.nodes.m, self.nodes.v, self.nodes.a, self.next_speed):
                values.zero_()
            wp.launch(self.p2g, self.n, [self.points, self.nodes], device="cpu")
            wp.launch(self.update_grid, self.n_nodes, [self.nodes, self.speed], device="cpu")
            wp.launch(self.g2p, self.n, [self.points, self.nodes, self.speed, self.next_speed], device="cpu")
            self.speed, self.next_speed = self.next_speed, self.speed


def make_structs(d: int, real: type) -> tuple[type, type]:
    """Arrays of the points and of the nodes; the nodes of all axes are numbered in one sequence."""
    vec, square, stress = wp.types.vector(d, real), wp.types.matrix((d, d), real), wp.types.vector(2 * d, real)

    @wp.struct
    class Points:
        x: wp.array(dtype=vec)
        v: wp.array(dtype=vec)
        grad_v: wp.array(dtype=square)
        sigma: wp.array(dtype=stress)
        m: wp.array(dtype=real)
        V0: wp.array(dtype=real)
        J: wp.array(dtype=real)
        opening: wp.array(dtype=real)
        kind: wp.array(dtype=int)

    @wp.struct
    class Nodes:
        m: wp.array(dtype=real)
        v: wp.array(dtype=vec)  # momentum, then velocity
        a: wp.array(dtype=vec)  # force, then acceleration
        walls: wp.array(dtype=wp.uint8)

    return Points, Nodes


def options_of(problem: Problem) -> dict[str, object]:
    """Options of a kernel: a module of its own without derivatives, loops over the stencil unrolled."""
    return {"module": "unique", "module_options": {"enable_backward": False, "max_unroll": 3**problem.dim}}


def make_p2g(problem: Problem, real: type, points_type: type, nodes_type: type) -> wp.Kernel:
    """Kernel `p2g(points, nodes)`: mass, momentum and force of the nodes, Eq. 13, 14, 19, 20."""
    d, n_nodes = problem.dim, problem.n_nodes
    vec, ints, square = wp.types.vector(d, real), wp.types.vector(d, int), wp.types.matrix((d, d), real)
    stencil, (weigh, address) = make_stencil(n_nodes, real), make_weigh(n_nodes, real, problem.h)
    _, to_matrix = make_update_stress(d, real, problem.material)
    origin, h, per_h, gravity = vec(*problem.origin), real(problem.h), real(1.0 / problem.h), real(problem.gravity)
    offsets = [ints(*offset) for offset in np.ndindex(*(3,) * d)]

    @wp.kernel(**options_of(problem))
    def p2g(points: points_type, nodes: nodes_type):
        p = wp.tid()
        x = points.x[p]
        v = points.v[p]
        m = points.m[p]
        base, w, g = stencil((x - origin) * per_h)
        affine, full, stress = m * points.grad_v[p], to_matrix(points.sigma[p]), square()
        volume = points.J[p] * points.V0[p]
        for a in range(d):
            for b in range(d):
                stress[a, b] = -volume * full[a, b]
        body, arm = vec(), vec()
        body[1] = -m * gravity
        for k in range(wp.static(len(offsets))):
            i = ints(wp.static(offsets[k]))
            weight, gradient = weigh(i, w, g)
            for a in range(d):
                arm[a] = origin[a] + real(base[a] + i[a]) * h - x[a]
            node = address(base + i)
            wp.atomic_add(nodes.m, node, weight * m)
            wp.atomic_add(nodes.v, node, weight * (m * v + affine * arm))
            wp.atomic_add(nodes.a, node, weight * body + stress * gradient)

    return p2g


def make_update_grid(problem: Problem, real: type, nodes_type: type) -> wp.Kernel:
    """Kernel `update_grid(nodes, speed)`: velocity and acceleration of the nodes, Eq. 21-24."""
    vec = wp.types.vector(problem.dim, real)
    move_node = make_move_node(problem.dim, real, problem.alpha_d)
    floor, course = real(MASS_FLOOR * problem.m.min()), real(problem.cfl * problem.h)

    @wp.kernel(**options_of(problem))
    def update_grid(nodes: nodes_type, speed: wp.array(dtype=real)):
        i = wp.tid()
        v, a = vec(), vec()
        if nodes.m[i] > floor:
            v, a = move_node(nodes.v[i], nodes.a[i], nodes.m[i], int(nodes.walls[i]), course / speed[0])
        nodes.v[i] = v
        nodes.a[i] = a

    return update_grid


def make_g2p(problem: Problem, real: type, points_type: type, nodes_type: type) -> wp.Kernel:
    """Kernel `g2p(points, nodes, speed, next_speed)`: points after the step, Eq. 25-36; needs `next_speed` = 0."""
    d, n_nodes = problem.dim, problem.n_nodes
    vec, ints, square = wp.types.vector(d, real), wp.types.vector(d, int), wp.types.matrix((d, d), real)
    stencil, (weigh, address) = make_stencil(n_nodes, real), make_weigh(n_nodes, real, problem.h)
    update_stress, _ = make_update_stress(d, real, problem.material)
    origin, per_h, half, course = vec(*problem.origin), real(1.0 / problem.h), real(0.5), real(problem.cfl * problem.h)
    low = vec(*(problem.origin + WALL_GAP * problem.h))
    high = vec(*(problem.origin + (np.array(n_nodes) - 1.0 - WALL_GAP) * problem.h))
    wave_speed2 = real(problem.material.wave_speed2)
    offsets = [ints(*offset) for offset in np.ndindex(*(3,) * d)]

    @wp.kernel(**options_of(problem))
    def g2p(points: points_type, nodes: nodes_type, speed: wp.array(dtype=real), next_speed: wp.array(dtype=real)):
        p = wp.tid()
        x = points.x[p]
        dt = course / speed[0]
        base, w, g = stencil((x - origin) * per_h)
        v, a, grad_v = vec(), vec(), square()
        for k in range(wp.static(len(offsets))):
            i = ints(wp.static(offsets[k]))
            weight, gradient = weigh(i, w, g)
            node = address(base + i)
            node_v = nodes.v[node]
            v += weight * node_v
            a += weight * nodes.a[node]
            grad_v += wp.outer(node_v, gradient)
        new_v = points.v[p] + dt * a  # Eq. 26
        x += dt * (v - half * dt * a)  # Eq. 27
        points.x[p] = wp.min(wp.max(x, low), high)
        points.v[p] = new_v
        points.grad_v[p] = grad_v  # Eq. 28
        column = points.kind[p] == 0
        sigma, J, opening = update_stress(grad_v, dt, points.sigma[p], points.J[p], points.opening[p], column)
        points.sigma[p] = sigma
        points.J[p] = J
        points.opening[p] = opening
        wp.atomic_max(next_speed, 0, wp.sqrt(wave_speed2 * J) + wp.length(new_v))

    return g2p
