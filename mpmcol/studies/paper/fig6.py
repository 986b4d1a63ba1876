"""Figure 6: runout of channel columns over the aspect ratio, Mohr-Coulomb and softening sand, loose and dense."""

from __future__ import annotations

from functools import partial

from mpmcol.experiments import find_experiment
from mpmcol.measure import FRONTS
from mpmcol.studies.paper.errors import compare, summaries
from mpmcol.studies.paper.report import Report, Verdict
from mpmcol.studies.runs import Finished, Found, Member, with_settings
from mpmcol.sweep.charts import sweep_chart
from mpmcol.sweep.series import ASPECT_COLUMN, Series

TITLE = "Figure 6: runout in the channel"
MATERIALS = {"Mohr-Coulomb": "lube-channel", "loose": "lube-channel-loose", "dense": "lube-channel-dense"}
STATED = {"Mohr-Coulomb": 0.036, "loose": 0.058, "dense": 0.089}  # mean |error| in zeta, section 3.1
STATED_POINTS = (8000, 115000)  # in the column, about
ASPECTS = (1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 7.0, 10.0)
SPACINGS = (0.006, 0.0045, 0.003, 0.002)  # m; the last is the paper's
QUICK_ASPECTS, QUICK_SPACINGS = (1.0, 3.0, 7.0), (0.010, 0.0075, 0.006)
FILMED = 7.0  # Figure 7 looks at this one in time


def series_member(case: str, a: float, h: float) -> Member:
    """A column of the series; of the one that Figure 7 shows, more snapshots are kept."""
    filmed = case == MATERIALS["Mohr-Coulomb"] and a == FILMED
    return with_settings(case, a, h, output__snapshots="20") if filmed else Member(case, a, h)


def members(quick: bool) -> list[Member]:
    """All materials, aspect ratios and spacings."""
    aspects, spacings = (QUICK_ASPECTS, QUICK_SPACINGS) if quick else (ASPECTS, SPACINGS)
    return [series_member(case, a, h) for case in MATERIALS.values() for a in aspects for h in spacings]


def report(found: Found, quick: bool) -> Report:
    """Errors against Eq. 37 under each definition of the front, at the finest spacing and extrapolated."""
    aspects, spacings = (QUICK_ASPECTS, QUICK_SPACINGS) if quick else (ASPECTS, SPACINGS)
    lines, verdicts, charted = [], [], []
    for label, case in MATERIALS.items():
        groups = [[found[m] for h in spacings if (m := series_member(case, a, h)) in found] for a in aspects]
        finest = [group[-1] for group in groups if group]
        own = [compare(group, group[-1]) for group in groups if group]
        for front in FRONTS:
            verdicts += summaries(own, f"zeta.{front}", label, STATED[label])
        lines += [{"material": label, **line} for line in own]
        charted.append(Series(label, [run.row for run in finest]))
        if finest and label == "Mohr-Coulomb":
            verdicts += _counts(finest)
    experiment = find_experiment("paper", "plane")
    draw = partial(sweep_chart, axis=ASPECT_COLUMN, series=charted, experiment=experiment, title="channel")
    return Report(
        lines, verdicts, {"fig6.png": lambda path: draw(path, "zeta"), "fig6-beta.png": lambda path: draw(path, "beta")}
    )


def _counts(finest: list[Finished]) -> list[Verdict]:
    counts = sorted(run.row["column_points"] for run in finest)
    ends = zip(("fewest", "most"), (counts[0], counts[-1]), STATED_POINTS, strict=True)
    return [Verdict(f"{which} material points in the column", n, paper, unit="") for which, n, paper in ends]
