"""The figures of Coetzee & Purvance 2026 (doi:10.20944/preprints202605.0398.v1), computed.

A figure is a file here with TITLE, `members(quick)`, its runs, and `report(found, quick)`, what comes of them; to add
one, add a line to FIGURES.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

from mpmcol.provenance import code_version
from mpmcol.studies.paper import factors, fig5, fig6, fig7, fig8, fig9
from mpmcol.studies.paper.report import Report, write_report
from mpmcol.studies.runs import carry_out_members
from mpmcol.sweep.engine import Outcome, unsuccessful
from mpmcol.sweep.runner import SweepObserver

FIGURES: dict[str, ModuleType] = {
    "fig5": fig5, "fig6": fig6, "fig7": fig7, "fig8": fig8, "fig9": fig9, "factors": factors
}  # fmt: skip
RUNS = "runs"


def reproduce(
    names: Sequence[str],
    quick: bool,
    out: Path,
    jobs: int | None = None,
    threads: int | None = None,
    observer: SweepObserver | None = None,
) -> tuple[list[Outcome], dict[str, Report], list[Path]]:
    """Run what the figures need into `out`/runs, completing what is there, and write their reports into `out`.

    Returns how the runs ended, the report of each figure, and the files written.
    """
    needed = (member for name in names for member in FIGURES[name].members(quick))
    outcomes, found = carry_out_members(needed, out / RUNS, jobs, threads, observer)
    if not found:
        raise unsuccessful(outcomes, f"no run of {', '.join(names)} ended well; mpmcol status {out / RUNS} says why")
    reports = {name: FIGURES[name].report(found, quick) for name in names}
    heading = f"mpmcol {code_version()}{', quick: coarse grids, fewer columns' if quick else ''}."
    files = [
        path
        for name, report in reports.items()
        for path in write_report(report, name, FIGURES[name].TITLE, heading, out)
    ]
    return outcomes, reports, files
