"""Configurations of the runs of a sweep, chosen by their error."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from mpmcol.io.results import Results
from mpmcol.studies.pareto.recommend import Recommendation, recommend, require_free
from mpmcol.studies.statement import make_statement
from mpmcol.studies.statement_text import write_statement
from mpmcol.sweep.arguments import require_accuracy
from mpmcol.sweep.engine import Outcome


class Recommendations:
    """Chooses the cheapest configuration of each run within an accuracy, as `mpmcol run --accuracy` does.

    accuracy: relative error of runout and height; with `corrected`, of the values corrected for the error of the grid.
    Raises UsageError unless it is between 0 and 1.
    """

    def __init__(self, case: str | Path, accuracy: float, corrected: bool = False) -> None:
        require_accuracy(accuracy, corrected)
        self.case, self.accuracy, self.corrected = case, accuracy, corrected
        self.found: dict[str, Recommendation] = {}  # by the overrides of the run, in the order of the runs

    def __call__(self, overrides: Sequence[str]) -> list[str]:
        """The overrides that configure a run with these overrides.

        Raises UsageError if no configuration of the study has the accuracy, or if it sets a key of the overrides.
        """
        advice = recommend(self.case, overrides, self.accuracy, self.corrected)
        require_free(advice, overrides)
        self.found[", ".join(overrides)] = advice
        return advice.overrides

    def lines(self) -> Iterator[str]:
        """Which configurations were chosen, for which runs, and for which runs their errors may not apply."""
        groups: dict[tuple[str, float], list[str]] = {}
        for run, advice in self.found.items():
            groups.setdefault((advice.variant, advice.cells), []).append(run)
        for (variant, cells), runs in groups.items():
            within = f"{100.0 * self.accuracy:.3g}%" + ", corrected for the error of the grid" * self.corrected
            yield f'cheapest within {within}: "{variant}" at r_i/h = {cells:g} for {_listed(runs)}'
        for (key, studied), values in self._outside_study().items():
            yield f"note: these errors may not apply to {key} = {', '.join(values)}; in the study {key} is {studied}"

    def state(self, outcomes: Sequence[Outcome]) -> None:
        """Write the statement of accuracy of each run that is done into its folder."""
        for outcome, advice in zip(outcomes, self.found.values(), strict=True):
            if outcome.status == "done":
                results = Results(outcome.run.folder)
                statement = make_statement(results, advice, self.accuracy, corrected=self.corrected)
                write_statement(results.folder, statement)

    def _outside_study(self) -> dict[tuple[str, str], dict[str, None]]:
        """Values in which runs differ from the study, each once, by their key and its range in the study."""
        found: dict[tuple[str, str], dict[str, None]] = {}
        for advice in self.found.values():
            for difference in advice.differences:
                found.setdefault((difference.key, difference.studied), {})[difference.value] = None
        return found


def _listed(runs: Sequence[str]) -> str:
    return runs[0] if len(runs) == 1 else f"{len(runs)} runs, {runs[0]} to {runs[-1]}"
