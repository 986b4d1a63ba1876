"""Tensors and records of the stress update in three dimensions.

Stresses and strains are tuples xx yy zz xy yz xz, velocity gradients xx xy xz yx yy yz zx zy zz.
"""

from __future__ import annotations

from mpmcol.mpm import lanes
from mpmcol.mpm.jit import device
from mpmcol.mpm.kernels.principal_stress import determinant, distinct_eigenvalue, eigenvector, second_invariant
from mpmcol.mpm.kernels.stress_common import return_unsorted, store_up_to_eight
from mpmcol.mpm.lanes import X_VECTOR, Y_VECTOR, Z_VECTOR
from mpmcol.mpm.simd import load_eight, sqrt, where_positive

SIZE = lanes.RECORD_SIZE[3]


@device
def load_points(rows, o):
    """Position, squared speed, V0, J, opening, history, stress, velocity gradient and labels of eight points."""
    _, v_x, v_y, v_z, x, y, z, V0 = load_eight(rows, o, SIZE)
    J, l_xx, l_yx, l_zx, s_xx, s_xy, s_xz, opening = load_eight(rows, o + X_VECTOR, SIZE)
    number, l_xy, l_yy, l_zy, _, s_yy, s_yz, kind = load_eight(rows, o + Y_VECTOR, SIZE)
    q_0, l_xz, l_yz, l_zz, _, _, s_zz, q_1 = load_eight(rows, o + Z_VECTOR, SIZE)
    s, L = (s_xx, s_yy, s_zz, s_xy, s_yz, s_xz), (l_xx, l_xy, l_xz, l_yx, l_yy, l_yz, l_zx, l_zy, l_zz)
    return (x, y, z), v_x * v_x + v_y * v_y + v_z * v_z, V0, J, opening, (q_0, q_1), s, L, (number, kind)


@device
def store_points(rows, o, count, J, opening, history, s, L, labels):
    """Write the stress and the state variables of the first `count` of eight points."""
    s_xx, s_yy, s_zz, s_xy, s_yz, s_xz = s
    l_xx, l_xy, l_xz, l_yx, l_yy, l_yz, l_zx, l_zy, l_zz = L
    number, kind = labels
    store_up_to_eight(rows, o + X_VECTOR, SIZE, count, (J, l_xx, l_yx, l_zx, s_xx, s_xy, s_xz, opening))
    store_up_to_eight(rows, o + Y_VECTOR, SIZE, count, (number, l_xy, l_yy, l_zy, s_xy, s_yy, s_yz, kind))
    store_up_to_eight(rows, o + Z_VECTOR, SIZE, count, (history[0], l_xz, l_yz, l_zz, s_xz, s_yz, s_zz, history[1]))


@device
def check_inside(valid, x, box):
    """`valid` where a point is inside the box, else zero."""
    valid = where_positive(box.x_high - x[0], where_positive(box.y_high - x[1], valid, 0.0), 0.0)
    valid = where_positive(box.z_high - x[2], where_positive(x[0] - box.x_low, valid, 0.0), 0.0)
    return where_positive(x[2] - box.z_low, valid, 0.0)


@device
def subtract_diagonal(L, excess):
    """L - excess I."""
    return L[0] - excess, L[1], L[2], L[3], L[4] - excess, L[5], L[6], L[7], L[8] - excess


@device
def strain_increment(L, dt):
    """dt sym(L), Eq. 32."""
    l_xx, l_xy, l_xz, l_yx, l_yy, l_yz, l_zx, l_zy, l_zz = L
    half = 0.5 * dt
    return dt * l_xx, dt * l_yy, dt * l_zz, half * (l_xy + l_yx), half * (l_yz + l_zy), half * (l_xz + l_zx)


@device
def volume_ratio(L, dt):
    """det(I + dt L), Eq. 29, 30."""
    xx, xy, xz, yx, yy, yz, zx, zy, zz = L
    a, b, c = 1.0 + dt * xx, 1.0 + dt * yy, 1.0 + dt * zz
    xy, xz, yx, yz, zx, zy = dt * xy, dt * xz, dt * yx, dt * yz, dt * zx, dt * zy
    return a * (b * c - yz * zy) - xy * (yx * c - yz * zx) + xz * (yx * zy - b * zx)


