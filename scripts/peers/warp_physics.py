"""Formulas for one point and one node in Warp, in two and three dimensions: those of `physics`, which Taichi compiles.

Warp converts no literal to double precision. Its functions are therefore made for one type of numbers, with constants
of this type. A stress is a vector as in `physics`. Equation numbers are those of Coetzee & Purvance 2026.
"""

from collections.abc import Callable
from math import prod

import warp as wp

from scripts.peers.problem import Material

TINY = 1e-30  # avoids 0 / 0, in single precision also


def make_stencil(n_nodes: tuple[int, ...], real: type) -> Callable:
    """`stencil(s)`: first node, weights and gradients (times h), both [node, axis], at grid coordinates `s`. Eq. 17-18.

    Beside walls the kernel correction reduces to the linear shape functions of the two nodes next to the point.
    """
    d = len(n_nodes)
    vec, ints, table = wp.types.vector(d, real), wp.types.vector(d, int), wp.types.matrix((3, d), real)
    zero, half, middle, one, end, two = map(real, (0.0, 0.5, 0.75, 1.0, 1.5, 2.0))
    last = ints(*(n - 3 for n in n_nodes))

    @wp.func
    def stencil(s: vec):
        base, w, g = ints(), table(), table()
        for a in range(d):
            base[a] = wp.clamp(int(s[a] - half), 0, last[a])
            r = s[a] - real(base[a])
            w0, w1, w2 = half * (end - r) * (end - r), middle - (r - one) * (r - one), half * (r - half) * (r - half)
            g0, g1, g2 = r - end, two - two * r, r - half
            if r < half:
                w0, w1, w2, g0, g1, g2 = one - r, r, zero, -one, one, zero
            if r > end:
                w0, w1, w2, g0, g1, g2 = zero, two - r, r - one, zero, -one, one
            w[0, a] = w0
            w[1, a] = w1
            w[2, a] = w2
            g[0, a] = g0
            g[1, a] = g1
            g[2, a] = g2
        return base, w, g

    return stencil


def make_weigh(n_nodes: tuple[int, ...], real: type, h: float) -> tuple[Callable, Callable]:
    """`weigh(i, w, g)`: weight and gradient (1/m) of a node of the stencil; `address(i)`: number of one of the grid."""
    d = len(n_nodes)
    vec, ints, table = wp.types.vector(d, real), wp.types.vector(d, int), wp.types.matrix((3, d), real)
    one, per_h = real(1.0), real(1.0 / h)
    strides = ints(*(prod(n_nodes[a + 1 :]) for a in range(d)))

    @wp.func
    def weigh(i: ints, w: table, g: table):
        weight, gradient = one, vec(per_h)
        for a in range(d):
            weight *= w[i[a], a]
            for b in range(d):
                gradient[b] *= wp.where(a == b, g[i[a], a], w[i[a], a])
        return weight, gradient

    @wp.func
    def address(i: ints):
        return wp.dot(i, strides)

    return weigh, address


def make_move_node(d: int, real: type, alpha_d: float) -> Callable:
    """`move_node(momentum, force, m, walls, dt)`: velocity v~ and acceleration of a node. Eq. 21-24.

    Bit a of `walls` holds component a.
    """
    vec = wp.types.vector(d, real)
    zero, one, damping = real(0.0), real(1.0), real(alpha_d)

    @wp.func
    def move_node(momentum: vec, force: vec, m: real, walls: int, dt: real):
        v, acceleration = vec(), vec()
        inverse = one / m
        for a in range(d):
            raw = momentum[a] * inverse
            resistance = damping * wp.abs(force[a])
            if raw == zero:
                resistance = zero
            acceleration[a] = (force[a] - resistance * wp.sign(raw)) * inverse
            v[a] = raw + dt * acceleration[a]
            if (walls >> a) & 1 == 1:
                v[a] = zero
                acceleration[a] = -raw / dt  # points see the node stop in this step
        return v, acceleration

    return move_node


