"""What would make a case cheaper: each change alone, with its saving and what it was found to change."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from mpmcol.case import Case, load_case
from mpmcol.setup.discretization import discretize
from mpmcol.studies.pareto.configurations import overrides_of
from mpmcol.studies.pareto.recommend import POINTS_PER_CELL, as_overrides, options
from mpmcol.studies.pareto.shipped import QUANTITIES, Place, Row, place_of, scenes_around, shipped_rows, shipped_study
from mpmcol.studies.pareto.study import Value
from mpmcol.sweep.runs import PlannedRun

ROUNDING = 0.02  # values this near to each other are the same
LEAST_SAVING = 0.05

Values = Mapping[str, Value]


@dataclass(frozen=True)
class Change:
    """One choice: the values that make it (None where the case is so already), and families that show what it does."""

    name: str
    values: Callable[[Case], Values | None]
    before: str = ""  # families of the study; "": nothing but the cost changes
    after: str = ""


@dataclass(frozen=True)
class Proposal:
    """A change of a case: its core-seconds over those of the case, and relative changes (None: not measured)."""

    name: str
    values: Values
    cost_ratio: float
    effect: Mapping[str, float] | None


def propose(source: str | Path, overrides: Sequence[str], accuracy: float) -> Iterator[Proposal]:
    """All changes that would save time, each alone; the spacing that keeps to `accuracy` last.

    Raises UsageError if the study has no columns like the case's.
    """
    case, rows = load_case(source, overrides), shipped_rows()
    place = place_of(case)
    cells = case.geometry.r_i / discretize(case).h
    for change in CHANGES:
        if values := change.values(case):
            effect = _effect(change, place, cells, rows)
            yield Proposal(change.name, values, _cost_ratio(source, overrides, values), effect)
    if values := _coarser(source, overrides, cells, accuracy):
        yield Proposal("coarser grid", values, _cost_ratio(source, overrides, values), None)


def _cost_ratio(source: str | Path, overrides: Sequence[str], values: Values) -> float:
    before, after = load_case(source, overrides), load_case(source, [*overrides, *as_overrides(values)])
    return _core_seconds(after) / _core_seconds(before)


def _core_seconds(case: Case) -> float:
    """By the study's pace in as many dimensions."""
    solid = {name for name, family in shipped_study().families.items() if _is_solid(family.set)}
    paces = [
        row.seconds_per_point_step for row in shipped_rows() if (row.family in solid) == (case.geometry.dimension == 3)
    ]
    return PlannedRun({}, case, Path()).work * sorted(paces)[len(paces) // 2]


def _is_solid(values: Values) -> bool:
    return values.get("geometry.model") in ("quarter", "full")


def _effect(change: Change, place: Place, cells: float, rows: Sequence[Row]) -> Mapping[str, float] | None:
    """The largest relative changes in the scenes around a case, at the measured spacing nearest to its own."""
    if not change.before:
        return dict.fromkeys(QUANTITIES, 0.0)
    found: dict[str, float] = {}
    for scene in scenes_around(place):
        by_family = {
            family: {row.cells: row for row in rows if (row.scene, row.family) == (scene, family)}
            for family in (change.before, change.after)
        }
        before, after = by_family.values()
        if shared := set(before) & set(after):
            nearest = min(shared, key=lambda n: abs(n / cells - 1.0))
            for quantity in QUANTITIES:
                changed = (1.0 + after[nearest].bias[quantity]) / (1.0 + before[nearest].bias[quantity]) - 1.0
                found[quantity] = max(found.get(quantity, 0.0), changed, key=abs)
    return found or None


def _coarser(source: str | Path, overrides: Sequence[str], cells: float, accuracy: float) -> Values | None:
    """The spacing of the coarsest setting as asked that keeps to the accuracy, if that is coarser."""
    base = shipped_study().base
    fine = [one.cells for one in options(source, overrides) if one.family == base and one.error <= accuracy]
    if not fine or min(fine) > (1.0 - ROUNDING) * cells:
        return None
    return {"grid.spacing": load_case(source, overrides).geometry.r_i / min(fine)}


def _axisymmetric(case: Case) -> Values | None:
    if case.geometry.dimension == 2 or case.geometry.section != "cylinder":
        return None
    return {"geometry.model": "axisymmetric", "grid.points_per_cell": POINTS_PER_CELL}


def _quarter(case: Case) -> Values | None:
    return {"geometry.model": "quarter"} if case.geometry.model == "full" else None


def _rigid(case: Case) -> Values | None:
    return shipped_study().families["rigid floor"].set if case.geometry.base == "elastic" else None


def _assigned(case: Case) -> Values | None:
    return shipped_study().families["k0"].set if case.stages.initial_stress == "gravity" else None


def _softer(case: Case) -> Values | None:
    values = overrides_of(case, shipped_study().families["E / 10"])
    (modulus,) = values.values()
    return values if float(modulus) < (1.0 - ROUNDING) * case.material.youngs_modulus else None


def _shorter(case: Case) -> Values | None:
    """The domain that would be chosen from the expected runout, where a longer one was given: it saves base."""
    if case.geometry.base != "elastic":
        return None
    free = case.geometry.model_copy(update={"domain_length": None})
    length = discretize(case.model_copy(update={"geometry": free})).length
    given = case.geometry.domain_length
    return {"geometry.domain_length": length} if given and given > (1.0 + LEAST_SAVING) * length else None


CHANGES = (
    Change("axisymmetric instead of 3D", _axisymmetric, "quarter in 3D", "as asked"),
    Change("a quarter instead of the whole", _quarter),
    Change("rigid floor instead of the elastic layer", _rigid, "as asked", "rigid floor"),
    Change("initial stress assigned, not loaded", _assigned, "as asked", "k0"),
    Change("softer column and base", _softer, "as asked", "E / 10"),
    Change("domain from the expected runout", _shorter),
)
