"""Parameters of materials that are known to be unfit; the checks are entries of `unfit_settings.CHECKS`.

Each gives the note of the first material of the case to which it applies.
"""

from __future__ import annotations

from collections.abc import Iterator

from mpmcol.case import Case
from mpmcol.mpm.constitutive import mu_i
from mpmcol.units import length_text


def _with_rate(case: Case) -> Iterator[tuple[str, mu_i.Material]]:
    """Key and material of column, base and layers with the mu(I) law."""
    layers = {f"layers.{k}.material": layer.material for k, layer in enumerate(case.layers)}
    for key, material in {"material": case.material, "base_material": case.base_material, **layers}.items():
        if isinstance(material, mu_i.Material):
            yield key, material


def constant_friction(case: Case, h: float) -> str | None:
    """The mu(I) law does not depend on the rate."""
    for key, material in _with_rate(case):
        if material.mu_2 <= material.mu_s:
            return (
                f"{key}.mu_2 = mu_s = {material.mu_s:.4g}: friction does not depend on the rate, and the law is "
                'drucker-prager with match = "tangent"; set a larger mu_2'
            )
    return None


def large_grains(case: Case, h: float) -> str | None:
    """A continuum needs several grains in a cell."""
    for key, material in _with_rate(case):
        if material.grain_diameter > h:
            return (
                f"{key}.grain_diameter = {length_text(material.grain_diameter)} is larger than a cell of "
                f"{length_text(h)}: the grid resolves less than a grain; use a larger grid.spacing"
            )
    return None


def light_grains(case: Case, h: float) -> str | None:
    """The density of grains was mistaken for that of the bulk material."""
    for key, material in _with_rate(case):
        if material.grain_density <= material.density:
            return (
                f"{key}.density = {material.density:g} kg/m3 is that of the material with its pores, but the grains "
                f"have grain_density = {material.grain_density:g} kg/m3; set a density of about 0.6 grain_density"
            )
    return None
