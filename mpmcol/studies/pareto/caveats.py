"""Where a case is unlike the columns of the shipped study, so that the errors found there may not hold for it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from mpmcol.case import Case
from mpmcol.case.fields import shown
from mpmcol.case.schema import leaf_values
from mpmcol.studies.pareto.configurations import load_scene
from mpmcol.studies.pareto.shipped import NEAR_ASPECT, NEAR_FRICTION, place_of, places_alike, shipped_study

COMPARED = ("method.", "time.", "stages.", "material.")
# What the study varies, what follows from that, and what only scales a collapse of dry sand.
STUDIED = {"material.friction_deg", "material.youngs_modulus", "stages.k0", "material.density"}


def unlike(case: Case, family: str, scenes: Sequence[str]) -> list[str]:
    """What of a case, with the choices of `family`, the study's `scenes` around it have otherwise, in a line each."""
    study = shipped_study()
    here, there = _compared(case), _compared(load_scene(study.scenes[scenes[0]], study.families[family]))
    others = (key for key in here if key in there and here[key] != there[key])
    return [*_beyond(case), *(f"{key} = {shown(here[key])} here, {shown(there[key])} in the study" for key in others)]


def _compared(case: Case) -> Mapping[str, Any]:
    values = leaf_values(case)
    return {key: value for key, value in values.items() if key.startswith(COMPARED) and key not in STUDIED}


def _beyond(case: Case) -> Iterator[str]:
    place = place_of(case)
    alike = places_alike(place).values()
    for name, x, known, slack, ratio in (
        ("a", place.a, [other.a for other in alike], 0.0, NEAR_ASPECT),
        ("friction", place.friction_deg, [other.friction_deg for other in alike], NEAR_FRICTION, 1.0),
    ):
        if not min(known) / ratio - slack <= x <= max(known) * ratio + slack:
            yield f"{name} = {x:.3g} here, {min(known):g} to {max(known):g} in the study"
