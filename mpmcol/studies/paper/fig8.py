"""Figure 8: runout and height of cylinders against aspect ratio, axisymmetric and as a quarter in 3D."""

from __future__ import annotations

from mpmcol.measure import FRONTS
from mpmcol.studies.paper.report import (
    QUANTITIES,
    Comparison,
    Draw,
    FigureResult,
    error_summary,
    law_charts,
    series_row,
)
from mpmcol.studies.runs import CompletedRuns, StudyRun
from mpmcol.sweep.series import Series

TITLE = "Figure 8: runout and height of cylinders"
ASPECTS = (0.55, 0.9, 1.7, 2.75, 5.0, 7.0)
QUARTER_ASPECTS = (0.55, 0.9, 1.7, 2.75, 7.0)  # those that the text of the paper names
SPACING = 0.005  # m, the paper's
SPACINGS = (0.010, 0.007, SPACING, 0.0035, 0.0025)
QUICK_SPACINGS = (0.010, 0.007, SPACING)
ZETA, ZETA_LARGEST, BETA, BETA_LARGEST = 0.038, 0.078, 0.021, 0.041  # errors that section 3.2 states
STATED_POINTS = {0.55: 25000, 7.0: 322000}  # in the column, approximately


def cylinder(a: float, h: float) -> StudyRun:
    """Return the run of an axisymmetric column."""
    return StudyRun("lube-cylinder", a, h)


def quarter(a: float) -> StudyRun:
    """Return the run of a column as the paper models it."""
    return StudyRun("lube-quarter", a, SPACING)


def runs(quick: bool) -> list[StudyRun]:
    """Return the axisymmetric series at all spacings; unless `quick`, also the quarter at the paper's."""
    flat = [cylinder(a, h) for a in ASPECTS for h in (QUICK_SPACINGS if quick else SPACINGS)]
    return flat if quick else flat + [quarter(a) for a in QUARTER_ASPECTS]


def evaluate(completed: CompletedRuns, quick: bool) -> FigureResult:
    """Return errors against Eq. 38-40, and the quarter beside the axisymmetric model at the same spacing."""
    rows, comparisons, charted = [], [], []
    spacings = QUICK_SPACINGS if quick else SPACINGS
    for label, finest in (("axisymmetric", SPACING), ("axisymmetric, finest", spacings[-1])):
        columns = [(a, [completed[run] for h in spacings if (run := cylinder(a, h)) in completed]) for a in ASPECTS]
        series = [
            series_row(column, completed[run]) for a, column in columns if (run := cylinder(a, finest)) in completed
        ]
        if label == "axisymmetric" or not quick:
            rows += [{"model": label, **row} for row in series]
            comparisons += _comparisons(series, label)
            done = [completed[run] for a in ASPECTS if (run := cylinder(a, finest)) in completed]
            charted.append(Series(label, [run.row for run in done]))
    solid = [] if quick else [completed[run] for a in QUARTER_ASPECTS if (run := quarter(a)) in completed]
    if solid:
        series = [series_row([run], run) for run in solid]
        rows += [{"model": "quarter", **row} for row in series]
        comparisons += _comparisons(series, "quarter") + _model_comparisons(completed)
        charted.append(Series("quarter", [run.row for run in solid]))
    return FigureResult(rows, comparisons, charts_of(charted))


def charts_of(series: list[Series]) -> dict[str, Draw]:
    """The charts by file name."""
    return law_charts({"fig8-zeta.png": "zeta", "fig8-beta.png": "beta"}, ["lube-cylinder"], series, "cylinder")


def _comparisons(series: list[dict[str, object]], label: str) -> list[Comparison]:
    zeta = [one for front in FRONTS for one in error_summary(series, f"zeta.{front}", label, ZETA, ZETA_LARGEST)]
    return zeta + error_summary(series, "beta", label, BETA, BETA_LARGEST)


def _model_comparisons(completed: CompletedRuns) -> list[Comparison]:
    """Compare the quarter with the axisymmetric model at the paper's spacing, and its number of points."""
    pairs = {
        a: (completed[quarter(a)].row, completed[cylinder(a, SPACING)].row)
        for a in QUARTER_ASPECTS
        if quarter(a) in completed and cylinder(a, SPACING) in completed
    }
    differences = [
        Comparison(f"a = {a:g}, {quantity}: quarter relative to axisymmetric", solid[quantity] / flat[quantity] - 1.0)
        for a, (solid, flat) in pairs.items()
        for quantity in QUANTITIES
    ]
    counts = [
        Comparison(f"a = {a:g}: material points in the column", pairs[a][0]["column_points"], stated, unit="")
        for a, stated in STATED_POINTS.items()
        if a in pairs
    ]
    return differences + counts
