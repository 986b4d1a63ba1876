"""MPM in Taichi as in its examples (mpm128.py, mpm3d.py): a field per quantity, atomic scatter, unsorted points."""

from typing import ClassVar

import numpy as np
import taichi as ti

from scripts.peers.physics import component, move_node, stencil, update_stress
from scripts.peers.problem import MASS_FLOOR, WALL_GAP, Problem


@ti.data_oriented
class Example:
    """One simulation; call `ti.init` before."""

    TAICHI: ClassVar = {}  # options of `ti.init` besides threads and precision

    STATE = ("x", "v", "grad_v", "sigma", "m", "V0", "J", "opening")

    def __init__(self, problem: Problem) -> None:
        d = self.dim = problem.dim
        self.n, self.n_nodes, self.h, self.gravity = len(problem.x), problem.n_nodes, problem.h, problem.gravity
        self.material, self.alpha_d, self.cfl = problem.material, problem.alpha_d, problem.cfl
        self.origin, self.floor = tuple(problem.origin.tolist()), MASS_FLOOR * float(problem.m.min())
        self.x, self.v = ti.Vector.field(d, float, self.n), ti.Vector.field(d, float, self.n)
        self.grad_v = ti.Matrix.field(d, d, float, self.n)
        self.sigma = ti.Vector.field(4 if d == 2 else 6, float, self.n)
        self.m, self.V0, self.J, self.opening = (ti.field(float, self.n) for _ in range(4))
        self.kind = ti.field(int, self.n)
        self.grid_m = ti.field(float, self.n_nodes)
        self.grid_v = ti.Vector.field(d, float, self.n_nodes)  # momentum, then velocity
        self.grid_a = ti.Vector.field(d, float, self.n_nodes)  # force, then acceleration
        self.walls = ti.field(ti.u8, self.n_nodes)
        self.walls.from_numpy(problem.wall_bits)
        self.speed = ti.field(float, ())
        self.speed[None] = problem.speed
        for name in ("x", "v", "grad_v", "m", "V0", "J", "opening", "kind"):
            getattr(self, name).from_numpy(getattr(problem, name))
        self.sigma.from_numpy(problem.sigma[:, : self.sigma.n])

    @property
    def dt(self) -> float:
        """Next time step, s."""
        return self.cfl * self.h / self.speed[None]

    def state(self) -> dict[str, np.ndarray]:
        """Arrays of the points."""
        return {name: getattr(self, name).to_numpy() for name in self.STATE}

    def advance(self, steps: int) -> None:
        """Do `steps` steps, Eq. 13-36."""
        for _ in range(steps):
            self.clear()
            self.p2g()
            self.update_grid()
            self.g2p()

    @ti.kernel
    def clear(self):
        for i in ti.grouped(self.grid_m):
            self.grid_m[i] = 0.0
            self.grid_v[i] = ti.zero(self.grid_v[i])
            self.grid_a[i] = ti.zero(self.grid_a[i])

    @ti.kernel
    def p2g(self):
        d, h = ti.static(self.dim, self.h)
        for p in self.x:
            x, v, m = self.x[p], self.v[p], self.m[p]
            base, w, g = stencil((x - ti.Vector(self.origin)) * (1.0 / h), self.n_nodes)
            affine, stress, sigma = m * self.grad_v[p], ti.Matrix.zero(float, d, d), self.sigma[p]
            for a, b in ti.static(ti.ndrange(d, d)):
                stress[a, b] = -self.J[p] * self.V0[p] * component(sigma, a, b)
            body = ti.Vector.zero(float, d)
            body[1] = -m * self.gravity
            for offset in ti.static(ti.grouped(ti.ndrange(*(3,) * d))):
                weight, gradient = self.weight_and_gradient(offset, w, g)
                arm = ti.Vector(self.origin) + (base + offset) * h - x
                self.grid_m[base + offset] += weight * m
                self.grid_v[base + offset] += weight * (m * v + affine @ arm)
                self.grid_a[base + offset] += weight * body + stress @ gradient

    @ti.kernel
    def update_grid(self):
        dt = self.cfl * self.h / self.speed[None]
        for i in ti.grouped(self.grid_m):
            if self.grid_m[i] > self.floor:
                self.grid_v[i], self.grid_a[i] = move_node(
                    self.grid_v[i], self.grid_a[i], self.grid_m[i], self.walls[i], self.alpha_d, dt
                )
            else:
                self.grid_v[i], self.grid_a[i] = ti.zero(self.grid_v[i]), ti.zero(self.grid_a[i])

    @ti.kernel
    def g2p(self):
        d, h = ti.static(self.dim, self.h)
        dt = self.cfl * h / self.speed[None]
        self.speed[None] = 0.0
        for p in self.x:
            x = self.x[p]
            base, w, g = stencil((x - ti.Vector(self.origin)) * (1.0 / h), self.n_nodes)
            v, a, grad_v = ti.zero(x), ti.zero(x), ti.Matrix.zero(float, d, d)
            for offset in ti.static(ti.grouped(ti.ndrange(*(3,) * d))):
                weight, gradient = self.weight_and_gradient(offset, w, g)
                node_v = self.grid_v[base + offset]
                v += weight * node_v
                a += weight * self.grid_a[base + offset]
                grad_v += node_v.outer_product(gradient)
            self.v[p] += dt * a  # Eq. 26
            first, last = ti.Vector(self.origin), ti.Vector(self.origin) + (ti.Vector(self.n_nodes) - 1) * h
            x += dt * (v - 0.5 * dt * a)  # Eq. 27
            self.x[p] = ti.min(ti.max(x, first + WALL_GAP * h), last - WALL_GAP * h)
            self.grad_v[p] = grad_v  # Eq. 28
            self.sigma[p], self.J[p], self.opening[p] = update_stress(
                grad_v, dt, self.sigma[p], self.J[p], self.opening[p], self.kind[p] == 0, self.material
            )
            ti.atomic_max(self.speed[None], ti.sqrt(self.material.wave_speed2 * self.J[p]) + self.v[p].norm())

    @ti.func
    def weight_and_gradient(self, offset: ti.template(), w: ti.template(), g: ti.template()):
        """Weight of one node of the stencil, and its gradient (1/m)."""
        weight, gradient = 1.0, ti.Vector.one(float, self.dim) * (1.0 / self.h)
        for a in ti.static(range(self.dim)):
            weight *= w[offset[a], a]
            for b in ti.static(range(self.dim)):
                gradient[b] *= g[offset[a], a] if ti.static(a == b) else w[offset[a], a]
        return weight, gradient
