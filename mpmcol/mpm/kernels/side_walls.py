"""Friction on the side walls of a channel that is modelled in plane strain, for eight points at a time."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmcol.mpm.contact import FRICTION_WORK, Contacts
from mpmcol.mpm.jit import device
from mpmcol.mpm.kernels.stress_common import store_up_to_eight
from mpmcol.mpm.lanes import RECORD_SIZE
from mpmcol.mpm.simd import load_eight, sqrt, where_positive

SIZE = RECORD_SIZE[2]


@device
def slow_points(rows: np.ndarray, o: int, count: int, J: Any, s_zz: Any, rate: float) -> Any:
    """Reduce the velocities of `count` <= 8 points from `o` on after the stress update; returns the energy lost, J/m.

    rate: 2 mu dt / W (s/m) for a channel of width W. The walls exert the force -(2 mu / W) p v / |v| per volume, a body
    force, b of Eq. (2), with the pressure p = -sigma_zz on them. Reads: v, m, V0. Writes: v.
    """
    m, v_x, v_y, v_z, x, y, z, V0 = load_eight(rows, o, SIZE)
    remaining, lost = slow(m, v_x * v_x + v_y * v_y, rate * (where_positive(s_zz, 0.0, -s_zz) * (J * V0)))
    store_up_to_eight(rows, o, SIZE, count, (m, remaining * v_x, remaining * v_y, v_z, x, y, z, V0))
    return lost


@device
def slow(m: Any, v2: Any, impulse: Any) -> tuple[Any, Any]:
    """The part of its velocity that a point keeps after an impulse against it, and its loss of kinetic energy (J).

    v2: squared speed. The impulse (N s) stops a point at most.
    """
    momentum = m * sqrt(v2)
    remaining = where_positive(momentum - impulse, 1.0 - impulse / momentum, 0.0)
    return remaining, 0.5 * m * v2 * (1.0 - remaining * remaining)


@device
def sum_side_work(work: np.ndarray, contacts: Contacts) -> None:
    """Add the work (n_tiles,) in all tiles to that on the side walls, in a fixed order."""
    lost, sums = 0.0, contacts.sums
    for t in range(len(work)):
        lost += work[t]
    sums[-1, FRICTION_WORK] += lost
