"""Elastic shortening of a column, its layers and a granular bed below it by their weight."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

from mpmcol.case import Case
from mpmcol.mpm.constitutive import elastic


class Shortening(NamedTuple):
    """Change of height over height of a part of the model, confined by its gate."""

    part: str  # "column" or "bed"
    relative: float
    key: str  # of the material that shortens most
    modulus: float  # Young's modulus of that material, Pa
    formula: str

    def __str__(self) -> str:
        height = "height" if self.part == "column" else "thickness"
        return (
            f"{self.key}.youngs_modulus = {self.modulus:g} Pa: the elastic shortening of the {self.part} under its own "
            f"weight{' and that of the column' if self.part == 'bed' else ''}, {self.formula}, is "
            f"{_share(self.relative)} its {height}"
        )


def _share(relative: float) -> str:
    """A part as a percentage, or as a multiple if it is large."""
    return f"{relative:.1%} of" if relative < 10.0 else f"{relative:.3g} times"


class _Stratum(NamedTuple):
    """A part of one material."""

    key: str
    height: float  # m
    material: elastic.Elasticity


def shortenings(case: Case) -> Iterator[Shortening]:
    """That of the column, and of a granular bed."""
    geometry, strata = case.geometry, list(_strata(case))
    formula = "rho g h_i / (2 E_oed)" if len(strata) == 1 else "the sum over its layers"
    yield _shortening("column", strata, 0.0, geometry.normal_gravity, formula)
    if geometry.base == "granular":
        bed = _Stratum("base_material", geometry.base_thickness, case.base_material)
        load = sum(stratum.height * stratum.material.density for stratum in strata)
        yield _shortening("bed", [bed], load, geometry.normal_gravity, "(rho_column h_i + rho b / 2) g / E_oed")


def elastic_shortening(case: Case) -> float:
    """The largest of them."""
    return max(each.relative for each in shortenings(case))


def _strata(case: Case) -> Iterator[_Stratum]:
    """Parts of the column from its top to its base."""
    h_i = case.geometry.h_i
    ends = {0.0, h_i, *(min(end, h_i) for layer in case.layers for end in (layer.from_, layer.to))}
    for upper, lower in pairwise(sorted(ends, reverse=True)):
        middle, key, material = 0.5 * (lower + upper), "material", case.material
        for number, layer in enumerate(case.layers):
            if layer.from_ <= middle < layer.to:
                key, material = f"layers.{number}.material", layer.material
        yield _Stratum(key, upper - lower, material)


def _shortening(part: str, strata: list[_Stratum], load: float, gravity: float, formula: str) -> Shortening:
    """That of strata from top to bottom under a load of kg/m2: the sum of dz g (load above) / E_oed."""
    lost = []
    for _, height, material in strata:
        oedometric = material.density * material.wave_speed**2
        lost.append(gravity * height * (load + 0.5 * material.density * height) / oedometric)
        load += material.density * height
    softest = strata[lost.index(max(lost))]
    total = sum(lost) / sum(stratum.height for stratum in strata)
    return Shortening(part, total, softest.key, softest.material.youngs_modulus, formula)
