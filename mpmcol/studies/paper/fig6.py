"""Figure 6: runout in the channel against aspect ratio, Mohr-Coulomb and softening sand, loose and dense."""

from __future__ import annotations

from mpmcol.measure import FRONTS
from mpmcol.studies.paper.report import Comparison, Draw, FigureResult, error_summary, law_charts, series_row
from mpmcol.studies.runs import CompletedRun, CompletedRuns, StudyRun, study_run
from mpmcol.sweep.series import Series

TITLE = "Figure 6: runout in the channel"
MATERIALS = {"Mohr-Coulomb": "lube-channel", "loose": "lube-channel-loose", "dense": "lube-channel-dense"}
STATED_ERRORS = {"Mohr-Coulomb": 0.036, "loose": 0.058, "dense": 0.089}  # mean |error| in zeta, section 3.1
STATED_POINTS = (8000, 115000)  # smallest and largest number in the column, approximately
ASPECTS = (1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 7.0, 10.0)
SPACINGS = (0.006, 0.0045, 0.003, 0.002)  # m; the last is the paper's
QUICK_ASPECTS, QUICK_SPACINGS = (1.0, 3.0, 7.0), (0.010, 0.0075, 0.006)
FIG7_ASPECT = 7.0  # of the column that Figure 7 shows in time


def channel_run(case: str, a: float, h: float) -> StudyRun:
    """Return the run of a column; the column of Figure 7 has more snapshots."""
    in_time = case == MATERIALS["Mohr-Coulomb"] and a == FIG7_ASPECT
    return study_run(case, a, h, output__snapshots="20") if in_time else StudyRun(case, a, h)


def runs(quick: bool) -> list[StudyRun]:
    """Return a run for each material, aspect ratio and spacing."""
    aspects, spacings = (QUICK_ASPECTS, QUICK_SPACINGS) if quick else (ASPECTS, SPACINGS)
    return [channel_run(case, a, h) for case in MATERIALS.values() for a in aspects for h in spacings]


def evaluate(completed: CompletedRuns, quick: bool) -> FigureResult:
    """Return errors against Eq. 37 for each definition of the front, on the finest grid and grid-converged."""
    aspects, spacings = (QUICK_ASPECTS, QUICK_SPACINGS) if quick else (ASPECTS, SPACINGS)
    rows, comparisons, charted = [], [], []
    for label, case in MATERIALS.items():
        columns = [[completed[run] for h in spacings if (run := channel_run(case, a, h)) in completed] for a in aspects]
        columns = [column for column in columns if column]
        finest = [column[-1] for column in columns]
        series = [series_row(column, column[-1]) for column in columns]
        for front in FRONTS:
            comparisons += error_summary(series, f"zeta.{front}", label, STATED_ERRORS[label])
        rows += [{"material": label, **row} for row in series]
        charted.append(Series(label, [run.row for run in finest]))
        if finest and label == "Mohr-Coulomb":
            comparisons += _point_counts(finest)
    return FigureResult(rows, comparisons, charts_of(charted))


def charts_of(series: list[Series]) -> dict[str, Draw]:
    """The charts by file name."""
    return law_charts({"fig6.png": "zeta", "fig6-beta.png": "beta"}, MATERIALS.values(), series, "channel")


def _point_counts(finest: list[CompletedRun]) -> list[Comparison]:
    counts = sorted(run.row["column_points"] for run in finest)
    ends = zip(("smallest", "largest"), (counts[0], counts[-1]), STATED_POINTS, strict=True)
    return [
        Comparison(f"{which} number of material points in the column", count, stated, unit="")
        for which, count, stated in ends
    ]
