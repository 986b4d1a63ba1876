"""Figure 5: runout and cost against node spacing, channel, a = 1."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from mpmcol.experiments import find_experiment
from mpmcol.measure import FRONTS
from mpmcol.plotting.figures import save_figure, use_plain_ticks
from mpmcol.plotting.styles import FRONT_STYLES, experiment_style
from mpmcol.studies.convergence import first_order_value
from mpmcol.studies.paper.report import QUANTITIES, Comparison, FigureResult
from mpmcol.studies.runs import CompletedRuns, StudyRun

TITLE = "Figure 5: convergence with the grid, channel, a = 1"
SPACINGS = (0.010, 0.0075, 0.006, 0.005, 0.003, 0.002, 0.0015, 0.001)  # m
QUICK = (0.010, 0.0075, 0.006, 0.005)
PAPER_SPACING = 0.002  # m, which the paper chooses for all further columns


def runs(quick: bool) -> list[StudyRun]:
    """Return one run for each spacing."""
    return [StudyRun("lube-channel", 1.0, h) for h in (QUICK if quick else SPACINGS)]


def evaluate(completed: CompletedRuns, quick: bool) -> FigureResult:
    """Return runout, height and cost of each spacing, and the grid-converged values.

    Cost is relative to that of the coarsest grid, as in the paper.
    """
    done = [completed[run] for run in runs(quick) if run in completed]
    if not done:
        return FigureResult([], [])
    rows = [_row(run.row, done[0].row) for run in done]
    spacings = [row["h_mm"] for row in rows]
    extrapolated = {quantity: first_order_value(spacings, [row[quantity] for row in rows]) for quantity in QUANTITIES}
    converged = {quantity: value for quantity, value in extrapolated.items() if value}
    chosen = next((row for row in rows if abs(row["h_mm"] / PAPER_SPACING * 1e-3 - 1.0) < 0.05), rows[-1])
    comparisons = [
        *(
            Comparison(f"{quantity}, grid-converged", value.value, unit="", comment=f"+- {value.error:.2g}")
            for quantity, value in converged.items()
        ),
        *(
            Comparison(
                f"{quantity} at h = {chosen['h_mm']:.3g} mm relative to its grid-converged value",
                chosen[quantity] / value.value - 1.0,
            )
            for quantity, value in converged.items()
        ),
        Comparison("cost of the finest grid relative to the coarsest", rows[-1]["cost"], unit="times"),
    ]
    return FigureResult(rows, comparisons, {"fig5.png": lambda path: draw(path, rows)})


def _row(row: dict[str, Any], coarsest: dict[str, Any]) -> dict[str, Any]:
    work = row["points"] * row["steps"]
    return {
        "h_mm": 1e3 * row["spacing_used"], "points": row["column_points"], **{name: row[name] for name in QUANTITIES},
        "law.zeta": row["law.zeta"], "steps": row["steps"], "seconds": row["seconds"],
        "cost": work / (coarsest["points"] * coarsest["steps"]),
    }  # fmt: skip


def draw(path: Path, rows: list[dict[str, Any]]) -> None:
    """Draw runout and cost over the spacing, from the rows of the table."""
    figure = Figure(figsize=(7.0, 4.4), layout="constrained")
    axes = figure.subplots()
    h = [row["h_mm"] for row in rows]
    for front in FRONTS:
        axes.plot(h, [row[f"zeta.{front}"] for row in rows], fillstyle="none", label=front, **FRONT_STYLES[front])
    experiment = find_experiment("paper", "plane")
    style = experiment_style(experiment)
    label = f"{experiment.citation} (Eq. 37)"
    axes.axhline(rows[0]["law.zeta"], color=style.colour, linestyle=style.line, label=label)
    axes.set(xlabel="node spacing $h$ (mm)", ylabel=r"runout $\zeta$ (-)", xlim=(0.0, None), title="channel, a = 1")
    cost = axes.twinx()
    cost.plot(h, [row["cost"] for row in rows], color="#2166ac", marker="x", linestyle="none", label="cost (right)")
    cost.set(yscale="log", ylabel="points x steps relative to the coarsest grid")
    use_plain_ticks(cost.yaxis)
    figure.legend(loc="outside lower center", ncols=3, frameon=False, fontsize="small")
    save_figure(figure, path, svg=False)
