"""Figure 9: cylinders of a = 0.55 and 0.90 at rest, from the side and from above, and what of their top stays."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from mpmcol.experiments import find_experiment
from mpmcol.plotting.charts import profile_chart
from mpmcol.plotting.render import render
from mpmcol.studies.paper.fig8 import SPACING, cylinder, quarter
from mpmcol.studies.paper.report import Report, Verdict
from mpmcol.studies.runs import Finished, Found, Member

TITLE = "Figure 9: cylinders of a = 0.55 and 0.90 at rest"
FRONTS_MM = {0.55: 163.0, 0.9: 205.0}  # empirical, section 3.2
SIZE = (960, 540)  # pixels of a view from above


def members(quick: bool) -> list[Member]:
    """The quarter as in the paper; quick, the axisymmetric model."""
    return [cylinder(a, SPACING) if quick else quarter(a) for a in FRONTS_MM]


def report(found: Found, quick: bool) -> Report:
    """Runout in mm, undisturbed radius, profile and view from above of both."""
    runs = [(member.a, found[member]) for member in members(quick) if member in found]
    rows, verdicts, charts = [], [], {}
    for a, run in runs:
        row, r_i = run.row, run.row["r_i"]
        still = row["undisturbed_radius"]
        fronts = {
            name: 1e3 * r_i * (1.0 + row[f"zeta.{name}"]) for name in ("front_max", "front_connected", "front_height")
        }
        rows.append(
            {
                "a": a,
                "model": row["model"],
                **{f"{name}_mm": value for name, value in fronts.items()},
                "paper_mm": FRONTS_MM[a],
                "beta": row["beta"],
                "undisturbed_mm": 1e3 * (still or 0.0),
            }
        )
        verdicts += [
            Verdict(
                f"a = {a:g}: runout distance over the empirical {FRONTS_MM[a]:g} mm, {name}", value / FRONTS_MM[a] - 1.0
            )
            for name, value in fronts.items()
        ]
        preserved = "the paper: preserved" if a < 1.0 - 0.3 else "the paper: eroded"
        verdicts.append(
            Verdict(f"a = {a:g}: undisturbed radius", 1e3 * still if still else None, unit="mm", comment=preserved)
        )
        charts[f"fig9-profile-a{a:g}.png"] = partial(_draw_profile, run=run)
        charts[f"fig9-top-a{a:g}.png"] = partial(_draw_top, run=run)
    return Report(rows, verdicts, charts)


def _draw_profile(path: Path, run: Finished) -> None:
    results = run.results
    deposits = [(results.snapshot(i).time, results.measure(i)) for i in (0, -1)]
    profile_chart(path, results.shape, deposits, find_experiment("paper", "axisymmetric"), at_rest=run.row["at_rest"])


def _draw_top(path: Path, run: Finished) -> None:
    render(run.folder, gif=False, view="top", size=SIZE, out=path)
