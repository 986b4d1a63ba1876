"""Formulas for one point and one node in Taichi, in two and three dimensions.

Lengths of vectors are known at compile time, so that one source serves both dimensions. A stress is a
vector xx yy zz xy, in three dimensions followed by yz xz (Pa, tension > 0). `material` is a `problem.Material`, whose
numbers become constants of the code. Equation numbers are those of Coetzee & Purvance 2026.
"""

import taichi as ti

TINY = 1e-30  # avoids 0 / 0, in single precision also
THIRD = 1.0 / 3.0
STRESS_INDEX = ((0, 3, 5), (3, 1, 4), (5, 4, 2))


@ti.func
def stencil(s: ti.template(), n_nodes: ti.template()):
    """First node, weights and gradients (times h), both [node, axis], at grid coordinates `s`. Eq. 17-18.

    Beside walls the kernel correction reduces to the linear shape functions of the two nodes next to the point.
    """
    base = ti.cast(s - 0.5, int)
    w, g = ti.Matrix.zero(float, 3, s.n), ti.Matrix.zero(float, 3, s.n)
    for a in ti.static(range(s.n)):
        base[a] = ti.min(ti.max(base[a], 0), n_nodes[a] - 3)
        r = s[a] - base[a]
        w[0, a], w[1, a], w[2, a] = 0.5 * (1.5 - r) ** 2, 0.75 - (r - 1.0) ** 2, 0.5 * (r - 0.5) ** 2
        g[0, a], g[1, a], g[2, a] = r - 1.5, 2.0 - 2.0 * r, r - 0.5
        if r < 0.5:
            w[0, a], w[1, a], w[2, a] = 1.0 - r, r, 0.0
            g[0, a], g[1, a], g[2, a] = -1.0, 1.0, 0.0
        if r > 1.5:
            w[0, a], w[1, a], w[2, a] = 0.0, 2.0 - r, r - 1.0
            g[0, a], g[1, a], g[2, a] = 0.0, -1.0, 1.0
    return base, w, g


@ti.func
def move_node(momentum: ti.template(), force: ti.template(), m, walls, alpha_d: ti.template(), dt):
    """Velocity v~ and acceleration of a node; bit a of `walls` holds component a. Eq. 21-24."""
    v, acceleration = momentum, force
    inverse = 1.0 / m
    for a in ti.static(range(v.n)):
        raw = momentum[a] * inverse
        acceleration[a] = (force[a] - alpha_d * ti.abs(force[a]) * ti.math.sign(raw)) * inverse
        v[a] = raw + dt * acceleration[a]
        if (walls >> a) & 1:
            v[a], acceleration[a] = 0.0, -raw / dt  # points see the node stop in this step
    return v, acceleration


@ti.func
def component(sigma: ti.template(), a: ti.template(), b: ti.template()):
    """Entry (a, b) of a stress vector."""
    return sigma[ti.static(STRESS_INDEX[a][b])]


@ti.func
def to_matrix(sigma: ti.template()):
    """Stress vector to 3 x 3 matrix."""
    s = ti.Matrix([[sigma[0], sigma[3], 0.0], [sigma[3], sigma[1], 0.0], [0.0, 0.0, sigma[2]]])
    if ti.static(sigma.n == 6):
        s[0, 2] = s[2, 0] = sigma[5]
        s[1, 2] = s[2, 1] = sigma[4]
    return s


@ti.func
def to_vector(s: ti.template(), n: ti.template()):
    """3 x 3 matrix to stress vector of `n` components."""
    sigma = ti.Vector.zero(float, n)
    sigma[0], sigma[1], sigma[2], sigma[3] = s[0, 0], s[1, 1], s[2, 2], s[0, 1]
    if ti.static(n == 6):
        sigma[4], sigma[5] = s[1, 2], s[0, 2]
    return sigma


@ti.func
def update_stress(grad_v: ti.template(), dt, sigma: ti.template(), J, opening, is_column, material: ti.template()):
    """Stress, J and opening strain after one step. Eq. 29-34; the base is elastic."""
    eye = ti.Matrix.identity(float, 3)
    step = ti.Matrix.zero(float, 3, 3)
    for a, b in ti.static(ti.ndrange(grad_v.n, grad_v.n)):
        step[a, b] = dt * grad_v[a, b]
    s, ratio, volumetric, e_o = to_matrix(sigma), (eye + step).determinant(), step.trace(), opening
    if e_o > 0.0:
        opened = (1.0 + e_o) * ratio - 1.0
        e_o, volumetric = ti.max(opened, 0.0), ti.min(opened, 0.0)
        s, ratio = material.apex * eye, 1.0 + volumetric
    else:
        turn = 0.5 * (step - step.transpose()) @ s
        s += turn + turn.transpose()
    if e_o == 0.0:
        pressure = material.bulk * volumetric - 2.0 * THIRD * material.shear * step.trace()
        s += material.shear * (step + step.transpose()) + pressure * eye
        if is_column:
            if ti.static(sigma.n == 4):
                s, e_o = return_plane(s, material)
            else:
                s, e_o = return_space(s, material)
            ratio /= 1.0 + e_o
    return to_vector(s, sigma.n), J * ratio, e_o


