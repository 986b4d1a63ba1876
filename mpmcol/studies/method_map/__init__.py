"""Map of methods: many short collapses over choices of method, each of which passes, degrades or fails.

A TOML file defines the runs (`definition.py`; shipped ones in `cases/maps`); `assessment.py` holds the criteria.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from mpmcol.studies.method_map.assessment import AssessedPoint, MapReference, assess, make_reference
from mpmcol.studies.method_map.definition import MapDefinition
from mpmcol.studies.method_map.points import MapPoint, points_of, reference_runs
from mpmcol.studies.method_map.report import write_report
from mpmcol.studies.runs import EndedRuns, StudyRun


@dataclass(frozen=True)
class MethodMap:
    """The references of the cases and the assessment of each point of a map."""

    references: Mapping[str, MapReference]
    assessed: Sequence[AssessedPoint]


@dataclass(frozen=True)
class MapStudy:
    """A definition as a study (see `mpmcol.studies.frame.Study`)."""

    definition: MapDefinition

    @cached_property
    def points(self) -> list[MapPoint]:
        """All points of the map; UsageError if one of them is not a valid case."""
        return list(points_of(self.definition))

    def runs(self) -> Iterable[StudyRun]:
        """Return the runs of the references, then those of the points."""
        references = [reference_runs(case) for case in self.definition.cases.values()]
        return [
            *(run for levels in references for level in levels for run in level),
            *(point.run for point in self.points),
        ]

    def evaluate(self, ended: EndedRuns) -> MethodMap:
        """Assess all points; those whose runs have not ended are not assessed.

        Raises OutputError if a case has too few successful runs for a reference.
        """
        references = {}
        for name, case in self.definition.cases.items():
            own, finer = (ended.completed_of(level) for level in reference_runs(case))
            references[name] = make_reference(name, own, finer, ended.folder)
        return MethodMap(references, [assess(point, ended, references[point.case]) for point in self.points])

    def write_report(self, evaluation: MethodMap, heading: str, out: Path) -> list[Path]:
        """Write map.csv, map.md and the chart."""
        return write_report(self.definition, evaluation.references, evaluation.assessed, heading, out)
