"""Settings that are known to be unfit: independent checks of a case, and the refusal of columns that are too soft.

A new check is a function and an entry of CHECKS. Its warning is one line that begins with the key: value, effect, and
what to set instead. Effects are those of runs at r_i / h = 14, relative to the same column with the better setting.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from itertools import pairwise
from math import ceil

from mpmcol.case import Case
from mpmcol.case.geometry import GeometryTable, whole_cells
from mpmcol.case.slope import ENDLESS_REMEDY, endless_flow
from mpmcol.errors import UnfitCase
from mpmcol.setup.domain import LEAST_CELLS, default_length, expected_front, usable
from mpmcol.setup.shortening import Shortening, shortenings
from mpmcol.setup.time_step import time_step_warnings
from mpmcol.setup.unfit_duration import large_damping, late_times, many_steps, short_collapse
from mpmcol.setup.unfit_layers import layer_above_column, layer_without_effect, thin_layer
from mpmcol.setup.unfit_materials import (
    constant_friction,
    density_in_grams,
    endless_dilatancy,
    field_of_rings,
    friction_in_radians,
    large_grains,
    light_grains,
    long_correlation,
    short_correlation,
    standing_column,
)
from mpmcol.setup.unfit_walls import rough_floor, rough_wall, wall_at_gate, wall_out_of_reach
from mpmcol.units import counted

FEWEST_CELLS = 6  # in height and radius of a column
FEWEST_BED_CELLS = 4
THICKEST_BASE = 3.0  # over the larger of height and radius
LEAST_GRAVITY, MOST_GRAVITY = 0.5, 500.0  # m/s2: from small moons to centrifuges
EARTH = 9.81  # m/s2
SMALL_SHORTENING, LARGE_SHORTENING, MOST_SHORTENING = 0.001, 0.01, 1.0 / 3.0  # elastic, by the column's own weight


def setting_warnings(case: Case, h: float) -> list[str]:
    """Warnings about the settings of a case, one line each; h: node spacing used, m."""
    found = [check(case, h) for check in CHECKS]
    return [*filter(None, found), *time_step_warnings(case)]


def kind_of(warning: str) -> str:
    """The text of a warning without its numbers, which is the same for several cases."""
    return re.sub(r"[-+]?\d[\d.]*(e[-+]?\d+)?", "", warning)


def require_stiff_column(case: Case) -> None:
    """Raise UnfitCase if the column is so soft that its own weight makes a different column of it."""
    for softness in shortenings(case):
        if softness.relative > MOST_SHORTENING:
            gravity, message = unusual_gravity(case), f"{softness}, more than a third"
            key = "geometry.gravity" if gravity else f"{softness.key}.youngs_modulus"
            raise UnfitCase(key, "; ".join(filter(None, (gravity, message))), _stiffer(softness))


def unusual_gravity(case: Case, h: float = 0.0) -> str | None:
    """g in another unit."""
    gravity = case.geometry.gravity
    if LEAST_GRAVITY <= gravity <= MOST_GRAVITY:
        return None
    return (
        f"geometry.gravity = {gravity:g} m/s2 is {gravity / EARTH:.3g} times that of the Earth; set {EARTH} m/s2, "
        "unless the column is in a centrifuge or on a small body"
    )


def soft_column(case: Case, h: float) -> str | None:
    """The column is lower at its release than the case states, and so is its deposit."""
    for softness in shortenings(case):
        if softness.relative >= LARGE_SHORTENING:
            return f"{softness}, and the deposit is lower by as much; {_stiffer(softness)}"
    return None


def _stiffer(softness: Shortening) -> str:
    """A stiffness with which the column hardly shortens, and the units to check."""
    modulus = float(f"{softness.modulus * softness.relative / SMALL_SHORTENING:.1e}")
    return f"set {modulus:g} Pa or more, and check that lengths are in m, the density in kg/m3 and the modulus in Pa"


def one_point_per_cell(case: Case, h: float) -> str | None:
    """Cells become empty where the flow stretches the material."""
    if case.grid.points_per_cell > 1:
        return None
    better = "4, 9 or 16" if case.geometry.dimension == 2 else "8 or 27"
    return (
        "grid.points_per_cell = 1: too few where the flow stretches the material; deposits are 2 to 24 % too low, and "
        f"runouts differ by -33 to +13 %; set {better}"
    )


def few_cells(case: Case, h: float) -> str | None:
    """The front is where the deposit becomes thinner than a cell."""
    geometry = case.geometry
    lengths = {"radius": geometry.r_i, "height": geometry.h_i, "half-depth": geometry.depth or geometry.r_i}
    name = min(lengths, key=lambda name: lengths[name])
    if lengths[name] > (FEWEST_CELLS - 0.01) * h:
        return None
    fine = geometry.r_i / ceil(FEWEST_CELLS * geometry.r_i / lengths[name] - 0.01)  # whole cells in the radius
    return (
        f"grid.spacing = {h:.4g} m: the {name} of the column has only {lengths[name] / h:.2g} cells; with 5 cells "
        f"runouts are 14 to 47 % shorter than with 14, with 2 cells 36 to 100 %; set {fine:.4g} m or less"
    )


def thin_bed(case: Case, h: float) -> str | None:
    """Shape functions smear the surface of the bed and the floor below it over two cells each."""
    thickness = case.geometry.base_thickness
    cells = whole_cells(thickness, h)
    if case.geometry.base != "granular" or cells >= FEWEST_BED_CELLS:
        return None
    return (
        f"geometry.base_thickness = {thickness:g} m: the granular bed has only {counted(cells, 'cell')}, and the "
        f"floor below it acts on the flow; set grid.spacing = {thickness / FEWEST_BED_CELLS:.4g} m or less"
    )


def thick_base(case: Case, h: float) -> str | None:
    """A length in mm; the flow does not depend on what is deep below it."""
    geometry, thickness = case.geometry, case.geometry.base_thickness
    size = max(geometry.h_i, geometry.r_i)
    if geometry.base == "rigid" or thickness <= THICKEST_BASE * size:
        return None
    return (
        f"geometry.base_thickness = {thickness:g} m is {thickness / size:.3g} times the size of the column, and takes "
        f'memory and time; set about {0.2 * size:.2g} m, or, if it is in mm, "{thickness:g} mm"'
    )


def rigid_floor_without_reaction(case: Case, h: float) -> str | None:
    """Points next to the floor keep their velocity, although the nodes of the floor are held."""
    base = case.geometry.base
    if base == "elastic" or case.method.wall_impulse:
        return None
    return (
        f'method.wall_impulse = false with geometry.base = "{base}": points slide over the floor, and runouts become '
        "wrong by up to 7 % by front_height and 76 % by front_max; set method.wall_impulse = true"
    )


def flow_before_release(case: Case, h: float) -> str | None:
    """In the first stage, a slope of the material's own law is held by a gate that it leans on, or by nothing."""
    stages, geometry = case.stages, case.geometry
    if stages.equilibrate.law == "elastic" or (stages.gate and _leans_on_gate(geometry)):
        return None
    law = stages.equilibrate.law
    key = f'stages.equilibrate.law = "{law}" without a gate' if not stages.gate else "stages.gate = true"
    remedy = "stages.gate = false" if stages.gate else 'stages.equilibrate.law = "elastic"'
    return (
        f"{key}: nothing holds the slope in the first stage, whose law is {law}; if it is too steep, it fails before "
        f"the release (a heap of 40 degrees loses 23 % of its height); set {remedy}"
    )


