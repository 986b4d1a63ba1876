"""Runout, height and stop time of channels and cylinders with each law: table (Markdown), chart, a sweep for each law.

    python scripts/laws/which_law.py OUT [--model channel|cylinder] [--law NAME] [--aspect A,...] [--spacing H]

Finished runs in OUT are not repeated; the script can be interrupted and repeated. In full it takes some hours.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt

import mpmcol
from mpmcol.plotting.styles import RUN_COLOURS, RUN_LINES

ASPECTS = "0.5,0.75,1,1.5,2,3,5,7,10"
CHEAP = (
    "geometry.base=rigid", "method.wall_impulse=true", "stages.initial_stress=k0", "grid.points_per_cell=9",
    "time.cfl=0.45", "stages.equilibrate.damping=0.5", "output.snapshots=1",
)  # fmt: skip
UNDAMPED = "stages.collapse.damping=0"
ELASTIC = "youngs_modulus=3.5e6, poissons_ratio=0.2"
RATE = "I_0=0.279, grain_density={}, grain_diameter={}"  # Jop, Forterre & Pouliquen 2006
BEADS = f"law='mu-i', density=1500.0, {ELASTIC}, mu_s=0.3819, mu_2=0.6435, {RATE.format(2450.0, 0.53e-3)}"
# as strong as the sand of the paper in slow plane flow, mu_s = sin(33 deg), with the increase of the beads
SAND = f"law='mu-i', density=1600.0, {ELASTIC}, mu_s=0.5446, mu_2=0.8062, {RATE.format(2650.0, 0.32e-3)}"


def softening(case: str) -> str:
    """The material of a shipped case with a softening law, but with the moduli of the others."""
    values = mpmcol.load_case(case).material.model_dump(exclude_none=True) | {"youngs_modulus": 3.5e6}
    return "material={" + ", ".join(f"{key}={value!r}" for key, value in values.items()) + "}"


def laws() -> dict[str, tuple[str, ...]]:
    """Overrides by the name of the law."""
    sand = f"material={{law='mohr-coulomb', density=2650.0, {ELASTIC}, friction_deg=33.0}}"
    return {
        "mohr-coulomb-damped": (sand, "stages.collapse.damping=0.05"),
        "mohr-coulomb": (sand, UNDAMPED),
        "softening-loose": (softening("channel-loose"), UNDAMPED),
        "softening-dense": (softening("channel-dense"), UNDAMPED),
        "mu-i-beads": (f"material={{{BEADS}}}", UNDAMPED),
        "mu-i-sand": (f"material={{{SAND}}}", UNDAMPED),
        "drucker-prager": (
            sand.replace("mohr-coulomb", "drucker-prager").replace("}", ", match='plane-strain'}"),
            UNDAMPED,
        ),
    }


def row(name: str, model: str, one: dict[str, Any]) -> str:
    """A row of the table."""
    values = [one["a"], one["zeta.front_height"], one["law.zeta"], one["beta"], one["law.beta"], one["stop_time"]]
    return f"| {name} | {model} | " + " | ".join("" if value is None else f"{value:.3g}" for value in values) + " |"


def draw(results: dict[tuple[str, str], list[dict[str, Any]]], file: Path) -> None:
    """Chart of zeta and beta over their values in the experiments, by the aspect ratio."""
    models = list(dict.fromkeys(model for model, _ in results))
    figure, panels = plt.subplots(
        2, len(models), figsize=(4.8 * len(models), 6.4), sharex=True, sharey="row", squeeze=False, layout="constrained"
    )
    for column, model in enumerate(models):
        for axes, quantity, name in zip(
            panels[:, column], ("zeta.front_height", "beta"), ("runout", "height"), strict=True
        ):
            for k, law in enumerate(law for of_model, law in results if of_model == model):
                found = [one for one in results[model, law] if one[f"law.{quantity.partition('.')[0]}"]]
                ratios = [one[quantity] / one[f"law.{quantity.partition('.')[0]}"] for one in found]
                axes.plot(
                    [one["a"] for one in found], ratios, marker="o", markersize=4.0, color=RUN_COLOURS[k],
                    linestyle=RUN_LINES[k], label=law if found and axes is panels[0, 0] else None,
                )  # fmt: skip
            axes.axhspan(0.9, 1.1, color="0.92")  # scatter of the experiments
            axes.set(xscale="log", ylabel=f"{name} over that of the experiment" if column == 0 else "")
        panels[0, column].set_title(model)
        panels[1, column].set(xlabel="aspect ratio $a$", xticks=(0.5, 1, 2, 5, 10), xticklabels=(0.5, 1, 2, 5, 10))
        panels[1, column].minorticks_off()
    figure.legend(loc="outside lower center", ncols=3)
    figure.savefig(file, dpi=150)


def main() -> None:
    """Run the sweeps, print the table and draw the chart."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--model", choices=("channel", "cylinder"))
    parser.add_argument("--law", choices=tuple(laws()))
    parser.add_argument("--aspect", default=ASPECTS)
    parser.add_argument("--spacing", default="0.0045")
    options = parser.parse_args()
    rows = ["| law | model | a | zeta | zeta, experiment | beta | beta, experiment | stop time |", "|---" * 8 + "|"]
    found = {}
    for model in [options.model] if options.model else ["channel", "cylinder"]:
        for name, overrides in laws().items():
            if options.law in (None, name):
                case = mpmcol.load_case(model, [*CHEAP, f"grid.spacing={options.spacing}", *overrides])
                results = mpmcol.sweep(case, aspect=options.aspect, out=options.out / f"{model}-{name}")
                found[model, name] = [one for one in results.rows if one["status"] == "done"]
                rows += [row(name, model, one) for one in found[model, name]]
    print("\n".join(rows))
    draw(found, options.out / "laws.png")


if __name__ == "__main__":
    main()
