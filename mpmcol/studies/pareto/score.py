"""What every setting of a study costs, and how far its runs are from the converged values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mpmcol.measure.profile_distance import area_between, mean_height
from mpmcol.studies.pareto.configurations import Setting
from mpmcol.studies.pareto.reference import QUANTITIES, Reference, make_reference
from mpmcol.studies.pareto.study import Study
from mpmcol.studies.runs import Finished, Found, Member

ZETA, BETA, PROFILE = "zeta.front_height", "beta", "profile"  # what settings are chosen by
COSTS = ("core_seconds", "point_steps", "peak_memory_bytes", "written_bytes")
USUAL = 1.28  # standard deviations: nine of ten runs are less than this to the far side of the mean


@dataclass(frozen=True)
class Error:
    """Relative error of a setting's runs in one quantity."""

    bias: float  # of their mean
    scatter: float  # standard deviation of one run
    runs: int

    @property
    def usual(self) -> float:
        """What about nine of ten runs keep within."""
        return abs(self.bias) + USUAL * self.scatter


@dataclass(frozen=True)
class Scored:
    """A setting, its runs that ended well, their errors, and why others did not end well."""

    setting: Setting
    runs: Sequence[Finished]
    errors: Mapping[str, Error]  # by quantity; empty without runs or reference
    failures: Sequence[str]  # one for each run that did not

    @property
    def causes(self) -> str:
        """Why runs did not end well, each cause once."""
        return "; ".join(dict.fromkeys(self.failures))

    @property
    def is_complete(self) -> bool:
        """Whether all of its runs ended well; some may not have been made yet."""
        return len(self.runs) == len(self.setting.members)

    @cached_property
    def cost(self) -> dict[str, float]:
        """Of one run: CPU time without compilation (the least of all), point-steps, peak memory, bytes written."""
        rows = [run.row for run in self.runs]
        return {
            "core_seconds": min(row["core_seconds"] for row in rows),
            "point_steps": float(np.mean([row["points"] * row["steps"] for row in rows])),
            "peak_memory_bytes": float(max(row["peak_memory_bytes"] for row in rows)),
            "written_bytes": float(np.mean([_size(run) for run in self.runs])),
        }


def score_study(
    study: Study, settings: Sequence[Setting], found: Found, failures: Mapping[Member, str]
) -> tuple[dict[str, Reference], list[Scored]]:
    """References by scene (those that could be made), and all settings with their errors against them.

    Args:
        failures: run -> why it did not end well.
    """
    levels: dict[tuple[str, str], dict[float, list[Finished]]] = {(s.scene, s.family): {} for s in settings}
    for s in settings:
        if runs := _runs(s, found):
            levels[s.scene, s.family][s.cells] = runs
    made = {scene: make_reference([levels[scene, family] for family in study.reference]) for scene in study.scenes}
    references = {scene: reference for scene, reference in made.items() if reference}
    return references, [_score(s, found, failures, references.get(s.scene)) for s in settings]


def _score(setting: Setting, found: Found, failures: Mapping[Member, str], reference: Reference | None) -> Scored:
    runs = _runs(setting, found)
    errors = _errors(runs, reference) if runs and reference else {}
    return Scored(setting, runs, errors, [failures[member] for member in setting.members if member in failures])


def _errors(runs: Sequence[Finished], reference: Reference) -> dict[str, Error]:
    errors = {}
    for quantity in QUANTITIES:
        ratios = np.array([run.row[quantity] for run in runs]) / reference.limits[quantity].value
        errors[quantity] = Error(float(ratios.mean()) - 1.0, _deviation(ratios), len(runs))
    heights = [mean_height([run.results.measure(-1)], reference.x) for run in runs]
    areas = np.array([area_between(height, reference.height) for height in heights])
    return errors | {PROFILE: Error(float(areas.mean()), _deviation(areas), len(runs))}


def _runs(setting: Setting, found: Found) -> list[Finished]:
    return [found[member] for member in setting.members if member in found]


def _deviation(values: np.ndarray) -> float:
    return float(values.std(ddof=1)) if len(values) > 1 else 0.0


def _size(run: Finished) -> int:
    return sum(path.stat().st_size for path in run.folder.rglob("*") if path.is_file())
