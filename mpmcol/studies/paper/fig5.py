"""Figure 5: runout and cost over the spacing of the grid, channel, a = 1."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from mpmcol.measure import FRONTS
from mpmcol.plotting.charts import EXPERIMENT_COLOUR, FRONT_STYLES, save_figure
from mpmcol.studies.paper.errors import QUANTITIES, extrapolate
from mpmcol.studies.paper.report import Report, Verdict
from mpmcol.studies.runs import Found, Member

TITLE = "Figure 5: convergence with the grid, channel, a = 1"
SPACINGS = (0.010, 0.0075, 0.006, 0.005, 0.003, 0.002, 0.0015, 0.001)  # m
QUICK = (0.010, 0.0075, 0.006, 0.005)
CHOSEN = 0.002  # the paper's spacing from here on


def members(quick: bool) -> list[Member]:
    """One run a spacing."""
    return [Member("lube-channel", 1.0, h) for h in (QUICK if quick else SPACINGS)]


def report(found: Found, quick: bool) -> Report:
    """Runout, height and cost of every spacing; cost over that of the coarsest, as in the paper."""
    runs = [found[member] for member in members(quick) if member in found]
    if not runs:
        return Report([], [])
    rows = [_line(run.row, runs[0].row) for run in runs]
    spacing = [row["h_mm"] for row in rows]
    limits = {quantity: extrapolate(spacing, [row[quantity] for row in rows]) for quantity in QUANTITIES}
    verdicts = [
        Verdict(f"{quantity} in the limit of small spacings", limit.value, unit="", comment=f"+- {limit.error:.2g}")
        for quantity, limit in limits.items()
        if limit
    ]
    chosen = next((row for row in rows if abs(row["h_mm"] / CHOSEN * 1e-3 - 1.0) < 0.05), rows[-1])
    for quantity, limit in limits.items():
        if limit:
            number = f"{quantity} at h = {chosen['h_mm']:.3g} mm over its limit"
            verdicts.append(Verdict(number, chosen[quantity] / limit.value - 1.0))
    verdicts.append(Verdict("cost of the finest over that of the coarsest", rows[-1]["cost"], unit="times"))
    return Report(rows, verdicts, {"fig5.png": lambda path: _draw(path, rows)})


def _line(row: dict[str, Any], coarsest: dict[str, Any]) -> dict[str, Any]:
    work = row["points"] * row["steps"]
    return {
        "h_mm": 1e3 * row["spacing_used"], "points": row["column_points"], **{name: row[name] for name in QUANTITIES},
        "law.zeta": row["law.zeta"], "steps": row["steps"], "seconds": row["seconds"],
        "cost": work / (coarsest["points"] * coarsest["steps"]),
    }  # fmt: skip


def _draw(path: Path, rows: list[dict[str, Any]]) -> None:
    figure = Figure(figsize=(7.0, 4.4), layout="constrained")
    axes = figure.subplots()
    h = [row["h_mm"] for row in rows]
    for front in FRONTS:
        axes.plot(h, [row[f"zeta.{front}"] for row in rows], fillstyle="none", label=front, **FRONT_STYLES[front])
    axes.axhline(rows[0]["law.zeta"], color=EXPERIMENT_COLOUR, label="Eq. 37")
    axes.set(xlabel="node spacing $h$ (mm)", ylabel=r"runout $\zeta$ (-)", xlim=(0.0, None), title="channel, a = 1")
    cost = axes.twinx()
    cost.plot(h, [row["cost"] for row in rows], color="#2166ac", marker="x", linestyle="none", label="cost (right)")
    cost.set(yscale="log", ylabel="point-steps over those of the coarsest")
    figure.legend(loc="outside lower center", ncols=5, frameon=False, fontsize="small")
    save_figure(figure, path, svg=False)