def make_update_stress(d: int, real: type, material: Material) -> tuple[Callable, Callable]:
    """`update_stress(grad_v, dt, sigma, J, opening, is_column)` and `to_matrix(sigma)`.

    The first gives stress, J and opening strain after one step, Eq. 29-34; the base is elastic.
    """
    square, mat, vec = wp.types.matrix((d, d), real), wp.types.matrix((3, 3), real), wp.types.vector(2 * d, real)
    zero, half, one = real(0.0), real(0.5), real(1.0)
    bulk, shear, apex = real(material.bulk), real(material.shear), real(material.apex)
    lame = real(material.bulk - 2.0 / 3.0 * material.shear)
    eye = mat(*(float(a == b) for a in range(3) for b in range(3)))
    return_stress = (make_return_plane if d == 2 else make_return_space)(real, material)

    @wp.func
    def to_matrix(sigma: vec):
        xz, yz = zero, zero
        if wp.static(d == 3):
            yz, xz = sigma[wp.static(2 * d - 2)], sigma[wp.static(2 * d - 1)]
        return mat(sigma[0], sigma[3], xz, sigma[3], sigma[1], yz, xz, yz, sigma[2])

    @wp.func
    def to_vector(s: mat):
        sigma = vec()
        sigma[0] = s[0, 0]
        sigma[1] = s[1, 1]
        sigma[2] = s[2, 2]
        sigma[3] = s[0, 1]
        if wp.static(d == 3):
            sigma[wp.static(2 * d - 2)] = s[1, 2]
            sigma[wp.static(2 * d - 1)] = s[0, 2]
        return sigma

    @wp.func
    def update_stress(grad_v: square, dt: real, sigma: vec, J: real, opening: real, is_column: bool):
        step = mat()
        for a in range(d):
            for b in range(d):
                step[a, b] = dt * grad_v[a, b]
        s, ratio, volumetric, e_o = to_matrix(sigma), wp.determinant(eye + step), wp.trace(step), opening
        if e_o > zero:
            opened = (one + e_o) * ratio - one
            e_o = wp.max(opened, zero)
            volumetric = wp.min(opened, zero)
            ratio = one + volumetric
            s = apex * eye
        else:
            turn = half * (step - wp.transpose(step)) * s
            s += turn + wp.transpose(turn)
        if e_o == zero:
            pressure = bulk * volumetric - (bulk - lame) * wp.trace(step)
            s += shear * (step + wp.transpose(step)) + pressure * eye
            if is_column:
                s, e_o = return_stress(s)
                ratio /= one + e_o
        return to_vector(s), J * ratio, e_o

    return update_stress, to_matrix


def make_return_plane(real: type, material: Material) -> Callable:
    """Return of a stress whose third axis is principal; also gives the strain released at the apex."""
    mat = wp.types.matrix((3, 3), real)
    zero, half, tiny = real(0.0), real(0.5), real(TINY)
    return_principal = make_return_principal(real, material)

    @wp.func
    def return_plane(s: mat):
        centre, across = half * (s[0, 0] + s[1, 1]), half * (s[0, 0] - s[1, 1])
        radius = wp.sqrt(across * across + s[0, 1] * s[0, 1])
        a, b, z, yields, freed = return_principal(centre + radius, centre - radius, s[2, 2])
        t = s
        if yields:
            mean, scale = half * (a + b), half * (a - b) / wp.max(radius, tiny)
            xx, yy, xy = mean + scale * across, mean - scale * across, scale * s[0, 1]
            t = mat(xx, xy, zero, xy, yy, zero, zero, zero, z)
        return t, freed

    return return_plane


