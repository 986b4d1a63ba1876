"""Run the paper's Mohr-Coulomb series at its grid spacing and at half of it, and write the table of the README.

    python scripts/paper_series.py OUT [--threads N] [--only channel|cylinder] [--halved] [--table]

Finished runs are kept, so the script can be stopped and started again. --table only writes OUT/series.md.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from mpmcol.case import load_case
from mpmcol.experiments import find_experiment
from mpmcol.measure import FRONTS
from mpmcol.results import Results
from mpmcol.simulation import run

SERIES = {
    "channel": ("lube-channel", 0.002, (1.0, 2.0, 3.0, 5.0, 7.0, 10.0)),
    "cylinder": ("lube-cylinder", 0.005, (0.55, 0.9, 2.75, 5.0, 7.0)),
}
HEADER = (
    "| case | a | h (mm) | points | zeta front_max | front_connected | front_height | experiment | beta | experiment | "
    "worst J | minutes |\n" + "|---" * 12 + "|"
)


def members(only: str | None, halved: bool) -> list[tuple[str, float, float]]:
    """(case, aspect, spacing), cheapest first."""
    factor = 0.5 if halved else 1.0
    return [
        (case, a, spacing * factor)
        for name, (case, spacing, aspects) in SERIES.items()
        if only in (None, name)
        for a in aspects
    ]


def folder_of(out: Path, case: str, a: float, spacing: float) -> Path:
    return out / f"{case}-a{a:g}-h{spacing * 1e3:g}mm"


def is_done(folder: Path) -> bool:
    return (folder / "result.json").exists() and Results(folder).summary["status"] == "done"


def row(folder: Path) -> str:
    """One row of the table."""
    results = Results(folder)
    s, case = results.summary, results.case
    experiment = find_experiment("paper", case.geometry.model)

    def against(quantity: str, value: float) -> str:
        expected = experiment.expected(quantity, case.geometry.a)
        return f"{value:.3f}" if expected is None else f"{value:.3f} ({value / expected[0] - 1.0:+.1%})"

    def law(quantity: str) -> str:
        expected = experiment.expected(quantity, case.geometry.a)
        return "no law" if expected is None else f"{expected[0]:.3f}"

    measured = results.measure()
    zeta = [against("zeta", measured.zeta[name]) for name in FRONTS]
    cells = [
        folder.name.split("-a")[0], f"{case.geometry.a:g}", f"{s['spacing_used'] * 1e3:.3g}", f"{s['points']}", *zeta,
        law("zeta"), against("beta", measured.beta), law("beta"), f"{s['worst_J'][0]:.3f} ... {s['worst_J'][1]:.3f}",
        f"{sum(s['wall_s'].values()) / 60.0:.1f}",
    ]  # fmt: skip
    return "| " + " | ".join(cells) + " |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path)
    parser.add_argument("--threads", type=int)
    parser.add_argument("--only", choices=list(SERIES))
    parser.add_argument("--halved", action="store_true", help="half the paper's spacing")
    parser.add_argument("--table", action="store_true", help="only write the table of what is finished")
    asked = parser.parse_args()
    for case, a, spacing in [] if asked.table else members(asked.only, asked.halved):
        folder = folder_of(asked.out, case, a, spacing)
        if not is_done(folder):
            print(folder.name, flush=True)
            overrides = [f"geometry.aspect={a}", f"grid.spacing={spacing}"]
            run(
                load_case(case, overrides),
                folder,
                threads=asked.threads,
                fresh=True,
                say=lambda s: print(" ", s, flush=True),
            )
    finished = [folder_of(asked.out, *member) for halved in (False, True) for member in members(None, halved)]
    table = [HEADER, *(row(folder) for folder in finished if is_done(folder))]
    (asked.out / "series.md").write_text("\n".join(table) + "\n")
    print("\n".join(table))


if __name__ == "__main__":
    main()
