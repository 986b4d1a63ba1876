"""Stress update: Jaumann rotation, elastic increment, return to the yield surface, eight points at a time."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from types import ModuleType
from typing import Any

import numpy as np

from mpmcol.mpm.constitutive import ConstitutiveLaw
from mpmcol.mpm.jit import device, subroutine, variant
from mpmcol.mpm.kernels import stress_2d, stress_3d
from mpmcol.mpm.kernels.side_walls import slow_points
from mpmcol.mpm.kernels.stress_common import (
    apply_return,
    check_point,
    elastic_increment,
    exponential,
    open_or_close,
)
from mpmcol.mpm.kernels.stress_filter import make_stress_filter
from mpmcol.mpm.kernels.stress_return import make_return
from mpmcol.mpm.kernels.volumetric_averaging import make_volumetric_excess
from mpmcol.mpm.lanes import LANES, RECORD_SIZE
from mpmcol.mpm.simd import any_positive, load, maximum, reduce_max, reduce_sum, splat, vector, where_positive

NO_FAULT = -1.0
ZZ = 2  # of a stress tuple
TENSORS: dict[int, ModuleType] = {2: stress_2d, 3: stress_3d}  # by dimension; both define the same functions


def make_stress_update(dimension: int, law: ConstitutiveLaw) -> Callable[..., Any]:
    """The stress update of one point, or of eight as vectors, with the formulas of `law` frozen in."""
    tensors, may_yield, return_map = TENSORS[dimension], law.may_yield, law.return_map
    apex, after_opening = law.apex, law.after_opening
    strain_increment, volume_ratio, rotate = tensors.strain_increment, tensors.volume_ratio, tensors.rotate
    isotropic, add_elastic, select, contract = (
        tensors.isotropic, tensors.add_elastic, tensors.select, tensors.contract,
    )  # fmt: skip
    decompose, bounds, return_stress = make_return(tensors, law)
    add = tensors.add

    @device
    @variant(dimension, law)
    def stress_update(s, L, V0, J, opening, history, params, settings, dt):
        """New stress, J, opening strain and history, and the stress work (J), Eq. 29-34.

        s: stress, and L: velocity gradient, as tuples in the order that the module in TENSORS states.
        """
        e = strain_increment(L, dt)  # Eq. 32
        volumetric = e[0] + e[1] + e[2]
        if settings.exponential_volume:
            ratio = exponential(volumetric)
        else:
            ratio = volume_ratio(L, dt)  # Eq. 29, 30
        t = select(opening, isotropic(apex(history, params)), rotate(s, L, dt))  # Eq. 33, 34
        opening, ratio, closed, is_open = open_or_close(opening, ratio, volumetric)
        g2, pressure = elastic_increment(params, closed, volumetric, is_open)
        t = add_elastic(t, e, g2, pressure)

        parts = decompose(t)
        first, last = bounds(parts)
        if any_positive(where_positive(is_open, 0.0, may_yield(first, last, history, params))):
            returned, new_history, released, yields = return_stress(parts, history, params, dt, return_map)
            yields = where_positive(is_open, 0.0, yields)
            t = select(yields, returned, t)
            history, opening, ratio = apply_return(yields, new_history, history, released, opening, ratio, settings)
        history = after_opening(history, opening, params)
        return t, J * ratio, opening, history, 0.5 * V0 * J * contract(add(s, t), e)

    return stress_update


@cache
def make_update_stress(dimension: int, law: ConstitutiveLaw, volumetric_strain: str) -> Callable[..., Any]:
    """The stress update of a range of points; volumetric_strain: see `Scheme`."""
    update_eight, size = _make_update_eight(dimension, law), RECORD_SIZE[dimension]
    volumetric_excess, averaged = make_volumetric_excess(dimension), volumetric_strain == "cell"
    plane = dimension == 2

    @subroutine
    @variant(dimension, law, volumetric_strain)
    def update_stress(rows, cells, first, stop, params, settings, box, c2, dt, averages, side_rate):
        """Returns the stress work (J), the largest c_p + |v_p| (m/s), the row of the first invalid point, and the
        energies that the stress filter and the side walls take (J). averages: of the filtered stress at the points, Pa.
        side_rate: that of `slow_points`, s/m; 0 without friction of side walls.
        """
        work, speed, lost, side, fault = splat(0.0), splat(0.0), splat(0.0), splat(0.0), NO_FAULT
        if averaged:
            excesses = np.empty(stop - first + LANES)
            volumetric_excess(rows, cells, first, stop, excesses)
        for p in range(first, stop, LANES):
            count = min(stop - p, LANES)
            exists = float(count) - vector(0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5)
            excess = load(excesses, p - first) if averaged else 0.0
            work_p, speed_p, valid, lost_p, side_p = update_eight(
                rows, p * size, count, params, settings, box, c2, dt, excess, load(averages, p - first), side_rate
            )
            work = work + where_positive(exists, work_p, 0.0)
            lost = lost + where_positive(exists, lost_p, 0.0)
            if plane:
                side = side + where_positive(exists, side_p, 0.0)
            speed = maximum(speed, where_positive(exists, speed_p, 0.0))
            invalid = where_positive(exists, 1.0 - valid, 0.0)
            if fault == NO_FAULT and any_positive(invalid):
                fault = p + _first_positive(invalid)
        return reduce_sum(work), reduce_max(speed), fault, reduce_sum(lost), reduce_sum(side)

    return update_stress


def _make_update_eight(dimension: int, law: ConstitutiveLaw) -> Callable[..., Any]:
    stress_update, tensors = make_stress_update(dimension, law), TENSORS[dimension]
    filter_stress = make_stress_filter(tensors, law)
    load_points, store_points = tensors.load_points, tensors.store_points
    subtract_diagonal, check_inside = tensors.subtract_diagonal, tensors.check_inside
    plane = dimension == 2

    @device
    @variant(dimension, law)
    def update_eight(rows, o, count, params, settings, box, c2, dt, excess, average, side_rate):
        """Update the stress of `count` <= 8 points, the first of whose records starts at `o`.

        excess: rate to subtract from the diagonal of the velocity gradient. average: of the filtered stress, Pa.
        Returns five vectors: stress work (J), wave speed plus speed (m/s), one for every point that is valid and inside
        the box, and the energies that the filter and the side walls take (J).
        """
        x, v2, V0, J, opening, history, s, L, labels = load_points(rows, o)
        rates, lost, side = subtract_diagonal(L, excess), splat(0.0), splat(0.0)
        if settings.filter_rate > 0.0:
            s, J, opening, lost = filter_stress(s, L, V0, J, opening, history, params, settings, dt, average)
        s, J, opening, history, work = stress_update(s, rates, V0, J, opening, history, params, settings, dt)
        if plane and side_rate > 0.0:
            side = slow_points(rows, o, count, J, s[ZZ], side_rate)
        store_points(rows, o, count, J, opening, history, s, L, labels)
        speed, valid = check_point(J, v2, c2, settings)
        return work, speed, check_inside(valid, x, box), lost, side

    return update_eight


@device
def _first_positive(value):
    """Index of the first lane above zero, as a real number."""
    index = vector(0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0)
    return -reduce_max(where_positive(value, -index, -float(LANES)))
