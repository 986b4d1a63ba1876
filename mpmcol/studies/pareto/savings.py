"""Changes that make a case cheaper: the saving of each alone, and its effect on runout and height in the study."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median_high

from mpmcol.case import Case, load_case
from mpmcol.setup.discretization import discretize
from mpmcol.studies.definition import Value, as_overrides
from mpmcol.studies.pareto.proposed import completed
from mpmcol.studies.pareto.recommend import POINTS_PER_CELL, options
from mpmcol.studies.pareto.shipped import (
    QUANTITIES,
    ColumnParameters,
    neighbouring_cases,
    parameters_of,
    shipped_configurations,
    shipped_study,
)
from mpmcol.studies.pareto.study import variant_values
from mpmcol.sweep.runs import PlannedRun

ROUNDING = 0.02  # relative difference below which values count as equal
MIN_SAVING = 0.05

Values = Mapping[str, Value]


@dataclass(frozen=True)
class Change:
    """A single change: its values (None where the case has them already), and the variants that show its effect."""

    name: str
    values: Callable[[Case], Values | None]
    before: str = ""  # variants of the study; "": no effect on the results
    after: str = ""


@dataclass(frozen=True)
class Proposal:
    """A change of a case with its relative cost and its effect."""

    name: str
    values: Values
    cost_ratio: float  # core-seconds over those of the unchanged case
    effect: Mapping[str, float] | None  # relative changes by quantity; None: not measured


def propose(source: str | Path, overrides: Sequence[str], accuracy: float) -> Iterator[Proposal]:
    """Yield all changes that save time, each alone; last the coarsest spacing with errors of at most `accuracy`.

    Raises UsageError if the study has no columns of the kind of the case.
    """
    case = load_case(source, overrides)
    column = parameters_of(case)
    cells = case.geometry.r_i / discretize(case).h
    for change in CHANGES:
        if (changed := change.values(case)) and (values := completed(source, overrides, changed)):
            effect = _effect(change, column, cells)
            yield Proposal(change.name, values, _cost_ratio(source, overrides, values), effect)
    if (changed := _coarser(source, overrides, cells, accuracy)) and (values := completed(source, overrides, changed)):
        yield Proposal("coarser grid", values, _cost_ratio(source, overrides, values), None)


def _cost_ratio(source: str | Path, overrides: Sequence[str], values: Values) -> float:
    before, after = load_case(source, overrides), load_case(source, [*overrides, *as_overrides(values)])
    return _core_seconds(after) / _core_seconds(before)


def _core_seconds(case: Case) -> float:
    """Estimate the cost of a case from the pace of the study in the same dimension."""
    solid = {name for name, variant in shipped_study().variants.items() if _is_3d(variant.set)}
    paces = [
        one.seconds_per_point_step
        for one in shipped_configurations()
        if (one.variant in solid) == (case.geometry.dimension == 3)
    ]
    return PlannedRun({}, case, Path()).work * median_high(paces)


def _is_3d(values: Values) -> bool:
    return values.get("geometry.model") in ("quarter", "full")


def _effect(change: Change, column: ColumnParameters, cells: float) -> Mapping[str, float] | None:
    """Return the largest relative changes in the neighbouring cases, at the studied spacing nearest to `cells`."""
    if not change.before:
        return dict.fromkeys(QUANTITIES, 0.0)
    largest: dict[str, float] = {}
    for case in neighbouring_cases(column):
        before, after = (
            {one.cells: one for one in shipped_configurations() if (one.case, one.variant) == (case, variant)}
            for variant in (change.before, change.after)
        )
        if shared := set(before) & set(after):
            nearest = min(shared, key=lambda n: abs(n / cells - 1.0))
            for quantity in QUANTITIES:
                changed = (1.0 + after[nearest].bias[quantity]) / (1.0 + before[nearest].bias[quantity]) - 1.0
                largest[quantity] = max(largest.get(quantity, 0.0), changed, key=abs)
    return largest or None


def _coarser(source: str | Path, overrides: Sequence[str], cells: float, accuracy: float) -> Values | None:
    """Return the coarsest spacing of the baseline with errors of at most `accuracy`, if it is coarser than now."""
    baseline = shipped_study().baseline
    accurate = [one.cells for one in options(source, overrides) if one.variant == baseline and one.error <= accuracy]
    if not accurate or min(accurate) > (1.0 - ROUNDING) * cells:
        return None
    return {"grid.spacing": load_case(source, overrides).geometry.r_i / min(accurate)}


def _axisymmetric(case: Case) -> Values | None:
    if case.geometry.dimension == 2 or case.geometry.section != "cylinder":
        return None
    return {"geometry.model": "axisymmetric", "grid.points_per_cell": POINTS_PER_CELL}


def _quarter(case: Case) -> Values | None:
    return {"geometry.model": "quarter"} if case.geometry.model == "full" else None


def _rigid(case: Case) -> Values | None:
    return shipped_study().variants["rigid floor"].set if case.geometry.base == "elastic" else None


def _assigned(case: Case) -> Values | None:
    return shipped_study().variants["k0"].set if case.stages.initial_stress == "gravity" else None


def _softer(case: Case) -> Values | None:
    values = variant_values(case, shipped_study().variants["E / 10"])
    (modulus,) = values.values()
    return values if float(modulus) < (1.0 - ROUNDING) * case.material.youngs_modulus else None


def _shorter(case: Case) -> Values | None:
    """Return the domain for the expected runout where the case has a longer one; the elastic base becomes smaller."""
    if case.geometry.base != "elastic":
        return None
    free = case.geometry.model_copy(update={"domain_length": None})
    length = discretize(case.model_copy(update={"geometry": free})).length
    given = case.geometry.domain_length
    return {"geometry.domain_length": length} if given and given > (1.0 + MIN_SAVING) * length else None


CHANGES = (
    Change("axisymmetric instead of 3D", _axisymmetric, "quarter in 3D", "as specified"),
    Change("a quarter instead of the full column", _quarter),
    Change("rigid floor instead of the elastic layer", _rigid, "as specified", "rigid floor"),
    Change("initial stress assigned instead of loaded", _assigned, "as specified", "k0"),
    Change("softer column and base", _softer, "as specified", "E / 10"),
    Change("domain sized by the expected runout", _shorter),
)
