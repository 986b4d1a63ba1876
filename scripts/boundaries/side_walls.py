"""Runout of a column in channels with friction on their side walls, against the two published laws.

python scripts/boundaries/side_walls.py runs/side_walls      # table and chart side-walls.png, some minutes
"""

from __future__ import annotations

import argparse
from itertools import product
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt

import mpmcol
from mpmcol.experiments import EXPERIMENTS
from mpmcol.plotting.styles import RUN_COLOURS, RUN_LINES, experiment_style

RADIUS = 0.09  # r_i, m
ASPECTS = (0.5, 1.0, 1.5, 2.0, 3.0)
CHANNELS = (  # friction angle in degrees, width W in m; 0.46 m: W / r_i of a channel of 0.1 m and r_i = 19.5 mm
    (0, 0.2), (15, 0.46), (22, 0.46), (15, 0.2), (22, 0.2), (15, 0.1), (22, 0.1),
)  # fmt: skip
DRAWN = ((0, 0.2), (22, 0.46), (15, 0.2), (22, 0.2), (22, 0.1))
CASE = (
    "geometry.base=rigid", "method.wall_impulse=true", "stages.initial_stress=k0", "material.youngs_modulus=2e6",
    "stages.collapse.max_time_factor=20",
)  # fmt: skip
Runout = dict[tuple[float, float, float], float]


def main(out: Path, cells: int) -> None:
    """Print a row for each channel, with zeta and its ratio to that without friction, and draw the chart."""
    found = {(*channel, a): _zeta(out, cells, *channel, a) for channel, a in product(CHANNELS, ASPECTS)}
    print("| side walls | W / r_i | " + " | ".join(f"a = {a:g}" for a in ASPECTS) + " |")
    print("|---|---|" + "---|" * len(ASPECTS))
    for angle, width in CHANNELS:
        smooth = [found[(*CHANNELS[0], a)] for a in ASPECTS]
        cells_of_row = [
            f"{found[angle, width, a]:.2f} ({found[angle, width, a] / s:.2f})"
            for a, s in zip(ASPECTS, smooth, strict=True)
        ]
        print(f"| {angle} deg | {width / RADIUS:.1f} | {' | '.join(cells_of_row)} |")
    _draw(found, out / "side-walls.png")


def _zeta(out: Path, cells: int, angle: float, width: float, a: float) -> float:
    """Runout by `front_height`; a column that still moves at the end of the run is reported."""
    overrides = [
        *CASE, f"geometry.aspect={a}", f"grid.spacing={RADIUS / cells}", f"friction.side_walls={angle} deg",
        f"friction.channel_width={width}",
    ]  # fmt: skip
    summary = mpmcol.run(mpmcol.load_case("channel", overrides), out / f"{cells}-{angle}-{width}-{a}").summary
    if not summary["at_rest"]:
        print(f"not at rest: {angle} deg, W = {width} m, a = {a}")
    return float(summary["zeta"]["front_height"])


def _draw(found: Runout, file: Path) -> None:
    figure, axes = plt.subplots(figsize=(7.0, 4.6), layout="constrained")
    for k, (angle, width) in enumerate(DRAWN):
        label = rf"side walls {angle} deg, $W = {width / RADIUS:.1f}\,r_i$" if angle else "smooth side walls"
        values = [found[angle, width, a] / a for a in ASPECTS]
        axes.plot(ASPECTS, values, marker="o", color=RUN_COLOURS[k], linestyle=RUN_LINES[k], label=label)
    for name in ("lube-2005", "lube-2007"):
        experiment = EXPERIMENTS[name]
        style, law = experiment_style(experiment), next(one for one in experiment.laws if one.quantity == "zeta")
        piece = law.pieces[0]
        label = f"{experiment.citation}, {piece.prefactor:g}$\\,a$"
        axes.plot([piece.lo, piece.hi], 2 * [piece.prefactor], color=style.colour, linestyle=style.line, label=label)
    axes.set(xlabel="aspect ratio $a$", ylabel=r"runout over aspect ratio, $\zeta / a$", ylim=(0.0, 1.8))
    figure.legend(loc="outside lower center", ncols=2)
    figure.savefig(file, dpi=150)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path, help="folder of the runs and the chart; runs that are done are not repeated")
    parser.add_argument("--cells", type=int, default=20, help="r_i / h")
    asked = parser.parse_args()
    main(asked.out, asked.cells)
