"""The points of a map: one for each combination of choices, with its run."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from mpmcol.case import Case, load_case
from mpmcol.case.values import leaf_values
from mpmcol.errors import MpmcolError, UsageError
from mpmcol.studies.definition import as_text
from mpmcol.studies.method_map.definition import Block, MapCase, MapDefinition
from mpmcol.studies.runs import CFL, StudyRun, repeated_cfl, study_run
from mpmcol.sweep.names import short_names

CONDITIONS = ("material.", "geometry.")  # tables that define what collapses, not how it is computed


@dataclass(frozen=True)
class MapPoint:
    """One combination of choices on the map, and its run."""

    block: str
    panel: str  # title
    case: str
    choices: Mapping[str, str]  # key of the case -> value, of all that the block sets
    across: str  # key of the choice on the horizontal axis
    down: str  # key of the choice on the vertical axis
    is_default: bool  # whether the method is that of the case, with at most its time step
    run: StudyRun

    @property
    def label(self) -> str:
        """Panel and the two choices in it."""
        choices = (f"{key.rpartition('.')[2]} {self.choices[key]}" for key in (self.down, self.across))
        return ", ".join((self.panel, *choices))


def points_of(definition: MapDefinition) -> Iterator[MapPoint]:
    """Yield all points, panel by panel, row by row.

    Raises UsageError if a combination is not a valid case; the message names block and choices.
    """
    for name, block in definition.blocks.items():
        for values in itertools.product(*block.panels.values(), *block.down.values(), *block.across.values()):
            keys = (*block.panels, *block.down, *block.across)
            varied = {key: as_text(value) for key, value in zip(keys, values, strict=True)}
            yield _point(name, block, definition.cases[block.case], varied)


def reference_runs(case: MapCase) -> tuple[list[StudyRun], list[StudyRun]]:
    """Return repeated runs of a case with its own method: at the spacing of the map, and at the finer one."""
    cfl = _own_case(case).time.cfl
    levels = ((case.cells, case.repeats), (case.finer, case.finer_repeats))
    own, finer = ([_run(case, cells, {CFL: one}) for one in repeated_cfl(cfl, count)] for cells, count in levels)
    return own, finer


def _point(name: str, block: Block, case: MapCase, varied: Mapping[str, str]) -> MapPoint:
    choices = {key: as_text(value) for key, value in block.set.items()} | dict(varied)
    try:
        run = _run(case, case.cells, choices)
        _ = run.plan(Path()).discretization  # raises if the column does not fit on the grid
    except MpmcolError as error:
        given = ", ".join(f"{key} = {value}" for key, value in choices.items())
        raise UsageError(f"blocks.{name}, {given}:\n{error}") from None
    return MapPoint(
        name, _panel_title(name, block, varied), block.case, choices, next(iter(block.across)), next(iter(block.down)),
        _is_default(case, dict(run.overrides)), run,
    )  # fmt: skip


def _panel_title(name: str, block: Block, varied: Mapping[str, str]) -> str:
    """Return the choices that are specific to a panel, or the name of its block."""
    names = short_names(block.panels)
    return ", ".join(f"{names[key]} {varied[key]}" for key in block.panels) or name


def _run(case: MapCase, cells: float, choices: Mapping[str, str]) -> StudyRun:
    """Return the run; values that the case has already are left out, so that blocks share equal runs."""
    own = _own_case(case)
    changed = {key: text for key, text in sorted(choices.items()) if not _is_own(case.extends, case.aspect, key, text)}
    return study_run(case.extends, case.aspect, round(own.geometry.r_i / cells, 9), **changed)


def _own_case(case: MapCase) -> Case:
    """Load a case with its own method."""
    return load_case(case.extends, [f"geometry.aspect={case.aspect}"])


@cache
def _is_own(case: str, aspect: float, key: str, text: str) -> bool:
    """Whether a case has this value already."""
    column = f"geometry.aspect={aspect}"
    own, changed = (leaf_values(load_case(case, overrides)) for overrides in ([column], [column, f"{key}={text}"]))
    return bool(own == changed)


def _is_default(case: MapCase, overrides: Mapping[str, str]) -> bool:
    own = _own_case(case)
    choices = [key for key in overrides if not key.startswith((*CONDITIONS, "output."))]
    return not choices or (choices == [CFL] and float(overrides[CFL]) < own.time.cfl)
