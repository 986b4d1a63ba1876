"""Every experiment that is shipped, passed or failed against a band that was written down beforehand.

A check is an entry of CHECKS in `mpmcol.studies.validation.checks`. What it measures is a function in
`measures.py`; its band belongs to the experiment, not to the grid, and is never widened for a coarse
one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from mpmcol.selection import select
from mpmcol.studies.runs import Found, carry_out_members
from mpmcol.studies.validation.check import Check, Judgement, judge
from mpmcol.studies.validation.checks import CHECKS
from mpmcol.studies.validation.report import Other, other_laws, write_report
from mpmcol.sweep.engine import Outcome, unsuccessful
from mpmcol.sweep.runner import SweepObserver

RUNS = "runs"


@dataclass(frozen=True)
class Validation:
    """What came of the checks, and the files that were written."""

    outcomes: Sequence[Outcome]
    judgements: Sequence[Judgement]
    others: Sequence[Other]  # what other experiments would say: for information
    files: Sequence[Path]

    @property
    def passed(self) -> bool:
        """Whether all checks that have a verified reference have passed."""
        return all(judgement.verdict in ("passed", "unverified") for judgement in self.judgements)


def choose(names: Sequence[str]) -> list[Check]:
    """The checks of these names, or whose names begin with one and a hyphen; all of them without names.

    Raises UsageError for a name that means none.
    """
    return select(CHECKS, names, "check")


def validate(
    names: Sequence[str],
    quick: bool,
    out: Path,
    jobs: int | None = None,
    threads: int | None = None,
    observer: SweepObserver | None = None,
) -> Validation:
    """Run what the checks need into `out`/runs, completing what is there, and write tables and charts into `out`."""
    chosen = choose(names)
    needed = [member for check in chosen for member in check.members(quick)]
    outcomes, found = carry_out_members(needed, out / RUNS, jobs, threads, observer)
    if not found:
        raise unsuccessful(outcomes, f"no run of the checks ended well; mpmcol status {out / RUNS} says why")
    judgements = [judge(check, found, quick) for check in chosen]
    others = _others(chosen, found, quick)
    return Validation(outcomes, judgements, others, write_report(judgements, others, found, quick, out))


def _others(chosen: Sequence[Check], found: Found, quick: bool) -> list[Other]:
    """What the laws that no check is made of say of the columns, each once."""
    columns = dict.fromkeys(check.column for check in chosen)
    firsts = [found[column.members(quick)[0]] for column in columns if column.members(quick)[0] in found]
    return [other for run in firsts for other in other_laws(run)]
