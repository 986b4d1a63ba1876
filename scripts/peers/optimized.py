"""Optimised MPM in Taichi: points sorted by blocks of cells, blocks of one colour in parallel, no atomic operations."""

from typing import ClassVar

import numpy as np
import taichi as ti

from scripts.peers.blocks import Blocks
from scripts.peers.physics import component, move_node, stencil, update_stress
from scripts.peers.problem import MASS_FLOOR, WALL_GAP, Problem

BLOCK = {2: (8, 8), 3: (4, 4, 4)}  # cells


@ti.data_oriented
class Optimized:
    """One simulation; call `ti.init` with the options in `TAICHI` before."""

    # By default Taichi splits loops into chunks of at least 512 iterations; a loop over blocks has fewer.
    TAICHI: ClassVar = {"make_cpu_multithreading_loop": False}

    def __init__(self, problem: Problem) -> None:
        d = self.dim = problem.dim
        self.n_nodes, self.h, self.gravity = problem.n_nodes, problem.h, problem.gravity
        self.material, self.alpha_d, self.cfl = problem.material, problem.alpha_d, problem.cfl
        self.origin, self.floor = tuple(problem.origin.tolist()), MASS_FLOOR * float(problem.m.min())
        vector, matrix = ti.types.vector, ti.types.matrix
        point = ti.types.struct(
            x=vector(d, float), v=vector(d, float), grad_v=matrix(d, d, float), sigma=vector(4 if d == 2 else 6, float),
            m=float, V0=float, J=float, opening=float, kind=int,
        )  # fmt: skip
        self.blocks = Blocks(point, problem, BLOCK[d])
        self.points = self.blocks.points
        # a node holds mass, momentum and force, after the grid update mass, velocity and acceleration
        self.nodes = ti.Vector.field(2 * d + 1, float, self.blocks.nodes)
        self.walls = ti.field(ti.u8, self.blocks.nodes)
        self.speed, self.travel = ti.field(float, ()), ti.field(float, ())
        self.travelled = np.inf  # since the last sort, in cells
        self._load(problem)

    def _load(self, problem: Problem) -> None:
        names = ("x", "v", "grad_v", "m", "V0", "J", "opening", "kind")
        sigma = problem.sigma[:, : 4 if self.dim == 2 else 6]
        self.points.from_numpy({**{name: getattr(problem, name) for name in names}, "sigma": sigma})
        walls = np.zeros(self.walls.shape, np.uint8)
        walls[tuple(map(slice, self.n_nodes))] = problem.wall_bits
        self.walls.from_numpy(walls)
        self.speed[None] = problem.speed

    @property
    def dt(self) -> float:
        """Next time step, s."""
        return self.cfl * self.h / self.speed[None]

    def state(self) -> dict[str, np.ndarray]:
        """Arrays of the points, in their present order."""
        return self.points.to_numpy()

    def advance(self, steps: int) -> None:
        """Do `steps` steps; sort when a point may have travelled one cell since the last sort."""
        for _ in range(steps):
            if self.travelled >= 1.0:
                self.blocks.sort()
                self.travelled = 0.0
            self.travelled += self.step()

    def step(self) -> float:
        """One step, Eq. 13-36; returns the largest displacement of a point, in cells.

        In 3D with a kernel per colour, since Taichi's compile time grows faster than the length of a kernel.
        """
        if self.dim == 2:
            return self.step_2d()
        self.clear_kernel()
        for colour in range(self.blocks.colours):
            self.p2g_kernel(colour)
        return self.move_kernel()

    @ti.kernel
    def step_2d(self) -> float:
        self.clear()
        for colour in ti.static(range(self.blocks.colours)):
            self.p2g(colour)
        return self.move()

    @ti.kernel
    def clear_kernel(self):
        self.clear()

    @ti.kernel
    def p2g_kernel(self, colour: int):
        self.p2g(colour)

    @ti.kernel
    def move_kernel(self) -> float:
        return self.move()

    @ti.func
    def clear(self):
        ti.loop_config(block_dim=1)
        for k in range(self.blocks.n_reached[None]):
            first = self.blocks.first_node(self.blocks.reached[k])
            for i in ti.grouped(ti.ndrange(*self.blocks.shape)):
                self.nodes[first + i] = ti.zero(self.nodes[first + i])

    @ti.func
    def p2g(self, colour):
        ti.loop_config(block_dim=1)
        for k in range(self.blocks.n_occupied[colour]):
            block = self.blocks.occupied[colour, k]
            for p in range(self.blocks.first(block), self.blocks.first(block + 1)):
                self.scatter(p)

    @ti.func
    def move(self):
        """Grid update and G2P."""
        dt = self.cfl * self.h / self.speed[None]
        self.speed[None], self.travel[None] = 0.0, 0.0
        ti.loop_config(block_dim=1)
        for k in range(self.blocks.n_reached[None]):
            first = self.blocks.first_node(self.blocks.reached[k])
            for i in ti.grouped(ti.ndrange(*self.blocks.shape)):
                self.update_node(first + i, dt)
        ti.loop_config(block_dim=1)
        for block in range(self.blocks.total):
            speed, travel = 0.0, 0.0
            for p in range(self.blocks.first(block), self.blocks.first(block + 1)):
                speed_p, travel_p = self.move_point(p, dt)
                speed, travel = ti.max(speed, speed_p), ti.max(travel, travel_p)
            if speed > 0.0:
                ti.atomic_max(self.speed[None], speed)
                ti.atomic_max(self.travel[None], travel)
        return self.travel[None] / self.h

    @ti.func
    def scatter(self, p):
        """P2G of one point, Eq. 13, 14, 19, 20."""
        d, h = ti.static(self.dim, self.h)
        point = self.points[p]
        s = (point.x - ti.Vector(self.origin)) * (1.0 / h)
        base, w, g = stencil(s, self.n_nodes)
        here = ti.Vector.zero(float, 2 * d + 1)  # mass, momentum and weight at the point
        here[0], here[d + 2] = point.m, -point.m * self.gravity
        for a in ti.static(range(d)):
            here[1 + a] = point.m * point.v[a]
        along = ti.Matrix.zero(float, 3 * d, 2 * d)  # what node k along axis b adds: m L (x_i - x_p), -V sigma grad w
        for b, k in ti.static(ti.ndrange(d, 3)):
            arm = w[k, b] * (base[b] + k - s[b]) * (point.m * h)
            push = -g[k, b] * (point.J * point.V0 * (1.0 / h))
            for a in ti.static(range(d)):
                along[3 * b + k, a] = arm * point.grad_v[a, b]
                along[3 * b + k, d + a] = push * component(point.sigma, a, b)
        self.scatter_along(0, base, here, 1.0, w, along)

    @ti.func
    def scatter_along(self, axis: ti.template(), node, value, weight, w: ti.template(), along: ti.template()):
        """Add `value` to the nodes along `axis` and the following axes; `weight`: product over the previous axes."""
        if ti.static(axis == self.dim):
            for c in ti.static(range(2 * self.dim + 1)):
                self.nodes[node][c] = self.nodes[node][c] + value[c]  # += would be atomic
        else:
            for k in ti.static(range(3)):
                part = w[k, axis] * value
                for c in ti.static(range(2 * self.dim)):
                    part[1 + c] += weight * along[3 * axis + k, c]
                following = node + k * ti.Vector.unit(self.dim, axis, int)
                self.scatter_along(axis + 1, following, part, weight * w[k, axis], w, along)

    @ti.func
    def update_node(self, i, dt):
        d = ti.static(self.dim)
        node = self.nodes[i]
        if node[0] > self.floor:
            v, a = move_node(node[1 : d + 1], node[d + 1 : 2 * d + 1], node[0], self.walls[i], self.alpha_d, dt)
            for c in ti.static(range(d)):
                self.nodes[i][1 + c], self.nodes[i][1 + d + c] = v[c], a[c]
        else:
            self.nodes[i] = ti.zero(node)

    @ti.func
    def gather(self, axis: ti.template(), i, w: ti.template(), g: ti.template()):
        """Velocity and acceleration, and velocity gradient (times h), summed along `axis` and the following axes."""
        mean, grad = ti.Vector.zero(float, 2 * self.dim), ti.Matrix.zero(float, self.dim, self.dim)
        if ti.static(axis == self.dim):
            node = self.nodes[i]
            for c in ti.static(range(2 * self.dim)):
                mean[c] = node[1 + c]
        else:
            for k in ti.static(range(3)):
                part, slope = self.gather(axis + 1, i + k * ti.Vector.unit(self.dim, axis, int), w, g)
                mean += w[k, axis] * part
                for a in ti.static(range(self.dim)):
                    grad[a, axis] += g[k, axis] * part[a]
                    for b in ti.static(range(axis + 1, self.dim)):
                        grad[a, b] += w[k, axis] * slope[a, b]
        return mean, grad

    @ti.func
    def move_point(self, p, dt):
        """G2P and stress of one point; returns its wave speed plus speed, and its displacement."""
        d, h = ti.static(self.dim, self.h)
        point = self.points[p]
        base, w, g = stencil((point.x - ti.Vector(self.origin)) * (1.0 / h), self.n_nodes)
        mean, grad = self.gather(0, base, w, g)
        v, a = mean[:d], mean[d:]
        point.v += dt * a  # Eq. 26
        displacement = dt * (v - 0.5 * dt * a)  # Eq. 27
        for c in ti.static(range(d)):
            low, high = ti.static(self.origin[c] + WALL_GAP * h, self.origin[c] + (self.n_nodes[c] - 1 - WALL_GAP) * h)
            point.x[c] = ti.min(ti.max(point.x[c] + displacement[c], low), high)
        point.grad_v = grad * (1.0 / h)  # Eq. 28
        point.sigma, point.J, point.opening = update_stress(
            point.grad_v, dt, point.sigma, point.J, point.opening, point.kind == 0, self.material
        )
        self.points[p] = point
        return ti.sqrt(self.material.wave_speed2 * point.J) + point.v.norm(), ti.abs(displacement).max()
