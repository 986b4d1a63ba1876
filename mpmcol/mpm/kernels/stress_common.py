"""Parts of the stress update that are the same in two and three dimensions, for a point or for eight as vectors."""

from __future__ import annotations

from mpmcol.mpm.jit import device
from mpmcol.mpm.lanes import LANES
from mpmcol.mpm.simd import load, scratch, sqrt, store, store_eight, where_positive

J_MIN, J_MAX = 0.1, 50.0
EIGHT_VECTORS = LANES * LANES  # doubles
# A single particle keeps its velocity gradient and opens as exp(t). Opened this far it never closes.
OPEN_MAX = 1e30


@device
def store_up_to_eight(rows, o, size, count, lanes):
    """Write one vector of each of the first `count` <= 8 records of `size` doubles, given as a vector per lane."""
    if count == LANES:
        store_eight(rows, o, size, *lanes)
        return
    held = scratch(EIGHT_VECTORS)
    store_eight(held, 0, LANES, *lanes)
    for k in range(count):
        store(rows, o + k * size, load(held, k * LANES))


@device
def exponential(x):
    """exp(x) of a volumetric strain increment, to 1e-14 at |x| = 0.1, positive for any x: Pade (3, 3) of x / 2."""
    y = 0.5 * x
    square = y * y
    even, odd = 1.0 + 0.1 * square, y * (0.5 + square * (1.0 / 120.0))
    half = (even + odd) / (even - odd)
    return half * half


@device
def open_or_close(opening, ratio, volumetric):
    """Opening strain of opened points after the volume change of this step, Eq. (29)-(30).

    ratio, volumetric: volume ratio and volumetric strain increment of the step. Returns the new opening strain (0 for
    points that are closed or close in this step), the volume ratio and the volumetric strain increment of the closed
    material, and one where a point stays open; there the two before it are meaningless.
    """
    opened = (1.0 + opening) * ratio - 1.0
    opened = where_positive(opened - OPEN_MAX, OPEN_MAX, opened)
    is_open = where_positive(opening, where_positive(opened, 1.0, 0.0), 0.0)
    ratio = where_positive(is_open, 1.0, where_positive(opening, 1.0 + opened, ratio))
    return where_positive(is_open, opened, 0.0), ratio, where_positive(opening, opened, volumetric), is_open


@device
def elastic_increment(params, closed, volumetric, is_open):
    """2 G, and the part of the elastic increment common to the normal stresses; both zero where a point stays open.

    closed: volumetric strain increment of the closed material. volumetric: trace of the strain increment.
    """
    g2 = where_positive(is_open, 0.0, 2.0 * params.shear_modulus)
    return g2, where_positive(is_open, 0.0, params.bulk_modulus * closed) - g2 * (volumetric * (1.0 / 3.0))


@device
def return_unsorted(a, b, z, history, params, dt, return_map):
    """Return three principal stresses in their order; a >= b, and z may be anywhere."""
    above, below = z - a, b - z
    s1, s3 = where_positive(above, z, a), where_positive(below, z, b)
    s2 = where_positive(above, a, where_positive(below, b, z))
    r1, r2, r3, history, released, yields = return_map(s1, s2, s3, history, params, dt)
    r_a, r_b = where_positive(above, r2, r1), where_positive(below, r2, r3)
    return r_a, r_b, where_positive(above, r1, where_positive(below, r3, r2)), history, released, yields


@device
def apply_return(yields, new_history, history, released, opening, ratio, settings):
    """History, opening strain and volume ratio after the return to the yield surface; unchanged where `yields` <= 0."""
    history = where_positive(yields, new_history[0], history[0]), where_positive(yields, new_history[1], history[1])
    if settings.opening_strain:
        released = where_positive(yields, released, 0.0)
        opening, ratio = opening + released, ratio / (1.0 + released)
    return history, opening, ratio


@device
def check_point(J, v2, c2, settings):
    """Wave speed plus speed (Eq. 35-36), and one where the state is valid.

    Valid: J within bounds, everything finite, and the speed below the wave speed or that of a free fall.
    """
    c2_p, fall2 = c2 * J, settings.free_speed * settings.free_speed
    limit2 = where_positive(c2_p - fall2, c2_p, fall2)
    valid = where_positive(limit2 - v2, where_positive(J - J_MIN, where_positive(J_MAX - J, 1.0, 0.0), 0.0), 0.0)
    return sqrt(c2_p) + sqrt(v2), valid
