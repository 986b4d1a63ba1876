"""Reference implementation of one step of the material point method, literally from the equations, in NumPy.

Every kernel is compared with it. It shares nothing with `mpmcol`. Equation numbers are those of Coetzee & Purvance 2026
(doi:10.20944/preprints202605.0398.v1). d = 2 is plane strain or axisymmetric, d = 3 is three-dimensional; tensors are
always 3 x 3. SI units, angles in radians, tension > 0. In axisymmetry the axes are (r, y), the third is the hoop
direction, and masses and volumes are per radian.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations, permutations, product

import numpy as np

Array = np.ndarray
IDENTITY = np.eye(3)


@dataclass(frozen=True)
class ReferencePoints:
    """State of n material points."""

    x: Array  # (n, d) position
    v: Array  # (n, d) velocity
    grad_v: Array  # (n, 3, 3) [a, b] = d v_a / d x_b
    sigma: Array  # (n, 3, 3) Cauchy stress
    J: Array  # (n,) volume ratio of the closed material
    opening: Array  # (n,) e_o, volume ratio of the opening minus one
    m: Array  # (n,) mass
    V0: Array  # (n,) initial volume
    history: Array  # (n, k); column 0 is the plastic deviatoric strain of the softening law
    material: Array  # (n,) index into the materials
    C: Array | None = None  # (n, d, d) affine matrix of APIC
    cell: Array | None = None  # (n,) cells over which the volumetric strain is averaged


@dataclass(frozen=True)
class ReferenceGrid:
    """Nodes at origin + h * index; the first and the last node of each axis are on walls."""

    origin: Array  # (d,)
    h: float
    n_nodes: tuple[int, ...]  # d numbers
    inside: Array | None = None  # (n_nodes - 1) boolean: cells that walls fill


@dataclass(frozen=True)
class ReferenceWall:
    """A wall with Coulomb friction, from which material may separate."""

    axis: int  # of its normal
    side: int  # -1: below its nodes along the axis, 1: above them
    mu: float
    nodes: Array  # (N...) boolean


@dataclass(frozen=True)
class ReferenceMaterial:
    """Elastic if phi and mu are None; Mohr-Coulomb with phi, softening from (phi, psi) to the residual values if
    rate > 0; Drucker-Prager or mu(I) with mu.
    """

    E: float
    nu: float
    phi: float | None = None
    psi: float = 0.0
    c: float = 0.0
    phi_residual: float = 0.0
    psi_residual: float = 0.0
    rate: float = 0.0  # beta of Table 1
    strain_factor: float = (2.0 / 3.0) ** 0.5  # d eps = strain_factor sqrt(de^p : de^p)
    c_residual: float | None = None  # cohesion after softening; None: constant
    tension: float | None = None  # of the cut-off; None: without one
    failure_strain: float = np.inf  # under tension; history[0] is the plastic volumetric or largest opening strain
    mu: float | None = None  # of sqrt(J2) = c + mu p, at vanishing rate
    mu_2: float | None = None  # at infinite rate; None: no dependence on the rate
    I_0: float = 1.0
    d: float = 1.0  # diameter of grains, m
    rho_s: float = 1.0  # their density, kg/m3

    @property
    def K(self) -> float:
        return self.E / (3.0 * (1.0 - 2.0 * self.nu))

    @property
    def G(self) -> float:
        return self.E / (2.0 * (1.0 + self.nu))

    def angles(self, history: Array) -> tuple[float, float]:
        """Friction and dilatancy angle of a point: after the plastic deviatoric strain history[0] if it softens, and
        with tan(phi) larger by the share history[1].
        """
        assert self.phi is not None
        remaining = np.exp(-self.rate * history[0]) if self.rate > 0.0 else 1.0
        phi = self.phi_residual + (self.phi - self.phi_residual) * remaining
        psi = self.psi_residual + (self.psi - self.psi_residual) * remaining
        if history[1] != 0.0:
            phi = np.arctan(np.tan(phi) * (1.0 + history[1]))
            psi = min(psi, phi)
        return phi, psi

    def cohesion(self, eps: float) -> float:
        """Cohesion after the plastic deviatoric strain eps."""
        return (
            self.c
            if self.c_residual is None
            else self.c_residual + (self.c - self.c_residual) * np.exp(-self.rate * eps)
        )

    @property
    def can_fail(self) -> bool:
        return self.rate == 0.0 and self.c > 0.0 and self.failure_strain < np.inf

    def intact_cohesion(self, history: Array) -> float:
        """Cohesion of a cone, none after failure in tension."""
        return 0.0 if history[0] > self.failure_strain else self.c

    def present_strength(self, history: Array) -> tuple[float, float]:
        """Cohesion and tensile strength of material with a cut-off, which softening reduces in proportion."""
        assert self.tension is not None
        if self.rate > 0.0:
            c = self.cohesion(history[0])
            return c, self.tension * c / self.c
        return (0.0, 0.0) if history[0] > self.failure_strain else (self.c, self.tension)


@dataclass(frozen=True)
class ReferenceScheme:
    """Options of the method; the defaults are those of mpmcol."""

    dt: float
    gravity: Array  # (d,)
    alpha_d: float = 0.0
    taylor: float = 1.0  # factor of the Taylor term of Eq. 20
    flip_fraction: float = 1.0  # A: 1 FLIP, 0 PIC
    position: float = 0.5  # c: 0.5 trapezoid, 1 as printed in Eq. 27, 0 end
    wall_impulse: bool = True
    opening_strain: bool = True
    correct: bool = True
    axisymmetric: bool = False
    m_min: float = 0.0  # nodes with this mass or less are empty
    stress_order: str = "usl"
    basis: str = "quadratic"
    exponential_volume: bool = False  # J exp(dt tr L) in place of Eq. 29
    apic: bool = False  # C in place of the velocity gradient in Eq. 20
    filter_rate: float = 0.0  # r of the stress filter, 1/s
    filter_shear_rate: float = 1.0  # from which on it acts fully, 1/s
    filter_opening: float = 0.01  # e_max
    filter_modulus: float = 0.0  # K of the column


# ------------------------------------------------------------------------------------ shape functions


def spline(r: Array) -> tuple[Array, Array]:
    """Quadratic B-spline and its derivative with respect to r = (x - x_i) / h."""
    a = np.abs(r)
    w = np.where(a < 0.5, 0.75 - a**2, np.where(a < 1.5, 0.5 * (1.5 - a) ** 2, 0.0))  # Eq. 17
    dw = np.where(a < 0.5, -2.0 * r, np.where(a < 1.5, (a - 1.5) * np.sign(r), 0.0))  # Eq. 18
    return w, dw


def linear_function(r: Array) -> tuple[Array, Array]:
    """Linear shape function and its derivative with respect to r."""
    return np.maximum(1.0 - np.abs(r), 0.0), np.where(np.abs(r) < 1.0, np.where(r < 0.0, 1.0, -1.0), 0.0)


def cubic_spline(r: Array) -> tuple[Array, Array]:
    """Cubic B-spline and its derivative with respect to r."""
    a = np.abs(r)
    w = np.where(a < 1.0, 0.5 * a**3 - a**2 + 2.0 / 3.0, np.where(a < 2.0, (2.0 - a) ** 3 / 6.0, 0.0))
    dw = np.where(a < 1.0, 1.5 * a**2 - 2.0 * a, np.where(a < 2.0, -0.5 * (2.0 - a) ** 2, 0.0)) * np.sign(r)
    return w, dw


def linear_axis_weights(r: Array, n_nodes: int) -> tuple[Array, Array, Array]:
    """Nodes, weights and derivatives (n, 2) of the linear shape functions."""
    nodes = np.minimum(np.floor(r).astype(int), n_nodes - 2)[:, None] + np.array([0, 1])
    return nodes, *linear_function(r[:, None] - nodes)


def cubic_axis_weights(r: Array, n_nodes: int, correct: bool) -> tuple[Array, Array, Array]:
    """Nodes, weights and derivatives (n, 4) of the cubic shape functions.

    A node outside the grid has weight zero and a clipped index. With the correction its value is extrapolated linearly,
    v_-1 = 2 v_0 - v_1, so that its weight is distributed to these two nodes.
    """
    nodes = np.minimum(np.floor(r).astype(int), n_nodes - 2)[:, None] + np.array([-1, 0, 1, 2])
    w, dw = cubic_spline(r[:, None] - nodes)
    for outside, wall, inside in ((0, 1, 2), (3, 2, 1)):
        ghost = (nodes[:, outside] < 0) | (nodes[:, outside] > n_nodes - 1)
        for values in (w, dw):
            if correct:
                values[ghost, wall] += 2.0 * values[ghost, outside]
                values[ghost, inside] -= values[ghost, outside]
            values[ghost, outside] = 0.0
    return np.clip(nodes, 0, n_nodes - 1), w, dw


def axis_weights(r: Array, n_nodes: int, correct: bool, basis: str = "quadratic") -> tuple[Array, Array, Array]:
    """Nodes, weights and derivatives (n, width) along one axis at grid coordinates r (n,), in cells.

    A stencil node outside the grid has weight zero and a clipped index.
    """
    if np.any((r < 0.0) | (r > n_nodes - 1)):
        raise ValueError("a point lies outside the grid")
    if basis == "linear":
        return linear_axis_weights(r, n_nodes)
    if basis == "cubic":
        return cubic_axis_weights(r, n_nodes, correct)
    nodes = np.floor(r + 0.5).astype(int)[:, None] + np.array([-1, 0, 1])
    distance = r[:, None] - nodes
    w, dw = spline(distance)
    first, last = nodes[:, 0] < 0, nodes[:, 2] > n_nodes - 1  # within half a cell of a wall
    for wall, slope in ((first, np.array([0.0, -1.0, 1.0])), (last, np.array([-1.0, 1.0, 0.0]))):
        if correct:  # linear shape functions of the remaining two nodes
            w[wall], dw[wall] = (1.0 - np.abs(distance[wall])) * np.abs(slope), slope
        else:
            w[wall], dw[wall] = w[wall] * np.abs(slope), dw[wall] * np.abs(slope)
    return np.clip(nodes, 0, n_nodes - 1), w, dw


def weights(
    x: Array,
    origin: Array,
    h: float,
    n_nodes: Sequence[int],
    correct: bool = True,
    basis: str = "quadratic",
    inside: Array | None = None,
) -> tuple[Array, Array, Array]:
    """Nodes (n, k^d, d), w_ip (n, k^d) of Eq. 7 and grad w_ip (n, k^d, d) of Eq. 8, products over the axes.

    correct=False truncates the spline at the walls. Raises ValueError for a point outside the grid.
    """
    d = x.shape[1]
    axes = [axis_weights((x[:, b] - origin[b]) / h, n_nodes[b], correct, basis) for b in range(d)]
    if inside is not None and correct:
        fold_beside_walls(np.floor((x - origin) / h).astype(int), axes, inside)
    width = axes[0][0].shape[1]
    size = width**d
    nodes, w, grad = np.empty((len(x), size, d), int), np.ones((len(x), size)), np.ones((len(x), size, d)) / h
    for j, stencil in enumerate(product(range(width), repeat=d)):
        for b, (axis_nodes, axis_w, axis_dw) in enumerate(axes):
            column = stencil[b]
            nodes[:, j, b] = axis_nodes[:, column]
            w[:, j] *= axis_w[:, column]
            for a in range(d):  # Eq. 18 times 1/h along a, values along the other axes
                grad[:, j, a] *= axis_dw[:, column] if a == b else axis_w[:, column]
    return nodes, w, grad


def grid_weights(x: Array, grid: ReferenceGrid, scheme: ReferenceScheme) -> tuple[Array, Array, Array]:
    """`weights` at points x (n, d) of a grid."""
    return weights(x, grid.origin, grid.h, grid.n_nodes, scheme.correct, scheme.basis, grid.inside)


def fold_beside_walls(cells: Array, axes: Sequence[tuple[Array, Array, Array]], inside: Array) -> None:
    """Distribute, in place, the weights of nodes inside a wall that is next to a point's cell (n, d) along an axis.

    The value of a node inside it is 2 v_0 - v_1, extrapolated from the node on the face and the next one.
    """
    for p, cell in enumerate(cells):
        for b, (nodes, w, dw) in enumerate(axes):
            for step in (-1, 1):
                neighbour = cell.copy()
                neighbour[b] += step
                if not 0 <= neighbour[b] < inside.shape[b] or not inside[tuple(neighbour)]:
                    continue
                face = cell[b] if step < 0 else cell[b] + 1
                for k in np.flatnonzero((nodes[p] - face) * step > 0):
                    for values in (w[p], dw[p]):
                        values[k - step] += 2.0 * values[k]
                        values[k - 2 * step] -= values[k]
                        values[k] = 0.0


# ------------------------------------------------------------------------------------- points and grid


def p2g(points: ReferencePoints, grid: ReferenceGrid, scheme: ReferenceScheme) -> tuple[Array, Array, Array]:
    """Nodal mass (N...), momentum (N..., d) and force f_ext + f_int (N..., d)."""
    d = points.x.shape[1]
    m_i, p_i, f_i = np.zeros(grid.n_nodes), np.zeros((*grid.n_nodes, d)), np.zeros((*grid.n_nodes, d))
    all_nodes, all_w, all_grad = grid_weights(points.x, grid, scheme)
    V = points.J * points.V0  # Eq. 30
    for p in range(len(points.x)):
        L, sigma, m = points.grad_v[p, :d, :d], points.sigma[p], points.m[p]
        if scheme.apic:
            L = points.C[p]
        for node, w, grad in zip(all_nodes[p], all_w[p], all_grad[p], strict=True):
            i = tuple(node)
            to_node = grid.origin + grid.h * node - points.x[p]
            m_i[i] += m * w  # Eq. 19
            p_i[i] += m * w * (points.v[p] + scheme.taylor * (L @ to_node))  # Eq. 20
            f_i[i] += w * m * scheme.gravity  # Eq. 14
            f_i[i] -= V[p] * sigma[:d, :d] @ grad  # Eq. 13
            if scheme.axisymmetric:
                f_i[i][0] -= V[p] * sigma[2, 2] * w / points.x[p, 0]
    return m_i, p_i, f_i


def grid_update(
    m: Array, p: Array, f: Array, fixed: Array, scheme: ReferenceScheme, walls: Sequence[ReferenceWall] = ()
) -> tuple[Array, Array]:
    """Velocity v~ and acceleration a of the nodes; fixed (N..., d): components held at zero.

    Nodes of `walls` have no damping; the first wall acts first.
    """
    full = (m > scheme.m_min)[..., None]
    mass = np.where(full, m[..., None], 1.0)
    v_raw = np.where(full, p / mass, 0.0)  # Eq. 21
    v = np.where(fixed, 0.0, v_raw)
    f_damp = -scheme.alpha_d * np.abs(f) * np.sign(v)  # Eq. 23 with |f|
    a = np.where(full, (f + f_damp) / mass, 0.0)  # Eq. 22
    v_new = np.where(fixed, 0.0, v + scheme.dt * a)  # Eq. 24
    a_wall = (0.0 - v_raw) / scheme.dt if scheme.wall_impulse else 0.0
    a = np.where(fixed, a_wall, a)
    on_wall = np.logical_or.reduce([wall.nodes for wall in walls]) if walls else np.zeros(m.shape, bool)
    for node in map(tuple, np.argwhere(on_wall & full[..., 0])):
        v_star = np.where(fixed[node], 0.0, v_raw[node] + scheme.dt * f[node] / m[node])
        v_new[node] = after_contact(v_star, m[node], node, walls)
        a[node] = (v_new[node] - v_raw[node]) / scheme.dt
    return v_new, a


def after_contact(v: Array, m: float, node: tuple[int, ...], walls: Sequence[ReferenceWall]) -> Array:
    """Velocity (d,) of a node after the impulses of its walls: |J_t| = min(mu J_n, m |v_t|)."""
    v = v.copy()
    for wall in walls:
        J_n = m * wall.side * v[wall.axis]
        if not wall.nodes[node] or J_n <= 0.0:
            continue
        v[wall.axis] = 0.0
        if (speed := np.linalg.norm(v)) > 0.0:
            v = v - min(wall.mu * J_n / m, speed) * v / speed
    return v


def g2p(points: ReferencePoints, v: Array, a: Array, grid: ReferenceGrid, scheme: ReferenceScheme) -> ReferencePoints:
    """Points with new v, x and grad_v; v and a (N..., d) are v~ and a of the nodes."""
    n, d = points.x.shape
    all_nodes, all_w, all_grad = grid_weights(points.x, grid, scheme)
    Sv, Sa, L = np.zeros((n, d)), np.zeros((n, d)), np.zeros((n, 3, 3))
    for p in range(n):
        for node, w, grad in zip(all_nodes[p], all_w[p], all_grad[p], strict=True):
            i = tuple(node)
            Sv[p] += w * v[i]
            Sa[p] += w * a[i]
            L[p, :d, :d] += np.outer(v[i], grad)  # Eq. 28
    if scheme.axisymmetric:
        L[:, 2, 2] = Sv[:, 0] / points.x[:, 0]
    C = affine_matrices(points.x, v, grid, scheme) if scheme.apic else None
    A, dt = scheme.flip_fraction, scheme.dt
    return replace(
        points,
        v=(1.0 - A) * Sv + A * (points.v + dt * Sa),  # Eq. 26
        x=points.x + dt * Sv - scheme.position * dt**2 * Sa,  # Eq. 27
        grad_v=L,
        C=C,
    )


def affine_matrices(x: Array, v: Array, grid: ReferenceGrid, scheme: ReferenceScheme) -> Array:
    """C_p = B_p D_p^-1 (n, d, d) of Jiang et al. 2015 (doi:10.1145/2766996, Eq. 8-10) from the nodal velocities."""
    n, d = x.shape
    C = np.zeros((n, d, d))
    all_nodes, all_w, _ = grid_weights(x, grid, scheme)
    for p in range(n):
        B, D = np.zeros((d, d)), np.zeros((d, d))
        for node, w in zip(all_nodes[p], all_w[p], strict=True):
            to_node = grid.origin + grid.h * node - x[p]
            B += w * np.outer(v[tuple(node)], to_node)
            D += w * np.outer(to_node, to_node)
        C[p] = B @ np.linalg.inv(D)
    return C


# ---------------------------------------------------------------------------------------------- stress


def elastic(material: ReferenceMaterial, deviatoric: Array, volumetric: float) -> Array:
    """Stress increment (3, 3) of the strain increment deviatoric + volumetric / 3 I."""
    return 2.0 * material.G * deviatoric + material.K * volumetric * IDENTITY


def mohr_coulomb(s: Array, phi: float, psi: float, p_apex: float, K: float, G: float) -> tuple[Array, bool]:
    """Exact return of the trial stress s (3, 3) to the Mohr-Coulomb surface with its apex at p_apex.

    Non-associated, after Clausen, Damkilde & Andersen 2007 (doi:10.1016/j.compstruc.2007.04.002).
    Returns the stress and whether it is the apex.
    """
    values, axes = np.linalg.eigh(s)
    S, axes = values[::-1] - p_apex, axes[:, ::-1]  # S1 >= S2 >= S3
    k = (1.0 + np.sin(phi)) / (1.0 - np.sin(phi))
    m = (1.0 + np.sin(psi)) / (1.0 - np.sin(psi))
    f = k * S[0] - S[2]
    if f <= 0.0:
        return s, False
    D = 2.0 * G * IDENTITY + (K - 2.0 * G / 3.0)
    C = np.linalg.inv(D)
    a, b = np.array([k, 0.0, -1.0]), np.array([m, 0.0, -1.0])
    r = D @ b / (a @ D @ b)
    l1, l2 = np.array([1.0, 1.0, k]), np.array([1.0, k, k])  # edges S1 = S2 and S2 = S3
    g1, g2 = np.array([1.0, 1.0, m]), np.array([1.0, m, m])
    t1, t2 = (g1 @ C @ S) / (g1 @ C @ l1), (g2 @ C @ S) / (g2 @ C @ l2)
    if t1 >= 0.0 and t2 >= 0.0:
        return p_apex * IDENTITY, True
    if np.cross(r, l1) @ S < 0.0:
        S = t1 * l1
    elif np.cross(r, l2) @ S > 0.0:
        S = t2 * l2
    else:
        S = S - f * r
    return axes @ np.diag(S + p_apex) @ axes.T, False


def cut_off_return(s: Array, material: ReferenceMaterial, history: Array) -> tuple[Array, bool]:
    """Return of the trial stress s (3, 3) to pyramid and cut-off, and whether it is the apex.

    Without softening sets history[0].
    """
    phi, psi = material.angles(history)
    c, tension = material.present_strength(history)
    values, axes = np.linalg.eigh(s)
    new = koiter_return(values[None], phi, psi, c, material.K, material.G, tension=tension)[0]
    slack = 1e-9 * (np.abs(values).max() + tension)
    if new.max() > tension - slack and material.rate == 0.0:
        history[0] += max(0.0, np.sum(values - new) / (3.0 * material.K))
    return axes @ np.diag(new) @ axes.T, bool(new.min() > tension - slack)


def shear_rate(tau: float, p: float, material: ReferenceMaterial, dt: float, c: float | None = None) -> float:
    """Plastic shear rate g (1/s) with tau - G dt g = c + mu(I) p and I = g d sqrt(rho_s / p); 0 without yield.

    The positive root of a quadratic equation for g: multiply by I_0 + I.
    """
    c = material.c if c is None else c
    G, mu, mu_2 = material.G, material.mu, material.mu_2
    over = tau - c - mu * p
    if over <= 0.0:
        return 0.0
    if mu_2 is None or p <= 0.0:
        return over / (G * dt)
    q = material.I_0 * np.sqrt(p / material.rho_s) / material.d  # I_0 over I, times g
    return float(np.max(np.roots([G * dt, p * (mu_2 - mu) + G * dt * q - over, -over * q])))


def cone_return(s: Array, material: ReferenceMaterial, dt: float, history: Array) -> tuple[Array, bool]:
    """Return of the trial stress s (3, 3) at constant volume to sqrt(J2) = c + mu(I) p, and whether it is the apex.

    At the apex sets history[0], if the material can fail.
    """
    mean, c = np.trace(s) / 3.0, material.intact_cohesion(history)
    p_apex = c / material.mu
    if mean > p_apex:
        history[0] += (mean - p_apex) / material.K if material.can_fail else 0.0
        return p_apex * IDENTITY, True
    deviator = s - mean * IDENTITY
    tau = np.sqrt(0.5 * np.sum(deviator**2))
    reduced = tau - material.G * dt * shear_rate(tau, -mean, material, dt, c)
    return mean * IDENTITY + deviator * (reduced / tau if tau > 0.0 else 1.0), False


def stress_update(
    points: ReferencePoints,
    materials: Sequence[ReferenceMaterial],
    scheme: ReferenceScheme,
    average: Array | None = None,
) -> ReferencePoints:
    """Points with new sigma, J, opening and history; grad_v is that of the new velocity.

    average: of the filtered stress on the grid (n,), for the stress filter.
    """
    old = points if points.cell is None else replace(points, grad_v=_averaged(points))
    if average is not None and scheme.filter_rate > 0.0:
        old = filtered(old, average, materials, scheme)
    new = [_stress_of(old, p, materials[old.material[p]], scheme) for p in range(len(old.x))]
    sigma, J, opening, history = (np.array(part) for part in zip(*new, strict=True))
    return replace(points, sigma=sigma, J=J, opening=opening, history=history)


def _averaged(points: ReferencePoints) -> Array:
    """Velocity gradients (n, 3, 3) with the trace averaged over the closed points of a cell and material."""
    L = points.grad_v.copy()
    for p in range(len(L)):
        members = (points.cell == points.cell[p]) & (points.material == points.material[p]) & (points.opening == 0.0)
        if members[p]:
            V = (points.J * points.V0)[members]
            mean = V @ np.trace(points.grad_v[members], axis1=1, axis2=2) / V.sum()
            L[p] += (mean - np.trace(points.grad_v[p])) / 3.0 * IDENTITY
    return L


def filtered(
    points: ReferencePoints, average: Array, materials: Sequence[ReferenceMaterial], scheme: ReferenceScheme
) -> ReferencePoints:
    """Points whose mean stress has approached its `average` on the grid (n,)."""
    new = [_filtered_point(points, p, average[p], materials, scheme) for p in range(len(average))]
    sigma, J, opening = (np.array(part) for part in zip(*new, strict=True))
    return replace(points, sigma=sigma, J=J, opening=opening)


def averaged_stress(points: ReferencePoints, grid: ReferenceGrid, scheme: ReferenceScheme) -> Array:
    """sum_i w_ip q_i with q_i = sum_p w_ip m_p q_p / m_i (n,)."""
    gap = np.minimum(points.opening, scheme.filter_opening)
    q = np.trace(points.sigma, axis1=1, axis2=2) / 3.0 + scheme.filter_modulus * gap
    all_nodes, all_w, _ = grid_weights(points.x, grid, scheme)
    m_i, mq_i = np.zeros(grid.n_nodes), np.zeros(grid.n_nodes)
    for nodes, w, m, value in zip(all_nodes, all_w, points.m, q, strict=True):
        for node, weight in zip(nodes, w, strict=True):
            m_i[tuple(node)] += weight * m
            mq_i[tuple(node)] += weight * m * value
    q_i = np.where(m_i > scheme.m_min, mq_i / np.where(m_i > scheme.m_min, m_i, 1.0), 0.0)
    return np.array([w @ q_i[tuple(nodes.T)] for nodes, w in zip(all_nodes, all_w, strict=True)])


def _filtered_point(
    points: ReferencePoints,
    p: int,
    average: float,
    materials: Sequence[ReferenceMaterial],
    scheme: ReferenceScheme,
) -> tuple[Array, float, float]:
    """Stress, J and e_o of point p after the filter."""
    material, s, J, e_o = materials[points.material[p]], points.sigma[p], points.J[p], points.opening[p]
    L = points.grad_v[p]
    if e_o > scheme.filter_opening:
        return s, J, e_o
    D = 0.5 * (L + L.T)
    deviator = D - np.trace(D) / 3.0 * IDENTITY
    flow = min(1.0, 2.0 * np.sum(deviator**2) / scheme.filter_shear_rate**2)
    chi = flow * scheme.filter_rate * scheme.dt / (1.0 + scheme.filter_rate * scheme.dt)
    mean = np.trace(s) / 3.0
    q = mean + material.K * e_o
    q = q + chi * (average - q)
    limit = _apex(material, points.history[p])
    J = J * (1.0 + (min(q, limit) - mean) / material.K)
    if q > limit:
        return limit * IDENTITY, J, (q - limit) / material.K if scheme.opening_strain else e_o
    return s + (q - mean) * IDENTITY, J, 0.0 if scheme.opening_strain else e_o


def _apex(material: ReferenceMaterial, history: Array) -> float:
    """Mean stress at the apex of the yield surface; infinite without one."""
    if material.mu is not None:
        return material.intact_cohesion(history) / material.mu
    if material.phi is None:
        return np.inf
    if material.tension is not None:
        return material.present_strength(history)[1]
    eps = history[0] if material.rate > 0.0 else 0.0
    phi, _ = material.angles(history)
    return material.cohesion(eps) / np.tan(phi) if material.c > 0.0 else 0.0


def _stress_of(
    points: ReferencePoints, p: int, material: ReferenceMaterial, scheme: ReferenceScheme
) -> tuple[Array, float, float, Array]:
    """Stress, J, e_o and history of point p."""
    dt, L, s = scheme.dt, points.grad_v[p], points.sigma[p]
    J, e_o, history = points.J[p], points.opening[p], points.history[p].copy()
    d = float(np.exp(dt * np.trace(L)) if scheme.exponential_volume else np.linalg.det(IDENTITY + dt * L))  # Eq. 29
    D, W = 0.5 * (L + L.T), 0.5 * (L - L.T)  # Eq. 32, 34
    volumetric = dt * np.trace(D)
    deviatoric = dt * D - volumetric / 3.0 * IDENTITY
    rotated = s + dt * (W @ s - s @ W)  # Eq. 33, the old stress first
    if material.phi is None and material.mu is None:
        return rotated + elastic(material, deviatoric, volumetric), J * d, e_o, history

    p_apex = _apex(material, history)
    if e_o > 0.0:
        opened = (1.0 + e_o) * d - 1.0
        if opened > 0.0:
            return p_apex * IDENTITY, J, opened, _opened(history, material, opened)
        e_o, J = 0.0, J * (1.0 + opened)
        trial = p_apex * IDENTITY + elastic(material, deviatoric, opened)
    else:
        J = J * d
        trial = rotated + elastic(material, deviatoric, volumetric)

    if material.mu is not None:
        sigma, at_apex = cone_return(trial, material, dt, history)
    elif material.tension is not None:
        sigma, at_apex = cut_off_return(trial, material, history)
    else:
        phi, psi = material.angles(history)
        sigma, at_apex = mohr_coulomb(trial, phi, psi, p_apex, material.K, material.G)
    if at_apex and scheme.opening_strain:
        e_o = max(0.0, (np.trace(trial) / 3.0 - p_apex) / material.K)
        J = J / (1.0 + e_o)
    change = trial - sigma
    _soften(history, material, (change - np.trace(change) / 3.0 * IDENTITY) / (2.0 * material.G))
    return sigma, J, e_o, _opened(history, material, e_o)


def _opened(history: Array, material: ReferenceMaterial, e_o: float) -> Array:
    """History of a point with opening strain e_o."""
    if material.can_fail:
        history[0] = max(history[0], e_o)
    return history


def _soften(history: Array, material: ReferenceMaterial, plastic: Array) -> None:
    """Add the length of a deviatoric plastic strain increment (3, 3) to the softening strain."""
    if material.rate > 0.0:
        history[0] += material.strain_factor * np.sqrt(np.sum(plastic**2))


def nodal_velocity(
    m: Array, p: Array, fixed: Array, scheme: ReferenceScheme, walls: Sequence[ReferenceWall] = ()
) -> Array:
    """Velocity (N..., d) of the nodes, Eq. 21, zero where it is held, after contact with `walls`."""
    full = (m > scheme.m_min)[..., None]
    v = np.where(fixed | ~full, 0.0, p / np.where(full, m[..., None], 1.0))
    for node in np.ndindex(m.shape):
        v[node] = after_contact(v[node], 1.0, node, walls)
    return v


def velocity_gradient(x: Array, v: Array, grid: ReferenceGrid, scheme: ReferenceScheme) -> Array:
    """Gradient (n, 3, 3) at the points of the nodal velocity v (N..., d), Eq. 28."""
    n, d = x.shape
    all_nodes, all_w, all_grad = grid_weights(x, grid, scheme)
    L = np.zeros((n, 3, 3))
    for p in range(n):
        for node, w, grad in zip(all_nodes[p], all_w[p], all_grad[p], strict=True):
            L[p, :d, :d] += np.outer(v[tuple(node)], grad)
            if scheme.axisymmetric:
                L[p, 2, 2] += w * v[tuple(node)][0] / x[p, 0]
    return L


def with_updated_stress(
    points: ReferencePoints,
    v: Array,
    grid: ReferenceGrid,
    materials: Sequence[ReferenceMaterial],
    scheme: ReferenceScheme,
) -> ReferencePoints:
    """Points with the stress updated by the gradient of v (N..., d), and their own gradient unchanged."""
    L, average = velocity_gradient(points.x, v, grid, scheme), averaged_stress(points, grid, scheme)
    return replace(stress_update(replace(points, grad_v=L), materials, scheme, average), grad_v=points.grad_v)


def step(
    points: ReferencePoints,
    grid: ReferenceGrid,
    fixed: Array,
    materials: Sequence[ReferenceMaterial],
    scheme: ReferenceScheme,
    walls: Sequence[ReferenceWall] = (),
) -> ReferencePoints:
    """One step: USL, USF or MUSL (Bardenhagen 2002, doi:10.1006/jcph.2002.7103)."""
    m, p, f = p2g(points, grid, scheme)
    if scheme.stress_order == "usf":
        points = with_updated_stress(points, nodal_velocity(m, p, fixed, scheme, walls), grid, materials, scheme)
        m, p, f = p2g(points, grid, scheme)
    v, a = grid_update(m, p, f, fixed, scheme, walls)
    new = g2p(points, v, a, grid, scheme)
    if scheme.stress_order == "usf":
        return new
    if scheme.stress_order == "usl":
        return stress_update(new, materials, scheme, averaged_stress(points, grid, scheme))
    m, p, _ = p2g(replace(new, x=points.x), grid, scheme)
    updated = with_updated_stress(
        replace(new, x=points.x), nodal_velocity(m, p, fixed, scheme, walls), grid, materials, scheme
    )
    return replace(updated, x=new.x)


# --------------------------------------------------------------------------- brute-force return mapping


def koiter_return(
    principal: Array, phi: float, psi: float, c: float, K: float, G: float, tolerance: float = 1e-9,
    tension: float | None = None,
) -> Array:  # fmt: skip
    """Return principal trial stresses (n, 3), in any order, to the six Mohr-Coulomb planes by trying every active set.

    tension: of a cut-off by three more planes s_i = tension with an associated flow rule.

    Koiter 1953: sigma = trial - D sum lambda b, f = 0 and lambda >= 0 on the active planes, f <= 0 on all others.
    With psi = 0 there is no solution for tension beyond the apex; the apex is then chosen as tension cut-off.
    """
    k = (1.0 + np.sin(phi)) / (1.0 - np.sin(phi))
    m = (1.0 + np.sin(psi)) / (1.0 - np.sin(psi))
    pairs = list(permutations(range(3), 2))
    a = np.array([k * IDENTITY[i] - IDENTITY[j] for i, j in pairs])
    b = np.array([m * IDENTITY[i] - IDENTITY[j] for i, j in pairs])
    D = 2.0 * G * IDENTITY + (K - 2.0 * G / 3.0)
    strength = np.full(len(pairs), 2.0 * c * np.sqrt(k))
    if tension is not None:
        a, b = np.concatenate([a, IDENTITY]), np.concatenate([b, IDENTITY])
        strength = np.concatenate([strength, 3 * [tension]])
    f = principal @ a.T - strength
    slack = tolerance * (np.max(np.abs(principal), axis=1) + strength[0])
    result = np.where((np.max(f, axis=1) <= slack)[:, None], principal, np.nan)
    for size in (1, 2, 3):
        for active in map(list, combinations(range(len(a)), size)):
            system = a[active] @ D @ b[active].T
            if np.linalg.cond(system) > 1e12:
                continue
            multiplier = f[:, active] @ np.linalg.inv(system).T
            s = principal - multiplier @ b[active] @ D
            admissible = np.max(s @ a.T - strength, axis=1) <= slack
            admissible &= np.min(multiplier, axis=1) * G >= -slack
            result = np.where((admissible & np.isnan(result[:, 0]))[:, None], s, result)
    if psi == 0.0 and phi > 0.0 and tension is None:
        apex = c / np.tan(phi) if c > 0.0 else 0.0
        beyond = np.isnan(result[:, 0]) & (np.mean(principal, axis=1) >= apex - slack)
        result[beyond] = apex
    return result
