"""Parameters of materials that are known to be unfit; the checks are entries of `unfit_settings.CHECKS`."""

from __future__ import annotations

from mpmcol.case import Case
from mpmcol.mpm.constitutive import mu_i
from mpmcol.units import length_text


def constant_friction(case: Case, h: float) -> str | None:
    """The mu(I) law does not depend on the rate."""
    material = case.material
    if not isinstance(material, mu_i.Material) or material.mu_2 > material.mu_s:
        return None
    return (
        f"material.mu_2 = mu_s = {material.mu_s:.4g}: friction does not depend on the rate, and the law is "
        'drucker-prager with match = "tangent"; set a larger mu_2'
    )


def large_grains(case: Case, h: float) -> str | None:
    """A continuum needs several grains in a cell."""
    material = case.material
    if not isinstance(material, mu_i.Material) or material.grain_diameter <= h:
        return None
    return (
        f"material.grain_diameter = {length_text(material.grain_diameter)} is larger than a cell of {length_text(h)}: "
        "the grid resolves less than a grain; use a larger grid.spacing"
    )


def light_grains(case: Case, h: float) -> str | None:
    """The density of grains was mistaken for that of the bulk material."""
    material = case.material
    if not isinstance(material, mu_i.Material) or material.grain_density > material.density:
        return None
    return (
        f"material.density = {material.density:g} kg/m3 is that of the material with its pores, but the grains have "
        f"grain_density = {material.grain_density:g} kg/m3; set a density of about 0.6 grain_density"
    )
