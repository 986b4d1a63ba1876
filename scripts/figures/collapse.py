"""Draw the first figure of the README: four moments of a channel collapse with the computed surface.

    python scripts/figures/collapse.py [--runs DIR]

Runs the shipped case lube-channel at a = 3 into DIR (runs/collapse) unless it is there, and writes collapse.png beside
this script.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection

import mpmcol
from mpmcol.experiments import find_experiment
from mpmcol.io.results import Results
from mpmcol.plotting.profiles import outline

TARGET = Path(__file__).with_suffix(".png")
MOMENTS = (1.0, 2.0)  # in sqrt(h_i / g), between release and rest
RIGHT, TOP = 0.56, 0.29  # m
MM = 1e3


def compute(folder: Path) -> Results:
    """The run, computed unless the folder holds it."""
    if (folder / "result.json").exists():
        return Results(folder)
    case = mpmcol.load_case("lube-channel", ["geometry.aspect=3"])
    tau = math.sqrt(case.geometry.h_i / case.geometry.gravity)
    times = ", ".join(f"{moment * tau:.6f}" for moment in MOMENTS)
    return mpmcol.run(mpmcol.load_case("lube-channel", ["geometry.aspect=3", f"output.times=[{times}]"]), folder)


def draw_moment(axes: Axes, results: Results, index: int, largest: float) -> PathCollection:
    """Points coloured by displacement, and the computed surface, of one snapshot."""
    snapshot, measured, geometry = results.snapshot(index), results.measure(index), results.case.geometry
    column = snapshot.column
    moved = np.linalg.norm(snapshot.arrays["displacement"][column], axis=1) * MM
    base = snapshot.x[~column]
    axes.scatter(*base.T[:2] * MM, s=0.4, c="0.8", linewidths=0)
    points = axes.scatter(
        *snapshot.x[column].T[:2] * MM, s=0.7, c=moved, cmap="viridis", vmin=0.0, vmax=largest * MM, linewidths=0
    )
    axes.plot(*outline(measured, MM), "k-", lw=1.2, label="computed surface")
    axes.plot(measured.front["front_height"] * MM, 0.0, "kv", ms=6, label="front (front_height)")
    tau = math.sqrt(geometry.h_i / geometry.gravity)
    axes.set_title(rf"$t = {snapshot.time / tau:.1f}\,\sqrt{{h_i/g}}$", fontsize=11)
    axes.set(xlim=(0.0, RIGHT * MM), ylim=(-0.02 * MM, TOP * MM), aspect="equal")
    axes.spines[["top", "right"]].set_visible(False)
    return points


def main() -> None:
    """Compute what is missing and draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=Path, default=Path("runs/collapse"), metavar="DIR")
    results = compute(parser.parse_args().runs)
    geometry = results.case.geometry
    last = results.snapshot(-1)
    largest = float(np.linalg.norm(last.arrays["displacement"][last.column], axis=1).max())
    figure, panels = plt.subplots(2, 2, figsize=(9.6, 5.6), sharex=True, sharey=True, layout="constrained")
    for index, axes in enumerate(panels.flat):
        points = draw_moment(axes, results, index, largest)
    experiment = find_experiment("lube-2007", "plane")
    zeta = experiment.law("zeta")(geometry.a)  # Eq. 37
    axes.axvline(geometry.r_i * (1.0 + zeta) * MM, color="tab:red", ls="--", lw=1.0, label=experiment.citation)
    axes.set_title(axes.get_title() + ", at rest", fontsize=11)
    handles, labels = axes.get_legend_handles_labels()
    panels[0, 0].legend(handles, labels, loc="upper right", frameon=False, fontsize=10)
    for axes in panels[-1]:
        axes.set_xlabel("x (mm)")
    for axes in panels[:, 0]:
        axes.set_ylabel("y (mm)")
    figure.colorbar(points, ax=panels, label="displacement (mm)", shrink=0.8)
    figure.savefig(TARGET, dpi=110)


if __name__ == "__main__":
    main()
