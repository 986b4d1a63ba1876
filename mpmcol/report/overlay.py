"""Charts of several runs in common axes."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from math import sqrt
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mpmcol.io.results import Results
from mpmcol.plotting.charts import TIME_LABEL, save_figure
from mpmcol.report.model import Picture
from mpmcol.report.pictures import file_picture

COLOURS = ("black", "#b35806", "#2166ac", "#1b7837", "#762a83", "#01665e")
DASHES = ("-", "--", "-.", ":")


def overlay_pictures(runs: Sequence[Results], names: Sequence[str]) -> list[Picture]:
    """Final profiles, and front and height over time, of all runs."""
    with tempfile.TemporaryDirectory() as folder:
        profiles, fronts = Path(folder) / "profiles.png", Path(folder) / "fronts.png"
        save_figure(_profiles(runs, names), profiles, svg=False)
        save_figure(_fronts(runs, names), fronts, svg=False)
        return [
            file_picture(profiles, "Chart of the final profiles of all runs", "Final profiles"),
            file_picture(
                fronts, "Chart of runout and height of all runs over time", "Runout (front_height) and height"
            ),
        ]


def _profiles(runs: Sequence[Results], names: Sequence[str]) -> Figure:
    """Normalised by the initial radius where the columns differ in size."""
    figure = Figure(figsize=(8.0, 4.0), layout="constrained")
    axes = figure.add_subplot(aspect="equal")
    radii = [results.shape.r_i for results in runs]
    is_same_size = max(radii) - min(radii) <= 1e-9 * max(radii)
    for i, (results, name) in enumerate(zip(runs, names, strict=True)):
        scale = 1e3 if is_same_size else 1.0 / results.shape.r_i
        deposit = results.measure()
        axes.plot(scale * deposit.profile_x, scale * deposit.profile_y, label=name, **_style(i))
    unit = "mm" if is_same_size else "units of $r_i$"
    axes.set(
        xlabel=f"distance from the wall or axis ({unit})", ylabel=f"height ({unit})", xlim=(0, None), ylim=(0, None)
    )
    _finish(axes, len(runs))
    return figure


def _fronts(runs: Sequence[Results], names: Sequence[str]) -> Figure:
    figure = Figure(figsize=(8.0, 6.0), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    for i, (results, name) in enumerate(zip(runs, names, strict=True)):
        shape, history = results.shape, results.history
        released = history["stage"] != "equilibrate"
        time = history["time"][released] / sqrt(shape.h_i / results.case.geometry.gravity)
        upper.plot(time, history["front_height"][released] / shape.r_i - 1.0, label=name, **_style(i))
        lower.plot(time, history["height"][released] / shape.h_i, **_style(i))
    upper.set(ylabel=r"runout $\zeta = (r - r_i)/r_i$ (-)")
    lower.set(ylabel=r"height $h / h_i$ (-)", xlabel=TIME_LABEL)
    lower.grid(color="0.9")
    _finish(upper, len(runs))
    return figure


def _style(index: int) -> dict[str, Any]:
    return {"color": COLOURS[index % len(COLOURS)], "linestyle": DASHES[index // len(COLOURS) % len(DASHES)]}


def _finish(axes: Axes, count: int) -> None:
    axes.grid(color="0.9")
    axes.legend(frameon=False, fontsize="small", ncols=1 if count < 5 else 2)
