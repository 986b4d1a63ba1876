"""What the stress update shares in two and three dimensions: eight points at once, opening, principal stresses."""

from __future__ import annotations

from mpmcol.mpm.jit import device
from mpmcol.mpm.simd import load, sqrt, store, transpose, where_positive

J_MIN, J_MAX = 0.1, 50.0
OPEN_MAX = 1e30  # a grain alone keeps its velocity gradient and opens as exp(t): so far, it never closes


@device
def load_eight(rows, o, row):
    """The same eight lanes of eight successive records, each lane of all points as one vector."""
    return transpose(
        load(rows, o), load(rows, o + row), load(rows, o + 2 * row), load(rows, o + 3 * row),
        load(rows, o + 4 * row), load(rows, o + 5 * row), load(rows, o + 6 * row), load(rows, o + 7 * row),
    )  # fmt: skip


@device
def store_eight(rows, o, row, count, lanes):
    """Write back what `load_eight` read, for the first `count` records."""
    r0, r1, r2, r3, r4, r5, r6, r7 = transpose(*lanes)
    store(rows, o, r0)
    if count > 1:
        store(rows, o + row, r1)
    if count > 2:
        store(rows, o + 2 * row, r2)
    if count > 3:
        store(rows, o + 3 * row, r3)
    if count > 4:
        store(rows, o + 4 * row, r4)
    if count > 5:
        store(rows, o + 5 * row, r5)
    if count > 6:
        store(rows, o + 6 * row, r6)
    if count > 7:
        store(rows, o + 7 * row, r7)


@device
def exponential(x):
    """exp(x) for the volumetric strain of a step, to 1e-14 at |x| = 0.1, positive for any: Pade (3, 3) of x / 2."""
    y = 0.5 * x
    square = y * y
    even, odd = 1.0 + 0.1 * square, y * (0.5 + square * (1.0 / 120.0))
    root_of_it = (even + odd) / (even - odd)
    return root_of_it * root_of_it


@device
def open_or_close(opening, ratio, volumetric):
    """What an opened point does with the volume change of this step, Eq. (29)-(30).

    Returns the new opening strain (0 for points that are closed, or close now), the volume ratio and the volumetric
    strain that are left to the closed material, and one where the point stays open: there both are void.
    """
    opened = (1.0 + opening) * ratio - 1.0
    opened = where_positive(opened - OPEN_MAX, OPEN_MAX, opened)
    stays = where_positive(opening, where_positive(opened, 1.0, 0.0), 0.0)
    ratio = where_positive(stays, 1.0, where_positive(opening, 1.0 + opened, ratio))
    return where_positive(stays, opened, 0.0), ratio, where_positive(opening, opened, volumetric), stays


@device
def increment(params, closed, volumetric, stays):
    """2 G, and the part of the elastic increment that all normal stresses share; nothing where a point stays open."""
    g2 = where_positive(stays, 0.0, 2.0 * params.shear_modulus)
    return g2, where_positive(stays, 0.0, params.bulk_modulus * closed) - g2 * (volumetric * (1.0 / 3.0))


@device
def return_pair(a, b, z, history, params, return_map):
    """Return three principal stresses of which a >= b, and z may stand anywhere; each comes back in its place."""
    above, below = z - a, b - z
    s1, s3 = where_positive(above, z, a), where_positive(below, z, b)
    s2 = where_positive(above, a, where_positive(below, b, z))
    r1, r2, r3, history, freed, yields = return_map(s1, s2, s3, history, params)
    r_a, r_b = where_positive(above, r2, r1), where_positive(below, r2, r3)
    return r_a, r_b, where_positive(above, r1, where_positive(below, r3, r2)), history, freed, yields


@device
def settle(yields, new_history, history, freed, opening, ratio, settings):
    """History, opening strain and volume ratio after the return; as they were where nothing yields."""
    history = where_positive(yields, new_history[0], history[0]), where_positive(yields, new_history[1], history[1])
    if settings.opening_strain:
        freed = where_positive(yields, freed, 0.0)
        opening, ratio = opening + freed, ratio / (1.0 + freed)
    return history, opening, ratio


@device
def inspect(J, v2, c2, settings):
    """Wave speed plus speed (Eq. 35-36), and one where a point is finite and slower than its waves or a free fall."""
    c2_p, fall2 = c2 * J, settings.free_speed * settings.free_speed
    limit2 = where_positive(c2_p - fall2, c2_p, fall2)
    sound = where_positive(limit2 - v2, where_positive(J - J_MIN, where_positive(J_MAX - J, 1.0, 0.0), 0.0), 0.0)
    return sqrt(c2_p) + sqrt(v2), sound
