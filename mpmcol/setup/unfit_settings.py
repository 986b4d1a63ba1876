"""Settings that are known to be unfit: independent checks of a case, and the refusal of columns that are too soft.

A new check is a function and an entry of CHECKS. Its warning is one line that begins with the key: value, effect, and
what to set instead. Effects are those of runs at r_i / h = 14, relative to the same column with the better setting.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from itertools import pairwise
from math import atan, ceil, degrees, inf, pi, radians, sin, sqrt
from typing import Any

from mpmcol.case import Case
from mpmcol.case.geometry import GeometryTable, whole_cells
from mpmcol.case.slope import ENDLESS_REMEDY, endless_flow
from mpmcol.errors import UsageError
from mpmcol.setup.domain import LEAST_CELLS, default_length, expected_front, usable
from mpmcol.setup.shortening import Shortening, shortenings
from mpmcol.setup.time_step import time_step_warnings
from mpmcol.setup.unfit_materials import constant_friction, large_grains, light_grains
from mpmcol.units import counted

FEWEST_CELLS = 6  # in height and radius of a column
FEWEST_BED_CELLS = 4
FEWEST_LAYER_CELLS = 2
GATE_CELLS = 2
RIGHT_ANGLE = pi / 2.0
LEAST_DENSITY = 23.0  # kg/m3; a smaller number is a density in g/cm3, of which no element has more than 22.6
MOST_DILATANCY = 5.0  # degrees, constant during the flow
SMALL_SHORTENING, LARGE_SHORTENING, MOST_SHORTENING = 0.001, 0.01, 1.0 / 3.0  # elastic, by the column's own weight


def setting_warnings(case: Case, h: float) -> list[str]:
    """Warnings about the settings of a case, one line each; h: node spacing used, m."""
    found = [check(case, h) for check in CHECKS]
    return [*filter(None, found), *time_step_warnings(case)]


def kind_of(warning: str) -> str:
    """The text of a warning without its numbers, which is the same for several cases."""
    return re.sub(r"[-+]?\d[\d.]*(e[-+]?\d+)?", "", warning)


def require_stiff_column(case: Case) -> None:
    """Raise UsageError if the column is so soft that its own weight makes a different column of it."""
    for softness in shortenings(case):
        if softness.relative > MOST_SHORTENING:
            raise UsageError(f"{softness}, more than a third; {_stiffer(softness)}")


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


def thin_layer(case: Case, h: float) -> str | None:
    """Points of a thin layer have the strain rates of the material beside it."""
    for number, layer in enumerate(case.layers):
        thickness = layer.to - layer.from_
        if thickness < (FEWEST_LAYER_CELLS - 0.01) * h:
            return (
                f"layers.{number}: the layer of {thickness:g} m has only {thickness / h:.2g} cells, and moves with the "
                "material beside it: a weaker layer does not slide; set grid.spacing = "
                f"{thickness / FEWEST_LAYER_CELLS:.4g} m or less"
            )
    return None


def rigid_floor_without_reaction(case: Case, h: float) -> str | None:
    """Points next to the floor keep their velocity, although the nodes of the floor are held."""
    base = case.geometry.base
    if base == "elastic" or case.method.wall_impulse:
        return None
    return (
        f'method.wall_impulse = false with geometry.base = "{base}": points slide over the floor, and runouts become '
        "wrong by up to 7 % by front_height and 76 % by front_max; set method.wall_impulse = true"
    )


def rough_floor(case: Case, h: float) -> str | None:
    """The column yields before it slides on the floor; Mohr-Coulomb without dilatancy mobilises sin(phi) in shear."""
    floor, (mobilised, text) = case.friction.floor, _shear_strength(case)
    if floor is None or mobilised == 0.0 or floor < mobilised:
        return None
    return (
        f"friction.floor = {floor:.4g} ({degrees(atan(floor)):.3g} degrees): the column shears at {text} of the "
        "pressure before it slides, nearly as on a floor without slip, with runouts up to 10 % longer; set less than "
        f"{mobilised:.3g}, or omit it"
    )


def rough_wall(case: Case, h: float) -> str | None:
    """The same on the faces of walls, where it has no other effect than the smallest such friction."""
    mobilised, text = _shear_strength(case)
    for wall in case.walls:
        if wall.friction >= mobilised > 0.0:
            return (
                f"walls: friction = {wall.friction:.4g} of {wall.name}: the material shears at {text} of the pressure "
                f"before it slides, as on a rough wall; set less than {mobilised:.3g}"
            )
    return None


def _shear_strength(case: Case) -> tuple[float, str]:
    """Largest ratio of shear to normal stress of the column without cohesion, and its text; inf without a yield."""
    for name, ratio in _coefficients(case.material):
        return ratio, f"{name} = {ratio:.3g}"
    return inf, ""


def _coefficients(material: Any) -> Iterator[tuple[str, float]]:
    """The largest friction coefficient of a law and its name; nothing for a law without friction."""
    if hasattr(material, "mu_2"):
        yield "mu_2", material.mu_2
    elif hasattr(material, "match"):  # Drucker-Prager, with the coefficient that its angle is matched to
        yield "mu", material.mobilised_friction
    elif angles := [value for name, value in material if name.startswith("friction_")]:
        yield f"sin({max(angles):g} degrees)", sin(radians(max(angles)))


def wall_at_gate(case: Case, h: float) -> str | None:
    """Nodes within two cells of the column receive the pressure on the gate."""
    for wall in case.walls:
        if case.stages.gate and (gap := wall.from_ - case.geometry.r_i) < GATE_CELLS * h and wall.from_ > 0.0:
            return (
                f"walls: from = {wall.from_:g} m of {wall.name} is {max(gap, 0.0) / h:.2g} cells from the column: "
                "before the release it carries a part of the force on the gate; set "
                f"{case.geometry.r_i + GATE_CELLS * h:.4g} m or more, or stages.gate = false"
            )
    return None


def wall_out_of_reach(case: Case, h: float) -> str | None:
    """The flow ends before a wall beyond the longest runout among the experiments."""
    for wall in case.walls:
        if min(abs(wall.from_), abs(wall.to or wall.from_)) > (front := expected_front(case)):
            return (
                f"walls: from = {wall.from_:g} m of {wall.name} is beyond the expected front at {front:.4g} m, and the "
                f"flow may not reach it; set less than {front:.4g} m"
            )
    return None


def friction_in_radians(case: Case, h: float) -> str | None:
    """Granular material has friction angles above 1.6 degrees, a right angle in radians."""
    for name, angle in _angles(case, "friction_"):
        if 0.0 < angle < RIGHT_ANGLE:  # 0: undrained clay
            return (
                f"material.{name} = {angle:g} is an angle in degrees, with which the material has almost no strength; "
                f'if it is in radians, set "{angle:g} rad" ({degrees(angle):.3g} degrees)'
            )
    return None


def density_in_grams(case: Case, h: float) -> str | None:
    """Time steps are proportional to the square root of the density."""
    density = case.material.density
    if density >= LEAST_DENSITY:
        return None
    return (
        f"material.density = {density:g} kg/m3 is less than that of any granular material; if it is in g/cm3, set "
        f'"{density:g} g/cm3", with {sqrt(1e3):.0f} times fewer steps'
    )


def endless_dilatancy(case: Case, h: float) -> str | None:
    """Sand dilates to a critical state; a constant angle of dilatancy has no such end."""
    for name, angle in _angles(case, "dilatancy_"):
        if angle > MOST_DILATANCY and "peak" not in name:
            return (
                f"material.{name} = {angle:g}: the material dilates as long as it flows; at 10 degrees deposits have "
                f'6 to 18 % more volume; set material.{name} = 0, or use material.law = "mohr-coulomb-softening", '
                "whose dilatancy decays from dilatancy_peak_deg to dilatancy_residual_deg"
            )
    return None


def _angles(case: Case, prefix: str) -> Iterator[tuple[str, float]]:
    """Keys of the material that begin with `prefix`, and their values in degrees."""
    return ((name, value) for name, value in case.material if name.startswith(prefix))


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
    thin_layer,
    rigid_floor_without_reaction,
    rough_floor,
    rough_wall,
    wall_at_gate,
    wall_out_of_reach,
    friction_in_radians,
    density_in_grams,
    endless_dilatancy,
    soft_column,
    short_domain,
    slope_without_rest,
    flow_before_release,
    constant_friction,
    large_grains,
    light_grains,
)
