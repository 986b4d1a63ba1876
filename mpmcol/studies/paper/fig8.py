"""Figure 8: runout and height of cylinders over the aspect ratio, axisymmetric and as a quarter in 3D."""

from __future__ import annotations

from functools import partial

from mpmcol.experiments import find_experiment
from mpmcol.measure import FRONTS
from mpmcol.studies.paper.errors import QUANTITIES, compare, summaries
from mpmcol.studies.paper.report import Report, Verdict
from mpmcol.studies.runs import Found, Member, with_settings
from mpmcol.sweep.charts import sweep_chart
from mpmcol.sweep.series import ASPECT_COLUMN, Series

TITLE = "Figure 8: runout and height of cylinders"
ASPECTS = (0.55, 0.9, 1.7, 2.75, 5.0, 7.0)
QUARTER_ASPECTS = (0.55, 0.9, 1.7, 2.75, 7.0)  # those that the paper's text names
SPACING = 0.005  # m, the paper's
SPACINGS = (0.010, 0.007, SPACING, 0.0035, 0.0025)
QUICK_SPACINGS = (0.010, 0.007, SPACING)
ZETA, ZETA_LARGEST, BETA, BETA_LARGEST = 0.038, 0.078, 0.021, 0.041  # errors that section 3.2 states
STATED_POINTS = {0.55: 25000, 7.0: 322000}  # in the column, about


def cylinder(a: float, h: float) -> Member:
    """The axisymmetric column."""
    return Member("lube-cylinder", a, h)


def quarter(a: float) -> Member:
    """The column as the paper models it."""
    return with_settings("lube-quarter", a, SPACING)


def members(quick: bool) -> list[Member]:
    """The axisymmetric series at all spacings; in full also the quarter at the paper's."""
    flat = [cylinder(a, h) for a in ASPECTS for h in (QUICK_SPACINGS if quick else SPACINGS)]
    return flat if quick else flat + [quarter(a) for a in QUARTER_ASPECTS]


def report(found: Found, quick: bool) -> Report:
    """Errors against Eq. 38-40, and the quarter beside the axisymmetric model at the same spacing."""
    lines, verdicts, charted = [], [], []
    spacings = QUICK_SPACINGS if quick else SPACINGS
    for label, finest in (("axisymmetric", SPACING), ("axisymmetric, finest", spacings[-1])):
        pairs = [(a, [found[m] for h in spacings if (m := cylinder(a, h)) in found]) for a in ASPECTS]
        own = [compare(runs, found[cylinder(a, finest)]) for a, runs in pairs if cylinder(a, finest) in found]
        if label == "axisymmetric" or not quick:
            lines += [{"model": label, **line} for line in own]
            verdicts += _verdicts(own, label)
            charted.append(Series(label, [found[m].row for a in ASPECTS if (m := cylinder(a, finest)) in found]))
    solid = [] if quick else [found[m] for a in QUARTER_ASPECTS if (m := quarter(a)) in found]
    if solid:
        own = [compare([run], run) for run in solid]
        lines += [{"model": "quarter", **line} for line in own]
        verdicts += _verdicts(own, "quarter") + _models(found)
        charted.append(Series("quarter", [run.row for run in solid]))
    experiment = find_experiment("paper", "axisymmetric")
    draw = partial(sweep_chart, axis=ASPECT_COLUMN, series=charted, experiment=experiment, title="cylinder")
    return Report(
        lines,
        verdicts,
        {"fig8-zeta.png": lambda path: draw(path, "zeta"), "fig8-beta.png": lambda path: draw(path, "beta")},
    )


def _verdicts(lines: list[dict[str, object]], label: str) -> list[Verdict]:
    found = [v for front in FRONTS for v in summaries(lines, f"zeta.{front}", label, ZETA, ZETA_LARGEST)]
    return found + summaries(lines, "beta", label, BETA, BETA_LARGEST)


def _models(found: Found) -> list[Verdict]:
    """How far the quarter and the axisymmetric model are apart at the paper's spacing, and their points."""
    pairs = {
        a: (found[quarter(a)].row, found[cylinder(a, SPACING)].row)
        for a in QUARTER_ASPECTS
        if quarter(a) in found and cylinder(a, SPACING) in found
    }
    apart = [
        Verdict(f"a = {a:g}, {quantity}: quarter over axisymmetric", solid[quantity] / flat[quantity] - 1.0)
        for a, (solid, flat) in pairs.items()
        for quantity in QUANTITIES
    ]
    counts = [
        Verdict(f"a = {a:g}: material points in the column", pairs[a][0]["column_points"], paper, unit="")
        for a, paper in STATED_POINTS.items()
        if a in pairs
    ]
    return apart + counts
