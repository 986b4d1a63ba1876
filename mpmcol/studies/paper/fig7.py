"""Figure 7: the channel column a = 7 in time, and its deposit against the universal shape of Lube et al. 2005.

The text of the paper contains neither the times of the six frames nor the digitised surfaces. The deposit at rest, and
the state whose front is at the position of the law, are therefore compared with the universal shape.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mpmcol.experiments import find_experiment
from mpmcol.experiments.height_difference import rms_difference
from mpmcol.measure import Measurement
from mpmcol.plotting.captions import heading_of
from mpmcol.plotting.charts import profile_chart
from mpmcol.studies.paper.fig6 import FIG7_ASPECT, MATERIALS, QUICK_SPACINGS, SPACINGS, channel_run
from mpmcol.studies.paper.report import Comparison, FigureResult
from mpmcol.studies.runs import CompletedRun, CompletedRuns, StudyRun

TITLE = "Figure 7: the channel column a = 7 in time"
FRAMES = 6  # besides the deposit at rest
SHAPE = "lube-2005"


def runs(quick: bool) -> list[StudyRun]:
    """Return the run of Figure 6 on the finest grid."""
    return [channel_run(MATERIALS["Mohr-Coulomb"], FIG7_ASPECT, (QUICK_SPACINGS if quick else SPACINGS)[-1])]


def evaluate(completed: CompletedRuns, quick: bool) -> FigureResult:
    """Return front and height in time, and the distances to the universal shape."""
    done = [completed[run] for run in runs(quick) if run in completed]
    if not done:
        return FigureResult([], [])
    results = done[0].results
    times = [results.snapshot(i).time for i in range(len(results.snapshots))]
    released = [i for i, time in enumerate(times) if time >= 0.0]
    states = {times[i]: results.measure(i) for i in released}
    tau = results.fall_time
    rows = [
        {
            "t_s": time,
            "t_over_tau": time / tau,
            **{f"zeta.{name}": zeta for name, zeta in state.zeta.items()},
            "beta": state.beta,
        }
        for time, state in states.items()
    ]
    frames = [released[k] for k in np.linspace(0, len(released) - 1, FRAMES + 1).round().astype(int)]
    deposits = [(times[i], results.measure(i)) for i in frames]
    chart = {"fig7.png": lambda path: _draw(path, done[0], deposits)}
    return FigureResult(rows, _shape_comparisons(done[0], states) + _end_comparisons(done[0]), chart)


def _shape_comparisons(run: CompletedRun, states: dict[float, Measurement]) -> list[Comparison]:
    """Return RMS distances to the universal shape, relative to the height of the deposit or of the law."""
    row, shape = run.row, run.results.shape
    surface, experiment = find_experiment(SHAPE, "plane").profiles[0], find_experiment("paper", "plane")
    x, y = np.array(surface.x), np.array(surface.y)
    front, height = shape.r_i * (1.0 + row["law.zeta"]), shape.h_i * row["law.beta"]
    last = list(states.values())[-1]
    matched = min(states, key=lambda time: abs(states[time].front["front_height"] - front))
    own = rms_difference(last.profile, (last.front["front_height"] * x, last.height * y)) / last.height
    return [
        Comparison("deposit against the universal shape, scaled to its own front and height: RMS over height", own),
        Comparison(f"deposit against that shape with front and height of {experiment.label('beta')}: RMS over height",
                   rms_difference(last.profile, (front * x, height * y)) / height),
        Comparison("state whose front is nearest to the law's against that shape: RMS over height",
                   rms_difference(states[matched].profile, (front * x, height * y)) / height,
                   comment=f"t = {matched:.3f} s"),
    ]  # fmt: skip


def _end_comparisons(run: CompletedRun) -> list[Comparison]:
    row, lower = run.row, "the paper: slightly lower than measured at later times"
    zeta, beta = row["zeta.front_height"] / row["law.zeta"] - 1.0, row["beta"] / row["law.beta"] - 1.0
    return [
        Comparison("zeta.front_height at rest relative to the law", zeta),
        Comparison(
            f"height at rest relative to {find_experiment('paper', 'plane').label('beta')}", beta, comment=lower
        ),
    ]


def _draw(path: Path, run: CompletedRun, deposits: list[tuple[float, Measurement]]) -> None:
    results, experiment = run.results, find_experiment(SHAPE, "plane")
    heading = heading_of(results.case, results.shape)
    profile_chart(path, results.shape, deposits, experiment, heading=heading, at_rest=run.row["at_rest"])
