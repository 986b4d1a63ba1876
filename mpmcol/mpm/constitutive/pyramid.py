"""Exact returns of sorted principal stresses s1 >= s2 >= s3 (tension > 0) to the Mohr-Coulomb pyramid.

Yield function k s1 - s3 - strength with k = (1 + sin phi) / (1 - sin phi) and strength = 2 c sqrt(k), plastic potential
m s1 - s3 with m likewise from psi (Clausen, Damkilde & Andersen 2007, doi:10.1016/j.compstruc.2007.04.002).

The cut-off s1 <= tension has an associated flow rule. A stress returns by shear alone or by tension alone if the result
satisfies the other condition. Otherwise both are active: s1 = tension, s3 = k tension - strength, and s2 follows from
elasticity, since its plastic strain is zero, within these two.
"""

from __future__ import annotations

from mpmcol.mpm.jit import device
from mpmcol.mpm.simd import where_positive


@device
def distances_to_edges(s1, s2, s3, p, m, bulk, shear):
    """Elastic strain of a stress with mean p along the normals of the flow directions of both edges."""
    return (
        (s1 + s2 - 2.0 * p + m * (s3 - p)) * (0.5 / shear) + (2.0 + m) * p * (1.0 / (3.0 * bulk)),
        (s1 - p + m * (s2 + s3 - 2.0 * p)) * (0.5 / shear) + (1.0 + 2.0 * m) * p * (1.0 / (3.0 * bulk)),
    )


@device
def return_to_face(s1, s2, s3, excess, k, m, bulk, shear):
    """Return to the face k s1 - s3 = strength, from a stress with this excess of the yield function."""
    coupling = (0.5 * bulk / shear - 1.0 / 3.0) * (m - 1.0)  # lambda / 2G (m - 1)
    step = excess * (1.0 / (k * m + 1.0 + coupling * (k - 1.0)))
    return s1 - step * (m + coupling), s2 - step * coupling, s3 - step * (coupling - 1.0)


@device
def return_to_cone(s1, s2, s3, k, m, bulk, shear):
    """Return a yielding stress, measured from the apex; also gives the volumetric strain released at the apex."""
    p = (s1 + s2 + s3) * (1.0 / 3.0)
    # Distance from each edge, along the flow directions of its two faces; where both are positive the stress returns
    # to the apex.
    edge1, edge3 = distances_to_edges(s1, s2, s3, p, m, bulk, shear)
    face1, face2, face3 = return_to_face(s1, s2, s3, k * s1 - s3, k, m, bulk, shear)

    spread = (k - 1.0) * (m - 1.0) * (1.0 / (3.0 * shear))
    on1 = edge1 * (1.0 / (spread + (2.0 + m) * (2.0 + k) * (1.0 / (9.0 * bulk))))
    on3 = edge3 * (1.0 / (spread + (1.0 + 2.0 * m) * (1.0 + 2.0 * k) * (1.0 / (9.0 * bulk))))
    beyond1, beyond3 = face2 - face1, face3 - face2
    t1 = where_positive(beyond1, on1, where_positive(beyond3, on3, face1))
    t2 = where_positive(beyond1, on1, where_positive(beyond3, k * on3, face2))
    t3 = where_positive(beyond1, k * on1, where_positive(beyond3, k * on3, face3))

    at_apex = where_positive(edge1, where_positive(edge3, 1.0, 0.0), 0.0)
    released = where_positive(at_apex, where_positive(p, p * (1.0 / bulk), 0.0), 0.0)
    return (
        where_positive(at_apex, 0.0, t1),
        where_positive(at_apex, 0.0, t2),
        where_positive(at_apex, 0.0, t3),
        released,
    )


@device
def excess_with_cut_off(s1, s3, k, strength, tension):
    """The larger yield function, of shear or of tension."""
    in_shear, in_tension = k * s1 - s3 - strength, s1 - tension
    return where_positive(in_shear - in_tension, in_shear, in_tension)


@device
def return_by_shear(s1, s2, s3, k, m, strength, bulk, shear):
    """Return to the faces and edges of the pyramid without its apex; the stress itself inside."""
    p = (s1 + s2 + s3) * (1.0 / 3.0)
    excess = k * s1 - s3 - strength
    face1, face2, face3 = return_to_face(s1, s2, s3, excess, k, m, bulk, shear)
    edge1, edge3 = distances_to_edges(s1, s2, s3, p, m, bulk, shear)
    spread, ninth = (m - 1.0) * (1.0 / (3.0 * shear)), 1.0 / (9.0 * bulk)
    wide1, wide3 = (2.0 + m) * ninth, (1.0 + 2.0 * m) * ninth
    on1 = (edge1 + strength * (spread + wide1)) * (1.0 / (spread * (k - 1.0) + wide1 * (2.0 + k)))
    on3 = (edge3 + strength * (spread + 2.0 * wide3)) * (1.0 / (spread * (k - 1.0) + wide3 * (1.0 + 2.0 * k)))
    beyond1, beyond3 = face2 - face1, face3 - face2
    low1, low3 = k * on1 - strength, k * on3 - strength
    t1 = where_positive(beyond1, on1, where_positive(beyond3, on3, face1))
    t2 = where_positive(beyond1, on1, where_positive(beyond3, low3, face2))
    t3 = where_positive(beyond1, low1, where_positive(beyond3, low3, face3))
    return where_positive(excess, t1, s1), where_positive(excess, t2, s2), where_positive(excess, t3, s3)


@device
def return_by_tension(s1, s2, s3, tension, nu):
    """Return from s1 > tension to the cut-off: to one plane, two, or its apex."""
    transverse = (s1 - tension) * (nu / (1.0 - nu))
    one2, one3 = s2 - transverse, s3 - transverse
    two3 = s3 - nu * (s1 + s2 - 2.0 * tension)
    on_two = one2 - tension
    t3 = where_positive(on_two, two3, one3)
    return tension, where_positive(on_two, tension, one2), where_positive(t3 - tension, tension, t3)


@device
def return_with_cut_off(s1, s2, s3, k, m, strength, tension, bulk, shear):
    """Return a yielding stress to pyramid and cut-off.

    Returns also the volumetric strain released at the apex of the cut-off, and the plastic one where tension is active.
    """
    nu = (3.0 * bulk - 2.0 * shear) / (6.0 * bulk + 2.0 * shear)
    a1, a2, a3 = return_by_shear(s1, s2, s3, k, m, strength, bulk, shear)
    b1, b2, b3 = return_by_tension(s1, s2, s3, tension, nu)
    low = k * tension - strength  # s3 where both are active
    c2 = s2 - nu * (s1 - tension + s3 - low)
    c2 = where_positive(c2 - tension, tension, where_positive(low - c2, low, c2))
    both, in_tension = k * b1 - b3 - strength, a1 - tension
    t1 = where_positive(in_tension, tension, a1)
    t2 = where_positive(in_tension, where_positive(both, c2, b2), a2)
    t3 = where_positive(in_tension, where_positive(both, low, b3), a3)
    expanded = where_positive(in_tension, (s1 - t1 + s2 - t2 + s3 - t3) * (1.0 / (3.0 * bulk)), 0.0)
    expanded = where_positive(expanded, expanded, 0.0)
    return t1, t2, t3, where_positive(tension - t3, 0.0, expanded), expanded
