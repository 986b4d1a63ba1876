"""The cheapest configuration for a case with a requested accuracy, from the shipped study."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import ceil, inf, sqrt
from pathlib import Path
from typing import Any, NamedTuple

from mpmcol.case import Case, load_case
from mpmcol.case.fields import shown
from mpmcol.case.overrides import split_setting
from mpmcol.case.values import leaf_values
from mpmcol.errors import UsageError
from mpmcol.studies.definition import Value, as_overrides
from mpmcol.studies.pareto.error_interval import ErrorInterval, error_intervals
from mpmcol.studies.pareto.proposed import completed
from mpmcol.studies.pareto.shipped import (
    QUANTITIES,
    SAME_ASPECT,
    SAME_FRICTION,
    ColumnParameters,
    ShippedConfiguration,
    neighbouring_cases,
    parameters_of,
    shipped_configurations,
    shipped_study,
    similar_cases,
    study_case,
)
from mpmcol.studies.pareto.study import variant_values
from mpmcol.studies.runs import CFL
from mpmcol.sweep.runs import PlannedRun
from mpmcol.units import duration_text

POINTS_PER_CELL = 4  # of the study, where a variant does not set it
COMPARED = ("method.", "time.", "stages.", "material.")  # tables in which a case is compared with those of the study
# Values that the study varies, that follow from these, or that only scale the collapse of dry sand.
NOT_COMPARED = ("material.friction_deg", "material.youngs_modulus", "stages.k0", "material.density")
LOADING = "stages.equilibrate."
LARGEST_CORRECTION = 2.0  # error of a grid that is corrected, over the accuracy: coarser ones differ in other ways


class Difference(NamedTuple):
    """A value of a case that differs from those of the study."""

    key: str
    value: str
    studied: str

    def __str__(self) -> str:
        return f"{self.key} = {self.value}, in the study {self.studied}"


@dataclass(frozen=True)
class Recommendation:
    """A configuration for a case, with the errors and the cost that it had in the study."""

    variant: str
    cells: float  # r_i / h
    studied: float  # r_i / h up to which all of `cases` were studied; its bounds also hold for finer grids
    values: Mapping[str, Value]  # to be replaced in the case
    errors: Mapping[str, float]  # quantity -> relative error not exceeded by 90 % of runs in any of `cases`
    cases: Sequence[str]  # of the study, between which the case lies
    column: ColumnParameters  # of the case
    core_seconds: float  # expected, on the machine of the study
    differences: Sequence[Difference]  # of the case from those of the study, whose errors may not apply to it

    @property
    def overrides(self) -> list[str]:
        """The values as `--set` takes them."""
        return as_overrides(self.values)

    @property
    def error(self) -> float:
        """The larger of the errors of runout and height."""
        return max(self.errors.values())

    @property
    def corrected_error(self) -> float:
        """The larger error of runout and height that are corrected for the error of the grid."""
        return largest_corrected_error(self.intervals)

    @property
    def intervals(self) -> dict[str, ErrorInterval]:
        """Intervals of the relative errors, with their sign, by quantity."""
        return error_intervals(self.variant, self.cells, self.column)

    def __str__(self) -> str:
        intervals = self.intervals
        errors = ", ".join(f"{name} {error:.1%}, {intervals[name]}" for name, error in self.errors.items())
        coarser = self.studied < self.cells
        return "\n  ".join(
            [
                f'"{self.variant}" at r_i/h = {self.cells:g}: {", ".join(self.overrides)}',
                f"errors and their intervals in the study: {errors} (90 % of runs; {'; '.join(self.cases)})",
                *([f"not all of these were studied beyond r_i/h = {self.studied:g}: its errors count"] * coarser),
                *(f"note: these errors may not apply: {difference}" for difference in self.differences),
                f"expected cost: about {duration_text(self.core_seconds)} of one core on the machine of the study",
            ]
        )


def recommend(source: str | Path, overrides: Sequence[str], accuracy: float, corrected: bool = False) -> Recommendation:
    """Return the cheapest selectable configuration with errors of at most `accuracy` in all neighbouring cases.

    Args:
        source, overrides: of the case, as `load_case` takes them.
        accuracy: largest relative error of runout and height.
        corrected: of runout and height that are corrected for the error of the grid, so that coarser grids suffice.

    Raises:
        UsageError: there is none; the message shows the most accurate configuration.
    """
    accurate = list(options(source, overrides, accuracy, corrected))
    if not accurate:
        raise UsageError(_out_of_reach(list(options(source, overrides)), accuracy, corrected))
    return min(accurate, key=lambda one: one.core_seconds)


def require_free(advice: Recommendation, overrides: Sequence[str]) -> None:
    """Raise UsageError if an override is another value of a key that the configuration sets."""
    chosen = dict(text.split("=", 1) for text in advice.overrides)
    for text in overrides:
        key, value = split_setting(text)
        if chosen.get(key, value) != value:
            raise UsageError(f"--accuracy chooses {key} = {chosen[key]}; remove --set {text}, or --accuracy")


def _out_of_reach(candidates: Sequence[Recommendation], accuracy: float, corrected: bool) -> str:
    """Why no configuration is recommended."""
    if not candidates:
        return (
            "every configuration of the study has too few cells for this column, or other settings that are unfit for "
            "it; set grid.spacing instead of an accuracy (mpmcol check reports unfit settings)"
        )
    errors = [one.corrected_error if corrected else one.error for one in candidates]
    least = min(errors)
    return (
        f"no configuration of the study has {'corrected values with ' * corrected}errors of at most "
        f"{100.0 * accuracy:.3g}% for cases like this one; the most accurate is\n{candidates[errors.index(least)]}\n"
        f"use --accuracy {ceil(1e3 * least) / 10.0:g}% or more, or set grid.spacing instead"
    )


def finer_grid(source: str | Path, overrides: Sequence[str], advice: Recommendation) -> float:
    """Return r_i / h of the next finer grid of the study; beyond its finest grid, finer by a factor of sqrt(2)."""
    finer = (one.cells for one in options(source, overrides) if one.variant == advice.variant)
    return min((cells for cells in finer if cells > advice.cells), default=round(sqrt(2.0) * advice.cells))


def options(
    source: str | Path, overrides: Sequence[str], accuracy: float = inf, corrected: bool = False
) -> Iterator[Recommendation]:
    """Yield the selectable configurations of the study for a case that have this accuracy, with errors and costs.

    corrected: the accuracy is that of values corrected for the error of the grid.

    Those that would cause warnings are omitted, for example grids with few cells in the height of a flat column, and
    variants that were studied on another base than that of the case.
    """
    case = load_case(source, overrides)
    column = parameters_of(case)
    cases = neighbouring_cases(column)
    for (variant, cells), group in covered_configurations(cases).items():
        errors = largest_errors(group)
        error = largest_corrected_error(error_intervals(variant, cells, column)) if corrected else max(errors.values())
        if error > accuracy:
            continue
        values = completed(source, overrides, configuration_values(case, variant, cells))
        if values is None:
            continue
        configured = load_case(source, [*overrides, *as_overrides(values)])
        if configured.geometry.base != study_case(cases[0], variant).geometry.base:
            continue
        pace = max(one.seconds_per_point_step for one in group)
        cost = pace * PlannedRun({}, configured, Path()).work
        differences = differences_from_study(configured, variant, cases)
        studied = min(one.cells for one in group)
        yield Recommendation(variant, cells, studied, values, errors, cases, column, cost, differences)


def largest_corrected_error(intervals: Mapping[str, ErrorInterval]) -> float:
    """Return the largest error that remains of any quantity, or that of which a correction is the largest one."""
    return max(max(one.relative, abs(1.0 - 1.0 / one.factor) / LARGEST_CORRECTION) for one in intervals.values())


def studied_configurations(cases: Sequence[str]) -> dict[tuple[str, float], list[ShippedConfiguration]]:
    """Return the selectable configurations that were studied in all `cases`, by variant and r_i / h."""
    covered = covered_configurations(cases)
    return {
        (name, cells): group for (name, cells), group in covered.items() if all(one.cells == cells for one in group)
    }


def covered_configurations(cases: Sequence[str]) -> dict[tuple[str, float], list[ShippedConfiguration]]:
    """Return the selectable configurations for which all `cases` have error bounds, by variant and r_i / h.

    A bound also holds for the finer grids of its variant (`ErrorBound`). For a grid that is finer than all of a case,
    the finest configuration of that case is therefore in the group.
    """
    variants = shipped_study().variants
    grids: dict[str, dict[str, dict[float, ShippedConfiguration]]] = {}  # variant -> case -> r_i / h
    for one in shipped_configurations():
        if one.case in cases and one.bounds and variants[one.variant].selectable:
            grids.setdefault(one.variant, {}).setdefault(one.case, {})[one.cells] = one
    groups = {
        (variant, cells): [found for own in by_case.values() if (found := _covering(own, cells))]
        for variant, by_case in grids.items()
        for cells in sorted({cells for own in by_case.values() for cells in own})
    }
    return {configuration: group for configuration, group in groups.items() if len(group) == len(cases)}


def _covering(own: Mapping[float, ShippedConfiguration], cells: float) -> ShippedConfiguration | None:
    """The configuration of a case and variant whose bound holds at r_i / h = cells."""
    return own.get(min(cells, max(own)))


def largest_errors(group: Sequence[ShippedConfiguration]) -> dict[str, float]:
    """Return the largest error of each quantity."""
    bounds = [one.bounds for one in group if one.bounds]
    return {quantity: max(bound[quantity] for bound in bounds) for quantity in QUANTITIES}


def configuration_values(case: Case, variant: str, cells: float) -> dict[str, Value]:
    """Return the values that turn a case into a configuration of the study; a 3D cylinder becomes axisymmetric."""
    values: dict[str, Value] = {"grid.spacing": case.geometry.r_i / cells}
    if case.geometry.dimension == 3:
        values |= {"geometry.model": "axisymmetric", "grid.points_per_cell": POINTS_PER_CELL}
    return values | variant_values(case, shipped_study().variants[variant])


def differences_from_study(case: Case, variant: str, cases: Sequence[str]) -> list[Difference]:
    """Return how a case, configured with `variant`, differs from the neighbouring `cases` of the study."""
    here, there = _compared(case), _compared(study_case(cases[0], variant))
    keys = [key for key in here if key in there and here[key] != there[key]]
    if here[CFL] <= there[CFL]:  # a smaller time step is no less accurate
        keys = [key for key in keys if key != CFL]
    return [
        *_outside_range(case),
        *(Difference(key, shown(here[key]), shown(there[key])) for key in keys),
    ]


def _compared(case: Case) -> Mapping[str, Any]:
    # A column with assigned stress is in equilibrium from the start, without loading.
    omitted = (*NOT_COMPARED, *((LOADING,) if case.stages.initial_stress == "k0" else ()))
    return {
        key: value
        for key, value in leaf_values(case).items()
        if key.startswith(COMPARED) and not key.startswith(omitted)
    }


def _outside_range(case: Case) -> Iterator[Difference]:
    column = parameters_of(case)
    similar = similar_cases(column).values()
    for name, x, studied, near, ratio in (
        ("a", column.a, [one.a for one in similar], 0.0, SAME_ASPECT),
        ("friction", column.friction_deg, [one.friction_deg for one in similar], SAME_FRICTION, 1.0),
    ):
        if not min(studied) / ratio - near <= x <= max(studied) * ratio + near:
            yield Difference(name, f"{x:.3g}", f"{min(studied):g} to {max(studied):g}")
