"""Tensors and records of the stress update in plane strain and axisymmetry.

Stresses and strains are tuples xx yy zz xy, velocity gradients xx xy yx yy zz.
"""

from __future__ import annotations

from mpmcol.mpm import lanes
from mpmcol.mpm.jit import device
from mpmcol.mpm.kernels.stress_common import return_unsorted, store_up_to_eight
from mpmcol.mpm.lanes import X_VECTOR, Y_VECTOR
from mpmcol.mpm.simd import load_eight, sqrt, where_positive

SIZE = lanes.RECORD_SIZE[2]


@device
def load_points(rows, o):
    """Position, squared speed, V0, J, opening, history, stress, velocity gradient and labels of eight points."""
    _, v_x, v_y, _, x, y, _, V0 = load_eight(rows, o, SIZE)
    J, l_xx, l_yx, l_zz, s_xx, s_xy, s_zz, opening = load_eight(rows, o + X_VECTOR, SIZE)
    number, l_xy, l_yy, q_0, _, s_yy, q_1, kind = load_eight(rows, o + Y_VECTOR, SIZE)
    s, L = (s_xx, s_yy, s_zz, s_xy), (l_xx, l_xy, l_yx, l_yy, l_zz)
    return (x, y), v_x * v_x + v_y * v_y, V0, J, opening, (q_0, q_1), s, L, (number, kind)


@device
def store_points(rows, o, count, J, opening, history, s, L, labels):
    """Write the stress and the state variables of the first `count` of eight points."""
    s_xx, s_yy, s_zz, s_xy = s
    l_xx, l_xy, l_yx, l_yy, l_zz = L
    number, kind = labels
    store_up_to_eight(rows, o + X_VECTOR, SIZE, count, (J, l_xx, l_yx, l_zz, s_xx, s_xy, s_zz, opening))
    store_up_to_eight(rows, o + Y_VECTOR, SIZE, count, (number, l_xy, l_yy, history[0], s_xy, s_yy, history[1], kind))


@device
def check_inside(valid, x, box):
    """`valid` where a point is inside the box, else zero."""
    valid = where_positive(box.x_high - x[0], where_positive(box.y_high - x[1], valid, 0.0), 0.0)
    return where_positive(x[0] - box.x_low, valid, 0.0)


@device
def subtract_diagonal(L, excess):
    """L - excess I."""
    return L[0] - excess, L[1], L[2], L[3] - excess, L[4] - excess


@device
def strain_increment(L, dt):
    """dt sym(L), Eq. 32."""
    return dt * L[0], dt * L[3], dt * L[4], 0.5 * (dt * L[1] + dt * L[2])


@device
def volume_ratio(L, dt):
    """det(I + dt L), Eq. 29, 30."""
    return ((1.0 + dt * L[0]) * (1.0 + dt * L[3]) - dt * L[1] * (dt * L[2])) * (1.0 + dt * L[4])


@device
def rotate(s, L, dt):
    """Stress s + dt (W s - s W) after the rotation of this step, Eq. 33, 34."""
    s_xx, s_yy, s_zz, s_xy = s
    spin2 = dt * L[1] - dt * L[2]  # 2 dt W_xy
    return s_xx + spin2 * s_xy, s_yy - spin2 * s_xy, s_zz, s_xy + 0.5 * spin2 * (s_yy - s_xx)


@device
def isotropic(p):
    """p I."""
    return p, p, p, 0.0


@device
def add(a, b):
    """a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]


@device
def add_elastic(s, e, g2, pressure):
    """s + g2 e + pressure I."""
    return s[0] + g2 * e[0] + pressure, s[1] + g2 * e[1] + pressure, s[2] + g2 * e[2] + pressure, s[3] + g2 * e[3]


@device
def select(condition, a, b):
    """Tensor a where the condition is above zero, else b."""
    return (
        where_positive(condition, a[0], b[0]), where_positive(condition, a[1], b[1]),
        where_positive(condition, a[2], b[2]), where_positive(condition, a[3], b[3]),
    )  # fmt: skip


@device
def contract(s, e):
    """s : e."""
    return s[0] * e[0] + s[1] * e[1] + s[2] * e[2] + 2.0 * s[3] * e[3]


@device
def scale_deviator(s, scale, shift):
    """scale s + shift I."""
    return scale * s[0] + shift, scale * s[1] + shift, scale * s[2] + shift, scale * s[3]


@device
def invariants(s):
    """Mean stress, and shear stress sqrt(J2)."""
    mean = (s[0] + s[1] + s[2]) * (1.0 / 3.0)
    xx, yy, zz = s[0] - mean, s[1] - mean, s[2] - mean
    return mean, sqrt(0.5 * (xx * xx + yy * yy + zz * zz) + s[3] * s[3])


@device
def decompose(s):
    """Centre, half the difference of the normal stresses, shear stress, radius of Mohr's circle; and s_zz."""
    centre, half = 0.5 * (s[0] + s[1]), 0.5 * (s[0] - s[1])
    return centre, half, s[3], sqrt(half * half + s[3] * s[3]), s[2]


@device
def principal_bounds(parts):
    """Largest and smallest principal stress."""
    centre, _, _, radius, s_zz = parts
    a, b = centre + radius, centre - radius
    return where_positive(s_zz - a, s_zz, a), where_positive(b - s_zz, s_zz, b)


@device
def return_stress(parts, history, params, dt, return_map):
    """Return a stress given by `decompose` to the yield surface, with the principal directions unchanged."""
    centre, half, s_xy, radius, s_zz = parts
    r_a, r_b, r_z, q, released, yields = return_unsorted(
        centre + radius, centre - radius, s_zz, history, params, dt, return_map
    )
    scale = where_positive(radius, 0.5 * (r_a - r_b) / radius, 0.0)
    centre = 0.5 * (r_a + r_b)
    return (centre + scale * half, centre - scale * half, r_z, scale * s_xy), q, released, yields
