"""Principal stresses of eight points in three dimensions, accurate to round-off, with square roots only.

The most distinct eigenvalue of the deviator, which is farthest from the other two, and its eigenvector n are well
conditioned (Scherzinger & Dohrmann 2008, doi:10.1016/j.cma.2008.03.031). In the plane normal to n a two-dimensional
problem remains, where equal eigenvalues are harmless. Symmetric tensors are tuples xx yy zz xy yz xz.
"""

from __future__ import annotations

from mpmcol.mpm.jit import device
from mpmcol.mpm.simd import sqrt, where_positive

TINY = 1e-60  # Pa2: J2 of a deviator that counts as zero


@device
def distinct_eigenvalue(j2, j3):
    """Eigenvalue of a deviator farthest from the other two, from its invariants J2 and J3.

    It is 2 c sqrt(J2 / 3) sign(J3), where 4 c^3 - 3 c = r and cos(30 deg) <= c <= 1. Two Newton steps from a cubic
    approximation, whose error is at most 2e-4, reach round-off.
    """
    s = sqrt(j2 * (1.0 / 3.0))
    r = where_positive(j2 - TINY, 0.5 * j3 / (s * s * s), 0.0)
    sign = where_positive(-r, -1.0, 1.0)
    r = where_positive(abs(r) - 1.0, 1.0, abs(r))
    c = 0.8660254037844386 + r * (0.16666666666666666 + r * (-0.0425207 + r * 0.0098286))
    for _ in range(2):
        c = (8.0 * c * c * c + r) / (12.0 * c * c - 3.0)
    return 2.0 * sign * s * c


@device
def eigenvector(d, value):
    """Unit eigenvector of the distinct eigenvalue `value` of a deviator; the x axis if the deviator is zero."""
    a, b, c, xy, yz, xz = d[0] - value, d[1] - value, d[2] - value, d[3], d[4], d[5]
    # the adjugate of (d - value I) is a multiple of n n^T; take its largest column
    m_xx, m_yy, m_zz = b * c - yz * yz, a * c - xz * xz, a * b - xy * xy
    m_xy, m_yz, m_xz = xz * yz - xy * c, xy * xz - yz * a, xy * yz - xz * b
    y_first = m_yy - m_xx
    z_first = m_zz - where_positive(y_first, m_yy, m_xx)
    x = where_positive(z_first, m_xz, where_positive(y_first, m_xy, m_xx))
    y = where_positive(z_first, m_yz, where_positive(y_first, m_yy, m_xy))
    z = where_positive(z_first, m_zz, where_positive(y_first, m_yz, m_xz))
    square = x * x + y * y + z * z
    scale = 1.0 / sqrt(where_positive(square, square, 1.0))
    return where_positive(square, x * scale, 1.0), y * scale, z * scale


@device
def second_invariant(d):
    """J2 = d : d / 2 of a deviator."""
    xx, yy, zz, xy, yz, xz = d
    return 0.5 * (xx * xx + yy * yy + zz * zz) + xy * xy + yz * yz + xz * xz


@device
def determinant(d):
    """J3 = det(d) of a symmetric tensor."""
    xx, yy, zz, xy, yz, xz = d
    return xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
