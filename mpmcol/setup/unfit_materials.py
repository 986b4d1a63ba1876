"""Parameters of materials that are known to be unfit; the checks are entries of `unfit_settings.CHECKS`.

Each gives the note of the first material of the case to which it applies.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import degrees, pi, radians, sqrt, tan
from typing import TypeVar

from mpmcol.case import Case
from mpmcol.case.materials import Material
from mpmcol.mpm.constitutive import mohr_coulomb, mohr_coulomb_random, mu_i
from mpmcol.mpm.constitutive.elastic import Elasticity
from mpmcol.units import length_text

Law = TypeVar("Law", bound=Elasticity)
RIGHT_ANGLE = pi / 2.0
FEWEST_CELLS, LONGEST = 4.0, 10.0  # correlation lengths: in cells, and over the size of the column
LEAST_DENSITY = 23.0  # kg/m3; a smaller number is a density in g/cm3, of which no element has more than 22.6
MOST_DILATANCY = 5.0  # degrees, constant during the flow
# height with which a vertical cut stands, rho g H / (c tan(45 deg + phi/2)): without horizontal stress, for which it
# needs no tensile strength, by the lower bound theorem; with one of c cot(phi), nine tenths of the height of the slip
# circle, 3.83
STANDING, STANDING_WITH_TENSION = 2.0, 0.9 * 3.83


def _materials(case: Case) -> Iterator[tuple[str, Material]]:
    """Key and material of column, base and layers."""
    keys = ("material", "base_material", *(f"layers.{k}.material" for k in range(len(case.layers))))
    yield from zip(keys, case.materials, strict=True)


def _of_law(case: Case, kind: type[Law]) -> Iterator[tuple[str, Law]]:
    """Key and material of column, base and layers that have this law."""
    for key, material in _materials(case):
        if isinstance(material, kind):
            yield key, material


def constant_friction(case: Case, h: float) -> str | None:
    """The mu(I) law does not depend on the rate."""
    for key, material in _of_law(case, mu_i.Material):
        if material.mu_2 <= material.mu_s:
            return (
                f"{key}.mu_2 = mu_s = {material.mu_s:.4g}: friction does not depend on the rate, and the law is "
                'drucker-prager with match = "tangent"; set a larger mu_2'
            )
    return None


def large_grains(case: Case, h: float) -> str | None:
    """A continuum needs several grains in a cell."""
    for key, material in _of_law(case, mu_i.Material):
        if material.grain_diameter > h:
            return (
                f"{key}.grain_diameter = {length_text(material.grain_diameter)} is larger than a cell of "
                f"{length_text(h)}: the grid resolves less than a grain; use a larger grid.spacing"
            )
    return None


def light_grains(case: Case, h: float) -> str | None:
    """The density of grains was mistaken for that of the bulk material."""
    for key, material in _of_law(case, mu_i.Material):
        if material.grain_density <= material.density:
            return (
                f"{key}.density = {material.density:g} kg/m3 is that of the material with its pores, but the grains "
                f"have grain_density = {material.grain_density:g} kg/m3; set a density of about 0.6 grain_density"
            )
    return None


def short_correlation(case: Case, h: float) -> str | None:
    """Variation within a few cells has no effect of its own: the grid smooths it."""
    for key, material in _of_law(case, mohr_coulomb_random.Material):
        name, length = min(material.correlation_lengths.items(), key=lambda one: one[1])
        if length < FEWEST_CELLS * h:
            return (
                f"{key}.{name} = {length_text(length)} is only {length / h:.2g} cells, and the grid does not resolve "
                f"the field; set grid.spacing = {length_text(length / FEWEST_CELLS)} or less"
            )
    return None


def long_correlation(case: Case, h: float) -> str | None:
    """A field that hardly varies within the column, often a length in another unit."""
    size = max(case.geometry.r_i, case.geometry.h_i)
    for key, material in _of_law(case, mohr_coulomb_random.Material):
        name, length = min(material.correlation_lengths.items(), key=lambda one: one[1])
        if length > LONGEST * size:
            return (
                f"{key}.{name} = {length:g} m is much longer than the column: the friction hardly varies within it; "
                f'if it is in mm, set "{length:g} mm"'
            )
    return None


def field_of_rings(case: Case, h: float) -> str | None:
    """A field in the plane of r and y."""
    fields = [key for key, _ in _of_law(case, mohr_coulomb_random.Material)]
    if not fields or case.geometry.model != "axisymmetric":
        return None
    return (
        f'{fields[0]}: with geometry.model = "axisymmetric" the friction is the same all around the axis; for a field '
        'that varies in all directions, set geometry.model = "full"'
    )


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
    """Keys of the angles of the material that begin with `prefix`, and their values in degrees."""
    return ((name, value) for name, value in case.material if name.startswith(prefix) and name.endswith("_deg"))


def standing_column(case: Case, h: float) -> str | None:
    """The cohesion of a column of Mohr-Coulomb on a horizontal base carries it without a gate."""
    material, geometry = case.material, case.geometry
    if not isinstance(material, mohr_coulomb.Material) or not _is_plain(case) or material.cohesion == 0.0:
        return None
    factor = STANDING_WITH_TENSION if geometry.model == "plane" and _has_full_tension(material) else STANDING
    passive = tan(radians(45.0 + 0.5 * material.friction_deg))
    standing = factor * material.cohesion / (material.density * geometry.gravity) * passive
    if geometry.h_i > standing:
        return None
    return (
        f"material.cohesion = {material.cohesion:g} Pa: the column does not collapse, since a vertical cut of this "
        f"material stands up to at least {standing:.3g} m; set less than "
        f"{material.cohesion * geometry.h_i / standing / 2.0:.2g} Pa, or a higher column"
    )


def _is_plain(case: Case) -> bool:
    """Whether the column is one vertical cut of one material on a base that carries it."""
    geometry = case.geometry
    return geometry.is_rectangle and geometry.slope_deg == 0.0 and geometry.base != "granular" and not case.layers


def _has_full_tension(material: mohr_coulomb.Material) -> bool:
    """Whether the tensile strength is that of the cone's apex, c cot(phi), which is its default."""
    return material.tension is None or material.tension >= 0.99 * material.apex
