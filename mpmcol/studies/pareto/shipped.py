"""The shipped study as the rest of the program uses it: what its settings cost, and the errors they were found to have.

The table is the `pareto.csv` of `mpmcol pareto default`, kept beside the study's file.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from math import hypot
from typing import Any

from mpmcol.case import Case
from mpmcol.errors import UsageError
from mpmcol.experiments import column_kind
from mpmcol.studies.pareto.configurations import load_scene
from mpmcol.studies.pareto.score import BETA, ZETA
from mpmcol.studies.pareto.study import Study, load_study, shipped_studies

STUDY = "default"
NEAR_FRICTION = 2.0  # degrees
NEAR_ASPECT = 1.1  # ratio
QUANTITIES = (ZETA, BETA)


@dataclass(frozen=True)
class Place:
    """Where a column stands among others."""

    kind: str  # see `column_kind`
    a: float
    friction_deg: float


@dataclass(frozen=True)
class Row:
    """A setting of the shipped study in one scene."""

    scene: str
    family: str
    cells: float  # r_i / h
    seconds_per_point_step: float  # of a core
    bias: Mapping[str, float]  # error of the mean of its runs, by quantity, relative to the converged value
    within: Mapping[str, float] | None  # error kept here and finer, with the limit's own; None: too few spacings


def place_of(case: Case) -> Place:
    """A case among the columns of the study; softening material stands where its weakest friction is."""
    geometry, material = case.geometry, case.material
    friction = getattr(material, "friction_deg", None) or getattr(material, "friction_residual_deg", None)
    if friction is None:
        raise UsageError(f"material.law = {material.law}: the study of errors is of material with friction")
    return Place(column_kind(geometry.model, geometry.section), geometry.a, friction)


@cache
def shipped_study() -> Study:
    """The study that the shipped table is of."""
    return load_study(STUDY)


@cache
def shipped_rows() -> tuple[Row, ...]:
    """The rows of the shipped table that have errors."""
    path = shipped_studies()[STUDY].with_suffix(".csv")
    rows = csv.DictReader(path.read_text(encoding="utf-8").splitlines())
    return tuple(_row(row) for row in rows if row[f"{ZETA} bias"])


def scenes_around(place: Place) -> list[str]:
    """The study's scenes between which a column lies, in friction and in aspect ratio.

    Of every friction next to its own the scenes next in aspect ratio, and of every aspect ratio next to its own those
    next in friction: not every pair of the two was studied. Raises UsageError if there are no columns of this kind.
    """
    alike = places_alike(place)
    chosen: dict[str, None] = {}
    for friction in _bracket({other.friction_deg for other in alike.values()}, place.friction_deg, NEAR_FRICTION, 1.0):
        group = {name: other.a for name, other in alike.items() if other.friction_deg == friction}
        aspects = _bracket(set(group.values()), place.a, 0.0, NEAR_ASPECT)
        chosen |= dict.fromkeys(name for name, a in group.items() if a in aspects)
    for aspect in _bracket({other.a for other in alike.values()}, place.a, 0.0, NEAR_ASPECT):
        group = {name: other.friction_deg for name, other in alike.items() if other.a == aspect}
        chosen |= dict.fromkeys([min(group, key=lambda name: abs(group[name] - place.friction_deg))])
    return list(chosen)


def places_alike(place: Place) -> dict[str, Place]:
    """The study's scenes with columns of the same kind, and where they stand; UsageError if there are none."""
    places = {name: place_of(scene_case(name)) for name in shipped_study().scenes}
    alike = {name: other for name, other in places.items() if other.kind == place.kind}
    if not alike:
        raise UsageError(f"the study of errors has no {place.kind} columns; give grid.spacing yourself")
    return alike


@cache
def scene_case(name: str) -> Case:
    """The case of a scene of the shipped study."""
    return load_scene(shipped_study().scenes[name])


def _bracket(values: Iterable[float], x: float, near: float, ratio: float) -> list[float]:
    """The value that is as good as x, or those next below and above it."""
    close = [value for value in values if abs(value - x) <= near or 1.0 / ratio <= value / x <= ratio]
    if close:
        return [min(close, key=lambda value: abs(value - x))]
    below, above = [v for v in values if v < x], [v for v in values if v > x]
    return [*([max(below)] if below else []), *([min(above)] if above else [])]


def _row(row: Mapping[str, Any]) -> Row:
    return Row(
        scene=row["scene"],
        family=row["family"],
        cells=float(row["cells"]),
        seconds_per_point_step=float(row["core_seconds"]) / float(row["point_steps"]),
        bias={quantity: float(row[f"{quantity} bias"]) for quantity in QUANTITIES},
        within={quantity: _within(row, quantity) for quantity in QUANTITIES} if row[f"{ZETA} kept"] else None,
    )


def _within(row: Mapping[str, Any], quantity: str) -> float:
    return hypot(float(row[f"{quantity} kept"]), float(row[f"{quantity} reference +-"]))