def _leans_on_gate(geometry: GeometryTable) -> bool:
    """Whether a part of the surface is vertical at x = r_i, where the gate is."""
    outline, r_i = geometry.outline, geometry.r_i
    return outline is None or any(a[0] == b[0] == r_i for a, b in pairwise((*outline, outline[0])))


def short_domain(case: Case, h: float) -> str | None:
    """The flow reaches the cells at the end of the domain that arrest it."""
    length, front = case.geometry.domain_length, expected_front(case)
    if length is None or usable(length, h) >= front:
        return None
    return (
        f"geometry.domain_length = {length:g} m: its last {LEAST_CELLS} cells are not usable, so that "
        f"{usable(length, h):.4g} m are left, and the front is expected at up to {front:.4g} m; set "
        f"{default_length(case, h):.4g} m, or omit it"
    )


def slope_without_rest(case: Case, h: float) -> str | None:
    """The flow of a run that ends at rest has to stop."""
    cause = endless_flow(case)
    return f"{cause}; {ENDLESS_REMEDY}" if cause and case.stages.collapse.end == "rest" else None


CHECKS: tuple[Callable[[Case, float], str | None], ...] = (
    one_point_per_cell,
    few_cells,
    thin_bed,
    thick_base,
    thin_layer,
    layer_above_column,
    layer_without_effect,
    rigid_floor_without_reaction,
    rough_floor,
    rough_wall,
    wall_at_gate,
    wall_out_of_reach,
    friction_in_radians,
    density_in_grams,
    endless_dilatancy,
    unusual_gravity,
    soft_column,
    standing_column,
    short_domain,
    slope_without_rest,
    flow_before_release,
    constant_friction,
    large_grains,
    light_grains,
    short_correlation,
    long_correlation,
    field_of_rings,
    short_collapse,
    large_damping,
    late_times,
    many_steps,
)
