"""The cheapest setting for a case that keeps to an accuracy, by the shipped study."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import ceil
from pathlib import Path

from mpmcol.case import Case, load_case
from mpmcol.errors import UsageError
from mpmcol.studies.definition import Value, as_text
from mpmcol.studies.pareto.caveats import unlike
from mpmcol.studies.pareto.configurations import overrides_of
from mpmcol.studies.pareto.shipped import QUANTITIES, Row, place_of, scenes_around, shipped_rows, shipped_study
from mpmcol.sweep.runs import PlannedRun

POINTS_PER_CELL = 4  # of the study where a family says nothing else


@dataclass(frozen=True)
class Advice:
    """A setting for a case, and what it was found to keep to."""

    family: str
    cells: float  # r_i / h
    values: Mapping[str, Value]  # of the case, to be replaced
    within: Mapping[str, float]  # quantity -> relative error that nine of ten runs keep to, in all `scenes`
    scenes: Sequence[str]  # of the study, between which the case lies
    core_seconds: float  # expected, on the machine of the study
    unlike: Sequence[str]  # what the case has otherwise than the study, whose errors may not hold for it

    @property
    def overrides(self) -> list[str]:
        """The values as `--set` takes them."""
        return as_overrides(self.values)

    @property
    def error(self) -> float:
        """The larger of the errors in runout and height."""
        return max(self.within.values())

    def __str__(self) -> str:
        errors = ", ".join(f"{quantity} {error:.1%}" for quantity, error in self.within.items())
        return "\n  ".join(
            [
                f'"{self.family}" at r_i/h = {self.cells:g}: {", ".join(self.overrides)}',
                f"its errors in the study: {errors} (9 of 10 runs; {'; '.join(self.scenes)})",
                *(f"note: they may not hold here: {what}" for what in self.unlike),
                f"expected: about {self.core_seconds:.2g} core-seconds on the machine of the study",
            ]
        )


def advise(source: str | Path, overrides: Sequence[str], accuracy: float) -> Advice:
    """The cheapest offered setting whose errors in runout and height kept to `accuracy` in all scenes around a case.

    Args:
        source, overrides: of the case, as `load_case` takes them.
        accuracy: relative.

    Raises:
        UsageError: none did; it tells the best that there is.
    """
    candidates = list(options(source, overrides))
    keeping = [one for one in candidates if one.error <= accuracy]
    if not keeping:
        best = min(candidates, key=lambda one: one.error)
        raise UsageError(
            f"no setting of the study keeps to {100.0 * accuracy:.3g}% around this case; the most accurate:\n{best}\n"
            f"ask for --accuracy {ceil(1e3 * best.error) / 10.0:g}% or more, or give grid.spacing yourself"
        )
    return min(keeping, key=lambda one: one.core_seconds)


def options(source: str | Path, overrides: Sequence[str]) -> Iterator[Advice]:
    """All offered settings of the study for a case, with their errors around it and their costs."""
    case = load_case(source, overrides)
    scenes = scenes_around(place_of(case))
    by_setting: dict[tuple[str, float], list[Row]] = {}
    for row in shipped_rows():
        if row.scene in scenes and row.within and shipped_study().families[row.family].offered:
            by_setting.setdefault((row.family, row.cells), []).append(row)
    for (family, cells), rows in by_setting.items():
        if len(rows) == len(scenes):
            values = values_for(case, family, cells)
            asked = load_case(source, [*overrides, *as_overrides(values)])
            pace = max(row.seconds_per_point_step for row in rows)
            known = [row.within for row in rows if row.within]
            within = {quantity: max(errors[quantity] for errors in known) for quantity in QUANTITIES}
            cost = pace * PlannedRun({}, asked, Path()).work
            yield Advice(family, cells, values, within, scenes, cost, unlike(asked, family, scenes))


def values_for(case: Case, family: str, cells: float) -> dict[str, Value]:
    """The values of a case that make it a setting of the study; a cylinder in 3D becomes axisymmetric."""
    values: dict[str, Value] = {"grid.spacing": case.geometry.r_i / cells}
    if case.geometry.dimension == 3:
        values |= {"geometry.model": "axisymmetric", "grid.points_per_cell": POINTS_PER_CELL}
    return values | overrides_of(case, shipped_study().families[family])


def as_overrides(values: Mapping[str, Value]) -> list[str]:
    """Values as `--set` takes them."""
    return [f"{key}={as_text(value)}" for key, value in values.items()]