@ti.func
def return_plane(s: ti.template(), material: ti.template()):
    """Return a stress whose third axis is principal; also gives the strain released at the apex."""
    centre, half = 0.5 * (s[0, 0] + s[1, 1]), 0.5 * (s[0, 0] - s[1, 1])
    radius = ti.sqrt(half * half + s[0, 1] * s[0, 1])
    a, b, z, yields, freed = return_principal(centre + radius, centre - radius, s[2, 2], material)
    t = s
    if yields:
        scale = 0.5 * (a - b) / ti.max(radius, TINY)
        t[0, 0], t[1, 1], t[2, 2] = 0.5 * (a + b) + scale * half, 0.5 * (a + b) - scale * half, z
        t[0, 1] = t[1, 0] = scale * s[0, 1]
    return t, freed


@ti.func
def return_space(s: ti.template(), material: ti.template()):
    """Return a full stress; also gives the strain released at the apex.

    The principal value farthest from the other two, and its projector, are exact to round-off even where the other two
    meet (Scherzinger & Dohrmann 2008, doi:10.1016/j.cma.2008.03.031); what is left is a plane problem about that axis.
    """
    k = ti.static(material.n_phi)
    eye = ti.Matrix.identity(float, 3)
    p = THIRD * s.trace()
    d = s - p * eye
    j2 = 0.5 * (d * d).sum()
    t, freed = s, 0.0
    if (k - 1.0) * (p - material.apex) + ti.static((4.0 * THIRD * (k * k + k + 1.0)) ** 0.5) * ti.sqrt(j2) > 0.0:
        # outside the cone inscribed in the surface
        inverse = 3.0 / ti.max(j2, TINY)
        lode = ti.min(ti.max(0.5 * d.determinant() * inverse * ti.sqrt(inverse), -1.0), 1.0)
        far = 2.0 * ti.sqrt(THIRD * j2) * ti.cos(THIRD * ti.acos(ti.abs(lode))) * ti.select(lode < 0.0, -1.0, 1.0)
        along = (d @ d + far * d + (far * far - j2) * eye) / ti.max(3.0 * far * far - j2, TINY)
        across = d + 0.5 * far * eye - 1.5 * far * along
        radius = ti.sqrt(0.5 * (across * across).sum())
        centre = p - 0.5 * far
        a, b, z, yields, opened = return_principal(centre + radius, centre - radius, p + far, material)
        if yields:
            freed = opened
            scale = 0.5 * (a - b) / ti.max(radius, TINY)
            t = 0.5 * (a + b) * (eye - along) + z * along + scale * across
    return t, freed


@ti.func
def return_principal(a, b, z, material: ti.template()):
    """Return principal stresses a >= b and any z; also gives whether they yield and the strain released at the apex."""
    apex = ti.static(material.apex)
    s1, s2, s3 = ti.max(a, z) - apex, ti.max(b, ti.min(a, z)) - apex, ti.min(b, z) - apex
    yields = material.n_phi * s1 > s3
    new_a, new_b, new_z, freed = a, b, z, 0.0
    if yields:
        t1, t2, t3, opened = return_sorted(s1, s2, s3, material)
        freed = opened
        new_a, new_b, new_z = t1 + apex, t3 + apex, t2 + apex
        if z >= a:
            new_z, new_a = t1 + apex, t2 + apex
        elif z <= b:
            new_z, new_b = t3 + apex, t2 + apex
    return new_a, new_b, new_z, yields, freed


@ti.func
def return_sorted(s1, s2, s3, material: ti.template()):
    """Exact return to face, edge or apex (Clausen et al. 2007), stresses measured from the apex."""
    k, m, bulk, shear = ti.static(material.n_phi, material.n_psi, material.bulk, material.shear)
    per_shear, per_bulk = ti.static(0.5 / shear, THIRD / bulk)
    spread = ti.static((k - 1.0) * (m - 1.0) / (3.0 * shear))
    coupling = ti.static((0.5 * bulk / shear - THIRD) * (m - 1.0))
    p = THIRD * (s1 + s2 + s3)
    tension1 = (s1 + s2 - 2.0 * p + m * (s3 - p)) * per_shear + (2.0 + m) * p * per_bulk
    tension2 = (s1 - p + m * (s2 + s3 - 2.0 * p)) * per_shear + (1.0 + 2.0 * m) * p * per_bulk
    t1, t2, t3, freed = 0.0, 0.0, 0.0, 0.0
    if tension1 >= 0.0 and tension2 >= 0.0:
        freed = ti.max(3.0 * per_bulk * p, 0.0)
    else:
        step = (k * s1 - s3) * ti.static(1.0 / (k * m + 1.0 + coupling * (k - 1.0)))
        t1, t2, t3 = s1 - step * (m + coupling), s2 - step * coupling, s3 - step * (coupling - 1.0)
        if t1 < t2:
            t1 = tension1 * ti.static(1.0 / (spread + (2.0 + m) * (2.0 + k) / (9.0 * bulk)))
            t2, t3 = t1, k * t1
        elif t3 > t2:
            t1 = tension2 * ti.static(1.0 / (spread + (1.0 + 2.0 * m) * (1.0 + 2.0 * k) / (9.0 * bulk)))
            t2, t3 = k * t1, k * t1
    return t1, t2, t3, freed
