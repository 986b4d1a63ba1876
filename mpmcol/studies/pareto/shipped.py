"""The shipped study: costs and errors of its configurations, and which of its cases resemble a given case.

The table is `pareto.csv` as written by `mpmcol pareto default`, stored beside the definition of the study.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from math import hypot
from typing import Any, NamedTuple

from mpmcol.case import Case, conditions_of
from mpmcol.case.values import leaf_values
from mpmcol.errors import UsageError
from mpmcol.experiments import column_kind
from mpmcol.studies.pareto.score import BETA, ZETA
from mpmcol.studies.pareto.study import StudyDefinition, load_study, load_study_case, shipped_studies

STUDY = "default"
SAME_FRICTION = 2.0  # degrees within which friction angles count as equal
SAME_ASPECT = 1.1  # ratio within which aspect ratios count as equal
QUANTITIES = (ZETA, BETA)


@dataclass(frozen=True)
class ColumnParameters:
    """Parameters on which a collapse depends, apart from its scale."""

    kind: str  # see `column_kind`
    a: float
    friction_deg: float


class NeighbouringColumn(NamedTuple):
    """A column next to another one in aspect ratio and friction angle, whose errors follow from cases of the study.

    case: with its aspect ratio. friction, common: of another aspect ratio, with its friction angle and with that of
    `case`; the ratio of their errors is that between the friction angles. None if `case` itself is the column.
    """

    case: str
    friction: str | None = None
    common: str | None = None


@dataclass(frozen=True)
class ShippedConfiguration:
    """A configuration of the shipped study with its measured cost and errors."""

    case: str
    variant: str
    cells: float  # r_i / h
    seconds_per_point_step: float  # of one core
    bias: Mapping[str, float]  # error of the mean of its runs, by quantity, relative to the grid-converged value
    scatter: Mapping[str, float]  # relative standard deviation between neighbouring spacings, by quantity
    uncertainty: Mapping[str, float]  # relative standard error of the grid-converged value, by quantity
    bounds: Mapping[str, float] | None  # `ErrorBound` plus uncertainty of the reference; None: too few spacings


def parameters_of(case: Case) -> ColumnParameters:
    """Return the parameters of a case; a softening material counts with its residual friction.

    Raises UsageError for a material without friction, and for what no case of the study has.
    """
    geometry, friction = case.geometry, conditions_of(case).friction_deg
    if (reason := unstudied(case)) or friction is None:
        raise UsageError(f"{reason} only; set grid.spacing instead of an accuracy")
    return ColumnParameters(column_kind(geometry.model, geometry.column_section), geometry.a, friction)


def unstudied(case: Case) -> str:
    """For what else the errors were studied, if a case has something that no case of the study has; else ""."""
    geometry = case.geometry
    if conditions_of(case).friction_deg is None:
        angle = leaf_values(case).get("material.friction_deg")
        subject = f'material.law = "{case.material.law}"' if angle is None else f"material.friction_deg = {angle:g}"
        return f"{subject}: the errors were studied for materials with friction"
    if geometry.slope_deg:
        return f"geometry.slope_deg = {geometry.slope_deg:g}: the errors were studied on a horizontal base"
    if geometry.base == "granular":
        return 'geometry.base = "granular": the errors were studied on elastic and rigid bases'
    if case.walls:
        return "walls: the errors were studied for columns that spread freely"
    if case.layers:
        return "layers: the errors were studied for columns of one material"
    for name, value in case.friction:
        if value is not None:
            return (
                f"friction.{name} = {value:g}: the errors were studied without slip at the floor and with smooth walls"
            )
    return ""


@cache
def shipped_study() -> StudyDefinition:
    """Return the definition of the shipped study."""
    return load_study(STUDY)


@cache
def shipped_configurations() -> tuple[ShippedConfiguration, ...]:
    """Return the configurations of the shipped study that have errors."""
    return tuple(_configuration(row) for row in _rows() if row[f"{ZETA} bias"])


@cache
def converged_values() -> dict[str, dict[str, float]]:
    """Return the grid-converged value of each quantity, by case of the shipped study."""
    values = {row["case"]: {name: row[f"{name} reference"] for name in QUANTITIES} for row in _rows()}
    return {
        case: {name: float(text) for name, text in own.items()} for case, own in values.items() if all(own.values())
    }


def _rows() -> csv.DictReader[str]:
    path = shipped_studies()[STUDY].with_suffix(".csv")
    return csv.DictReader(path.read_text(encoding="utf-8").splitlines())


def neighbouring_cases(column: ColumnParameters) -> list[str]:
    """Return the cases of the study between which a column lies in friction angle and in aspect ratio.

    Not every combination of the two was studied. Therefore, for each neighbouring friction angle the cases with the
    neighbouring aspect ratios are taken, and for each neighbouring aspect ratio the case with the nearest friction
    angle.

    Raises UsageError if the study has no columns of this kind.
    """
    similar = similar_cases(column)
    chosen: dict[str, None] = {}
    for friction in _bracket({one.friction_deg for one in similar.values()}, column.friction_deg, SAME_FRICTION, 1.0):
        aspects_of = {name: one.a for name, one in similar.items() if one.friction_deg == friction}
        aspects = _bracket(set(aspects_of.values()), column.a, 0.0, SAME_ASPECT)
        chosen |= dict.fromkeys(name for name, a in aspects_of.items() if a in aspects)
    for aspect in _bracket({one.a for one in similar.values()}, column.a, 0.0, SAME_ASPECT):
        distances = {
            name: abs(one.friction_deg - column.friction_deg) for name, one in similar.items() if one.a == aspect
        }
        chosen |= dict.fromkeys([min(distances, key=lambda name: distances[name])])
    return list(chosen)


def neighbouring_columns(column: ColumnParameters) -> list[NeighbouringColumn]:
    """Return the columns between which a column lies: the neighbouring aspect ratios with the neighbouring frictions.

    Raises UsageError if the study has no columns of this kind.
    """
    similar = similar_cases(column)
    aspects = _bracket({one.a for one in similar.values()}, column.a, 0.0, SAME_ASPECT)
    frictions = _bracket({one.friction_deg for one in similar.values()}, column.friction_deg, SAME_FRICTION, 1.0)
    return [_neighbour(similar, a, friction) for a in aspects for friction in frictions]


def _neighbour(similar: Mapping[str, ColumnParameters], a: float, friction: float) -> NeighbouringColumn:
    names = {(one.a, one.friction_deg): name for name, one in similar.items()}
    if (a, friction) in names:
        return NeighbouringColumn(names[a, friction])
    here = min((one.friction_deg for one in similar.values() if one.a == a), key=lambda own: abs(own - friction))
    both = [own for own, other in names if other == friction and (own, here) in names]
    if not both:
        return NeighbouringColumn(names[a, here])
    nearest = min(both, key=lambda own: abs(own - a))
    return NeighbouringColumn(names[a, here], names[nearest, friction], names[nearest, here])


def similar_cases(column: ColumnParameters) -> dict[str, ColumnParameters]:
    """Return the cases of the study with columns of the same kind; UsageError if there are none."""
    similar = {name: one for name, one in study_columns().items() if one.kind == column.kind}
    if not similar:
        raise UsageError(f"the shipped study has no {column.kind} columns; set grid.spacing instead of an accuracy")
    return similar


@cache
def study_columns() -> dict[str, ColumnParameters]:
    """Return the columns of the shipped study, by case."""
    return {name: parameters_of(study_case(name)) for name in shipped_study().cases}


@cache
def study_case(name: str, variant: str | None = None) -> Case:
    """Load a case of the shipped study, with a scheme variant if one is given."""
    study = shipped_study()
    return load_study_case(study.cases[name], study.variants[variant] if variant else None)


def _bracket(values: Iterable[float], x: float, near: float, ratio: float) -> list[float]:
    """Return the value that counts as equal to x, or else the next ones below and above it."""
    close = [value for value in values if abs(value - x) <= near or 1.0 / ratio <= value / x <= ratio]
    if close:
        return [min(close, key=lambda value: abs(value - x))]
    below, above = [v for v in values if v < x], [v for v in values if v > x]
    return [*([max(below)] if below else []), *([min(above)] if above else [])]


def _configuration(row: Mapping[str, Any]) -> ShippedConfiguration:
    return ShippedConfiguration(
        case=row["case"],
        variant=row["variant"],
        cells=float(row["cells"]),
        seconds_per_point_step=float(row["core_seconds"]) / float(row["point_steps"]),
        bias={quantity: float(row[f"{quantity} bias"]) for quantity in QUANTITIES},
        scatter={quantity: float(row[f"{quantity} scatter"]) for quantity in QUANTITIES},
        uncertainty={quantity: float(row[f"{quantity} reference uncertainty"]) for quantity in QUANTITIES},
        bounds={quantity: _bound(row, quantity) for quantity in QUANTITIES} if row[f"{ZETA} bound"] else None,
    )


def _bound(row: Mapping[str, Any], quantity: str) -> float:
    return hypot(float(row[f"{quantity} bound"]), float(row[f"{quantity} reference uncertainty"]))
