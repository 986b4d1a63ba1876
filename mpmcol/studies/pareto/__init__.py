"""Cost against error: configurations of model and method, compared in a study that a TOML file defines.

Two errors are separated. The *discretisation error* of a run is its difference from the grid-converged value of its
case, on which two independently refined scheme variants agree within a stated uncertainty. The *model error* is the
difference of that value from the experiment, whose own scatter no computation can resolve.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from mpmcol.errors import MpmcolError, UsageError
from mpmcol.studies.pareto.reference import ConvergedReference
from mpmcol.studies.pareto.report import write_report
from mpmcol.studies.pareto.score import ScoredConfiguration, make_references, score
from mpmcol.studies.pareto.study import Configuration, StudyDefinition, configurations_of
from mpmcol.studies.runs import EndedRuns, StudyRun


@dataclass(frozen=True)
class ScoredStudy:
    """Grid-converged references by case, as far as they could be made, and all configurations with their errors."""

    references: Mapping[str, ConvergedReference]
    scored: Sequence[ScoredConfiguration]


@dataclass(frozen=True)
class ParetoStudy:
    """A definition as a study (see `mpmcol.studies.frame.Study`)."""

    definition: StudyDefinition

    @cached_property
    def configurations(self) -> list[Configuration]:
        """All configurations.

        Raises UsageError if one of them is not a valid case.
        """
        configurations = list(configurations_of(self.definition))
        for configuration in configurations:
            try:
                configuration.runs[0].plan(Path())
            except MpmcolError as error:
                raise UsageError(f"{configuration}:\n{error}") from None
        return configurations

    def runs(self) -> Iterable[StudyRun]:
        """Return the runs of all configurations."""
        return (run for configuration in self.configurations for run in configuration.runs)

    def evaluate(self, ended: EndedRuns) -> ScoredStudy:
        """Compute references and errors."""
        references = make_references(self.definition, self.configurations, ended)
        return ScoredStudy(references, [score(one, ended, references.get(one.case)) for one in self.configurations])

    def write_report(self, evaluation: ScoredStudy, heading: str, out: Path) -> list[Path]:
        """Write pareto.csv, pareto.md and a chart for each case."""
        return write_report(self.definition, evaluation.references, evaluation.scored, heading, out)
