"""The figures of Coetzee & Purvance 2026 (doi:10.20944/preprints202605.0398.v1), computed.

To add a figure, write a module with the contents of `Figure` and add one line to FIGURES.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

from mpmcol.studies.paper import factors, fig5, fig6, fig7, fig8, fig9
from mpmcol.studies.paper.report import FigureResult, write_figure
from mpmcol.studies.runs import CompletedRuns, EndedRuns, StudyRun


class Figure(Protocol):
    """A figure, or a table, as a module."""

    TITLE: str

    def runs(self, quick: bool) -> list[StudyRun]:
        """Return the runs of the figure; with `quick` on coarse grids and for fewer columns."""

    def evaluate(self, completed: CompletedRuns, quick: bool) -> FigureResult:
        """Evaluate those of the runs that are done."""


FIGURES: dict[str, Figure] = {
    "fig5": fig5, "fig6": fig6, "fig7": fig7, "fig8": fig8, "fig9": fig9, "factors": factors
}  # fmt: skip

AS_PRINTED = "lube-"  # begins the names of the cases without a stress filter; the rest names the same case with it


@dataclass(frozen=True)
class PaperStudy:
    """Some of the figures as a study (see `mpmcol.studies.frame.Study`)."""

    names: Sequence[str]  # in FIGURES
    quick: bool
    filtered: bool = False  # with the stress filter, which the paper does not have

    def runs(self) -> Iterable[StudyRun]:
        """Return the runs of all figures, some of which share runs."""
        return map(self._as_carried_out, self._runs())

    def evaluate(self, ended: EndedRuns) -> Mapping[str, FigureResult]:
        """Return the result of each figure by its name."""
        completed = {
            run: ended.completed[carried_out]
            for run in self._runs()
            if (carried_out := self._as_carried_out(run)) in ended.completed
        }
        return {name: FIGURES[name].evaluate(completed, self.quick) for name in self.names}

    def write_report(self, evaluation: Mapping[str, FigureResult], heading: str, out: Path) -> list[Path]:
        """Write a table, a text and charts for each figure."""
        heading = f"{heading}{'; quick: coarse grids, fewer columns' if self.quick else ''}."
        heading += " With the stress filter." if self.filtered else ""
        return [
            path
            for name, result in evaluation.items()
            for path in write_figure(result, name, FIGURES[name].TITLE, heading, out)
        ]

    def _runs(self) -> Iterable[StudyRun]:
        return (run for name in self.names for run in FIGURES[name].runs(self.quick))

    def _as_carried_out(self, run: StudyRun) -> StudyRun:
        return replace(run, case=run.case.removeprefix(AS_PRINTED)) if self.filtered else run
