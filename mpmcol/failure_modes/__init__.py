"""Catalogue of failure modes: small problems, each run with methods expected to fail and methods expected to pass.

The catalogue is in `scenarios/`, the benchmark problems are in `problems/`. Both expectations are asserted: a method
that passes although it should fail is a defect.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from mpmcol.failure_modes.report import write_report
from mpmcol.failure_modes.scenario import ScenarioOutcome, run_scenario
from mpmcol.failure_modes.scenarios import select_scenarios
from mpmcol.io.atomic import make_folder
from mpmcol.mpm.threads import set_threads

Observer = Callable[[ScenarioOutcome], None]  # called after each scenario


@dataclass(frozen=True)
class CatalogueOutcome:
    """Outcomes of the scenarios, and the files that were written."""

    outcomes: Sequence[ScenarioOutcome]
    files: Sequence[Path]

    @property
    def passed(self) -> bool:
        """Whether every method failed or passed as expected."""
        return all(outcome.verdict == "as expected" for outcome in self.outcomes)


def run_catalogue(names: Sequence[str], out: Path, observer: Observer = lambda outcome: None) -> CatalogueOutcome:
    """Run the scenarios or groups of these names (default: all) on one thread; write tables and charts into `out`.

    Raises UsageError for an unknown name, OutputError if a file cannot be written.
    """
    selected = select_scenarios(names)
    make_folder(out)  # before the scenarios, so that an error is reported at once
    set_threads(1)  # small problems are slower on two
    outcomes = []
    for scenario in selected:
        outcomes.append(run_scenario(scenario))
        observer(outcomes[-1])
    return CatalogueOutcome(outcomes, write_report(outcomes, out))
