"""Validation: numbers of published experiments, each computed and compared with a band that was fixed beforehand.

A check is an entry of CHECKS in `checks.py`; what it measures is a function in `measures.py`. Its band belongs to the
experiment, not to the grid, and is the same on coarse grids.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from mpmcol.errors import select
from mpmcol.studies.runs import EndedRuns, StudyRun
from mpmcol.studies.validation.check import Check, CheckResult, evaluate_check
from mpmcol.studies.validation.checks import CHECKS
from mpmcol.studies.validation.report import OtherLaw, other_laws, write_report


@dataclass(frozen=True)
class Validation:
    """Results of the checks, and comparisons with the laws of other experiments for information."""

    results: Sequence[CheckResult]
    others: Sequence[OtherLaw]

    @property
    def passed(self) -> bool:
        """Whether every check that can pass or fail has passed: checks with unverified bands do not count."""
        return all(result.verdict == "passed" for result in self.counted)

    @property
    def counted(self) -> list[CheckResult]:
        """Results of the checks with verified bands."""
        return [result for result in self.results if result.check.band.verified]


@dataclass(frozen=True)
class ValidationStudy:
    """Some of the checks as a study (see `mpmcol.studies.frame.Study`)."""

    checks: Sequence[Check]
    quick: bool  # coarse grids, each column once

    def runs(self) -> Iterable[StudyRun]:
        """Return the runs of all checks and of their negative controls."""
        return (run for check in self.checks for run in check.runs(self.quick))

    def evaluate(self, ended: EndedRuns) -> Validation:
        """Evaluate all checks."""
        results = [evaluate_check(check, ended.completed, self.quick) for check in self.checks]
        columns = dict.fromkeys(check.column for check in self.checks)
        first = ended.completed_of(column.runs(self.quick)[0] for column in columns)
        return Validation(results, [other for run in first for other in other_laws(run)])

    def write_report(self, evaluation: Validation, heading: str, out: Path) -> list[Path]:
        """Write validation.csv, validation.md and charts."""
        heading = f"{heading}{'; quick: coarse grids, each column once' if self.quick else ''}."
        return write_report(evaluation.results, evaluation.others, self.quick, heading, out)


def select_checks(names: Sequence[str]) -> list[Check]:
    """Select checks by name or by group (rods, channel, cylinder); all of them without names.

    Raises UsageError for an unknown name.
    """
    return select(CHECKS, names, "check")
