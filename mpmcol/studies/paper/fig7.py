"""Figure 7: the channel column a = 7 in time, and its deposit against the universal shape of Lube et al. 2005.

The times of the six frames and the digitised free surfaces are not in the paper's text; compared are the final shape,
and the state whose front stands where the law's does.
"""

from __future__ import annotations

from math import sqrt
from pathlib import Path

import numpy as np

from mpmcol.experiments import find_experiment
from mpmcol.measure import Array, Measurement
from mpmcol.plotting.charts import profile_chart
from mpmcol.studies.paper.fig6 import FILMED, MATERIALS, QUICK_SPACINGS, SPACINGS, series_member
from mpmcol.studies.paper.report import Report, Verdict
from mpmcol.studies.runs import Finished, Found, Member

TITLE = "Figure 7: the channel column a = 7 in time"
FRAMES = 6  # besides the deposit at rest
SHAPE = "lube-2005"


def members(quick: bool) -> list[Member]:
    """The run at the finest spacing of Figure 6."""
    return [series_member(MATERIALS["Mohr-Coulomb"], FILMED, (QUICK_SPACINGS if quick else SPACINGS)[-1])]


def report(found: Found, quick: bool) -> Report:
    """Front and height in time, and distances to the universal shape."""
    runs = [found[member] for member in members(quick) if member in found]
    if not runs:
        return Report([], [])
    results = runs[0].results
    times = [results.snapshot(i).time for i in range(len(results.snapshots))]
    released = [i for i, time in enumerate(times) if time >= 0.0]
    states = {times[i]: results.measure(i) for i in released}
    tau = sqrt(results.shape.h_i / results.case.geometry.gravity)
    rows = [
        {
            "t_s": time,
            "t_over_tau": time / tau,
            **{f"zeta.{k}": v for k, v in state.zeta.items()},
            "beta": state.beta,
        }
        for time, state in states.items()
    ]
    chosen = [released[k] for k in np.linspace(0, len(released) - 1, FRAMES + 1).round().astype(int)]
    deposits = [(times[i], results.measure(i)) for i in chosen]
    chart = {"fig7.png": lambda path: _draw(path, runs[0], deposits)}
    return Report(rows, _shape_verdicts(runs[0], states) + _end_verdicts(runs[0]), chart)


def _shape_verdicts(run: Finished, states: dict[float, Measurement]) -> list[Verdict]:
    """RMS distance of surfaces to the universal shape, over the deposit's height or the law's."""
    row, shape = run.row, run.results.shape
    surface = find_experiment(SHAPE, "plane").profiles[0]
    x, y = np.array(surface.x), np.array(surface.y)
    front, height = shape.r_i * (1.0 + row["law.zeta"]), shape.h_i * row["law.beta"]
    last = list(states.values())[-1]
    matched = min(states, key=lambda time: abs(states[time].front["front_height"] - front))
    own = _rms(last, last.front["front_height"] * x, last.height * y) / last.height
    return [
        Verdict("deposit against the universal shape, scaled to its own front and height: RMS over height", own),
        Verdict("deposit against that shape with the laws' front and height: RMS over height",
                _rms(last, front * x, height * y) / height),
        Verdict("the state whose front is nearest to the law's against that shape: RMS over height",
                _rms(states[matched], front * x, height * y) / height, comment=f"t = {matched:.3f} s"),
    ]  # fmt: skip


def _end_verdicts(run: Finished) -> list[Verdict]:
    row, low = run.row, "the paper: slightly lower than measured at later times"
    return [
        Verdict("zeta.front_height at rest over the law's", row["zeta.front_height"] / row["law.zeta"] - 1.0),
        Verdict("height at rest over the law's", row["beta"] / row["law.beta"] - 1.0, comment=low),
    ]


def _rms(state: Measurement, x: Array, y: Array) -> float:
    """Root mean square of the difference in height over the length of the surface x, y, m."""
    station = np.linspace(x[0], x[-1], 1001)
    difference = np.interp(station, state.profile_x, state.profile_y, right=0.0) - np.interp(station, x, y)
    return float(np.sqrt(np.mean(difference**2)))


def _draw(path: Path, run: Finished, deposits: list[tuple[float, Measurement]]) -> None:
    profile_chart(path, run.results.shape, deposits, find_experiment("lube-2005", "plane"), at_rest=run.row["at_rest"])
