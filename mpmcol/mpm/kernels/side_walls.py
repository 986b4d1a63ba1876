"""Friction on the side walls of a channel that is modelled in plane strain."""

from __future__ import annotations

import numpy as np

from mpmcol.mpm.contact import FRICTION_WORK, Contacts
from mpmcol.mpm.grid import Tiles
from mpmcol.mpm.jit import device, phase, prange
from mpmcol.mpm.kernels.particle_update import SIDE_WORK
from mpmcol.mpm.lanes import RECORD_SIZE, S_ZZ, V0, VX, VY, J, M

SIZE = RECORD_SIZE[2]


@device
def slow_point(rows: np.ndarray, o: int, rate: float) -> float:
    """Reduce the velocity of the point whose record starts at `o`; return its loss of kinetic energy, J/m.

    rate: 2 mu dt / W (s/m) for a channel of width W. The walls exert the force -(2 mu / W) p v / |v| per volume with
    the pressure p = -sigma_zz on them, at most that which stops the point within the step.
    """
    v2 = rows[o + VX] * rows[o + VX] + rows[o + VY] * rows[o + VY]
    impulse, momentum = rate * max(-rows[o + S_ZZ], 0.0) * rows[o + J] * rows[o + V0], rows[o + M] * np.sqrt(v2)
    remaining = 1.0 - impulse / momentum if impulse < momentum else 0.0
    rows[o + VX] *= remaining
    rows[o + VY] *= remaining
    return 0.5 * rows[o + M] * v2 * (1.0 - remaining * remaining)


@phase
def slow_points(rows: np.ndarray, tiles: Tiles, contacts: Contacts, dt: float, report: np.ndarray) -> None:
    """Friction of the side walls on all points of the column, before a step.

    Reads: sigma, J. Writes: v, report (n_tiles, SIDE_WORK). A body force, b of Eq. (2).
    """
    start, split, rate = tiles.start, tiles.split, contacts.side_friction * dt
    for t in prange(len(split)):
        lost = 0.0
        for p in range(start[t], split[t]):
            lost += slow_point(rows, p * SIZE, rate)
        report[t, SIDE_WORK] = lost


@device
def sum_side_work(report: np.ndarray, contacts: Contacts) -> None:
    """Add the reports of all tiles to the work on the side walls, in a fixed order."""
    lost, sums = 0.0, contacts.sums
    for t in range(len(report)):
        lost += report[t, SIDE_WORK]
    sums[-1, FRICTION_WORK] += lost