def make_return_space(real: type, material: Material) -> Callable:
    """Return of a full stress, as `physics.return_space`; also gives the strain released at the apex."""
    mat = wp.types.matrix((3, 3), real)
    zero, half, one, end, two, three = map(real, (0.0, 0.5, 1.0, 1.5, 2.0, 3.0))
    third, tiny, apex, k = real(1.0 / 3.0), real(TINY), real(material.apex), real(material.n_phi)
    cone = real((4.0 / 3.0 * (material.n_phi**2 + material.n_phi + 1.0)) ** 0.5)  # inscribed in the surface
    eye = mat(*(float(a == b) for a in range(3) for b in range(3)))
    return_principal = make_return_principal(real, material)

    @wp.func
    def return_space(s: mat):
        p = third * wp.trace(s)
        d = s - p * eye
        j2 = half * wp.ddot(d, d)
        t, freed = s, zero
        if (k - one) * (p - apex) + cone * wp.sqrt(j2) > zero:
            inverse = three / wp.max(j2, tiny)
            lode = wp.clamp(half * wp.determinant(d) * inverse * wp.sqrt(inverse), -one, one)
            far = two * wp.sqrt(third * j2) * wp.cos(third * wp.acos(wp.abs(lode))) * wp.sign(lode)
            along = (d * d + far * d + (far * far - j2) * eye) / wp.max(three * far * far - j2, tiny)
            across = d + half * far * eye - end * far * along
            radius = wp.sqrt(half * wp.ddot(across, across))
            centre = p - half * far
            a, b, z, yields, opened = return_principal(centre + radius, centre - radius, p + far)
            if yields:
                freed = opened
                scale = half * (a - b) / wp.max(radius, tiny)
                t = half * (a + b) * (eye - along) + z * along + scale * across
        return t, freed

    return return_space


def make_return_principal(real: type, material: Material) -> Callable:
    """Return of principal stresses a >= b and any z; gives also whether they yield and the strain freed at the apex."""
    zero, apex, n_phi = real(0.0), real(material.apex), real(material.n_phi)
    return_sorted = make_return_sorted(real, material)

    @wp.func
    def return_principal(a: real, b: real, z: real):
        s1, s2, s3 = wp.max(a, z) - apex, wp.max(b, wp.min(a, z)) - apex, wp.min(b, z) - apex
        yields = n_phi * s1 > s3
        new_a, new_b, new_z, freed = a, b, z, zero
        if yields:
            t1, t2, t3, freed = return_sorted(s1, s2, s3)
            if z >= a:
                new_z, new_a, new_b = t1 + apex, t2 + apex, t3 + apex
            elif z <= b:
                new_a, new_b, new_z = t1 + apex, t2 + apex, t3 + apex
            else:
                new_a, new_z, new_b = t1 + apex, t2 + apex, t3 + apex
        return new_a, new_b, new_z, yields, freed

    return return_principal


def make_return_sorted(real: type, material: Material) -> Callable:
    """Exact return to face, edge or apex (Clausen et al. 2007), stresses measured from the apex."""
    K, G, n_phi, n_psi = material.bulk, material.shear, material.n_phi, material.n_psi
    spread, bend = (n_phi - 1.0) * (n_psi - 1.0) / (3.0 * G), (0.5 * K / G - 1.0 / 3.0) * (n_psi - 1.0)
    zero, one, two, third, k, m = map(real, (0.0, 1.0, 2.0, 1.0 / 3.0, n_phi, n_psi))
    per_shear, per_bulk, dilation, coupling = real(0.5 / G), real(1.0 / (3.0 * K)), real(1.0 / K), real(bend)
    to_face = real(1.0 / (n_phi * n_psi + 1.0 + bend * (n_phi - 1.0)))
    to_edge1 = real(1.0 / (spread + (2.0 + n_psi) * (2.0 + n_phi) / (9.0 * K)))
    to_edge2 = real(1.0 / (spread + (1.0 + 2.0 * n_psi) * (1.0 + 2.0 * n_phi) / (9.0 * K)))

    @wp.func
    def return_sorted(s1: real, s2: real, s3: real):
        p = third * (s1 + s2 + s3)
        tension1 = (s1 + s2 - two * p + m * (s3 - p)) * per_shear + (two + m) * p * per_bulk
        tension2 = (s1 - p + m * (s2 + s3 - two * p)) * per_shear + (one + two * m) * p * per_bulk
        t1, t2, t3, freed = zero, zero, zero, zero
        if tension1 >= zero and tension2 >= zero:
            freed = wp.max(dilation * p, zero)
        else:
            step = (k * s1 - s3) * to_face
            t1, t2, t3 = s1 - step * (m + coupling), s2 - step * coupling, s3 - step * (coupling - one)
            if t1 < t2:
                t1 = tension1 * to_edge1
                t2, t3 = t1, k * t1
            elif t3 > t2:
                t1 = tension2 * to_edge2
                t2, t3 = k * t1, k * t1
        return t1, t2, t3, freed

    return return_sorted