@device
def rotate(s, L, dt):
    """Stress s + dt (W s - s W) after the rotation of this step, Eq. 33, 34."""
    xx, yy, zz, xy, yz, xz = s
    half = 0.5 * dt
    w_xy, w_yz, w_xz = half * (L[1] - L[3]), half * (L[5] - L[7]), half * (L[2] - L[6])
    return (
        xx + 2.0 * (w_xy * xy + w_xz * xz),
        yy + 2.0 * (w_yz * yz - w_xy * xy),
        zz - 2.0 * (w_xz * xz + w_yz * yz),
        xy + w_xy * (yy - xx) + w_xz * yz + w_yz * xz,
        yz + w_yz * (zz - yy) - w_xy * xz - w_xz * xy,
        xz + w_xz * (zz - xx) + w_xy * yz - w_yz * xy,
    )


@device
def isotropic(p):
    """p I."""
    return p, p, p, 0.0, 0.0, 0.0


@device
def add(a, b):
    """a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3], a[4] + b[4], a[5] + b[5]


@device
def add_elastic(s, e, g2, pressure):
    """s + g2 e + pressure I."""
    return (
        s[0] + g2 * e[0] + pressure, s[1] + g2 * e[1] + pressure, s[2] + g2 * e[2] + pressure,
        s[3] + g2 * e[3], s[4] + g2 * e[4], s[5] + g2 * e[5],
    )  # fmt: skip


@device
def select(condition, a, b):
    """Tensor a where the condition is above zero, else b."""
    return (
        where_positive(condition, a[0], b[0]), where_positive(condition, a[1], b[1]),
        where_positive(condition, a[2], b[2]), where_positive(condition, a[3], b[3]),
        where_positive(condition, a[4], b[4]), where_positive(condition, a[5], b[5]),
    )  # fmt: skip


@device
def contract(s, e):
    """s : e."""
    return s[0] * e[0] + s[1] * e[1] + s[2] * e[2] + 2.0 * (s[3] * e[3] + s[4] * e[4] + s[5] * e[5])


@device
def scale_deviator(s, scale, shift):
    """scale s + shift I."""
    return (
        scale * s[0] + shift, scale * s[1] + shift, scale * s[2] + shift, scale * s[3], scale * s[4], scale * s[5],
    )  # fmt: skip


@device
def invariants(s):
    """Mean stress, and shear stress sqrt(J2)."""
    mean, _, j2 = decompose(s)
    return mean, sqrt(j2)


@device
def decompose(s):
    """Mean stress, deviator and its invariant J2."""
    p = (s[0] + s[1] + s[2]) * (1.0 / 3.0)
    d = (s[0] - p, s[1] - p, s[2] - p, s[3], s[4], s[5])
    return p, d, second_invariant(d)


@device
def principal_bounds(parts):
    """Upper and lower bound of the principal stresses: none differs from p by more than sqrt(4/3 J2)."""
    p, _, j2 = parts
    radius = sqrt(j2 * (4.0 / 3.0))
    return p + radius, p - radius


@device
def return_stress(parts, history, params, dt, return_map):
    """Return a stress given by `decompose` to the yield surface, with the principal directions unchanged."""
    p, d, j2 = parts
    value = distinct_eigenvalue(j2, determinant(d))
    n_x, n_y, n_z = eigenvector(d, value)
    # deviator in the plane normal to n, without its mean
    half, share = 0.5 * value, 1.5 * value
    b = (
        d[0] + half - share * n_x * n_x, d[1] + half - share * n_y * n_y, d[2] + half - share * n_z * n_z,
        d[3] - share * n_x * n_y, d[4] - share * n_y * n_z, d[5] - share * n_x * n_z,
    )  # fmt: skip
    radius, centre = sqrt(second_invariant(b)), p - half
    r_a, r_b, r_n, q, released, yields = return_unsorted(
        centre + radius, centre - radius, p + value, history, params, dt, return_map
    )
    scale = where_positive(radius, 0.5 * (r_a - r_b) / radius, 0.0)
    mean = 0.5 * (r_a + r_b)
    rest = r_n - mean
    returned = (
        mean + rest * n_x * n_x + scale * b[0], mean + rest * n_y * n_y + scale * b[1],
        mean + rest * n_z * n_z + scale * b[2], rest * n_x * n_y + scale * b[3],
        rest * n_y * n_z + scale * b[4], rest * n_x * n_z + scale * b[5],
    )  # fmt: skip
    return returned, q, released, yields
