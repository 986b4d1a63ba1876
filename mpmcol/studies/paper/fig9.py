"""Figure 9: cylinders of a = 0.55 and 0.90 at rest, from the side and from above, and their undisturbed tops."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from mpmcol.experiments import find_experiment
from mpmcol.measure import FRONTS
from mpmcol.plotting.captions import heading_of
from mpmcol.plotting.charts import profile_chart
from mpmcol.plotting.render import render
from mpmcol.studies.paper.fig8 import SPACING, cylinder, quarter
from mpmcol.studies.paper.report import Comparison, FigureResult
from mpmcol.studies.runs import CompletedRun, CompletedRuns, StudyRun

TITLE = "Figure 9: cylinders of a = 0.55 and 0.90 at rest"
FRONTS_MM = {0.55: 163.0, 0.9: 205.0}  # empirical, section 3.2
STATED_TOPS = {0.55: "preserved", 0.9: "eroded"}
SIZE = (960, 540)  # pixels of a view from above


def runs(quick: bool) -> list[StudyRun]:
    """Return the quarters as in the paper; with `quick`, the axisymmetric columns."""
    return [cylinder(a, SPACING) if quick else quarter(a) for a in FRONTS_MM]


def evaluate(completed: CompletedRuns, quick: bool) -> FigureResult:
    """Return front in mm, undisturbed radius, profile and view from above of both columns."""
    rows, comparisons, charts = [], [], {}
    for a, run in [(run.a, completed[run]) for run in runs(quick) if run in completed]:
        row, r_i = run.row, run.row["r_i"]
        top = row["undisturbed_radius"]
        fronts = {name: 1e3 * r_i * (1.0 + row[f"zeta.{name}"]) for name in FRONTS}
        rows.append(
            {
                "a": a,
                "model": row["model"],
                **{f"{name}_mm": front for name, front in fronts.items()},
                "paper_mm": FRONTS_MM[a],
                "beta": row["beta"],
                "undisturbed_mm": 1e3 * (top or 0.0),
            }
        )
        comparisons += [
            Comparison(f"a = {a:g}: {name} relative to the empirical {FRONTS_MM[a]:g} mm", front / FRONTS_MM[a] - 1.0)
            for name, front in fronts.items()
        ]
        radius, stated = 1e3 * top if top else None, f"the paper: {STATED_TOPS[a]}"
        comparisons.append(Comparison(f"a = {a:g}: undisturbed radius", radius, unit="mm", comment=stated))
        charts[f"fig9-profile-a{a:g}.png"] = partial(_draw_profile, run=run)
        charts[f"fig9-top-a{a:g}.png"] = partial(_draw_top, run=run)
    return FigureResult(rows, comparisons, charts)


def _draw_profile(path: Path, run: CompletedRun) -> None:
    results = run.results
    deposits = [(results.snapshot(i).time, results.measure(i)) for i in (0, -1)]
    experiment, heading = find_experiment("paper", "axisymmetric"), heading_of(results.case, results.shape)
    profile_chart(path, results.shape, deposits, experiment, heading=heading, at_rest=run.row["at_rest"])


def _draw_top(path: Path, run: CompletedRun) -> None:
    render(run.folder, gif=False, view="top", size=SIZE, out=path)
