"""Run the paper's Mohr-Coulomb series at its node spacing or at half of it, and update scripts/paper_series.csv.

    python scripts/paper_series.py OUT [--threads N] [--only channel|cylinder|quarter] [--halved] [--aspect A,...]

Completed runs in OUT and rows that are already in the table are not repeated; the script can therefore be interrupted
and repeated. Prints the table as Markdown.
"""

from __future__ import annotations

import argparse
import csv
from pathlib import Path
from typing import Any

from mpmcol import __version__
from mpmcol.case import load_case
from mpmcol.experiments import find_experiment
from mpmcol.io.results import Results
from mpmcol.measure import FRONTS
from mpmcol.simulation.run import run

SERIES = {
    "channel": ("lube-channel", 0.002, (1.0, 2.0, 3.0, 5.0, 7.0, 10.0)),
    "cylinder": ("lube-cylinder", 0.005, (0.55, 0.9, 1.7, 2.75, 5.0, 7.0)),
    "quarter": ("lube-quarter", 0.005, (0.55, 0.9, 1.7, 2.75, 7.0)),
}
TABLE = Path(__file__).with_suffix(".csv")
COLUMNS = (
    "case", "a", "h_mm", "points", *FRONTS, "front_max_range", "zeta_law", "beta", "beta_law", "J_min", "J_max",
    "end_over_tau", "steps", "ns_per_point_step", "minutes", "version",
)  # fmt: skip

Member = tuple[str, float, float]  # case, aspect ratio, spacing (m)


def members(only: str | None, halved: bool, aspects: list[float] | None) -> list[Member]:
    """Return the selected members, cheapest first."""
    return [
        (case, a, spacing * (0.5 if halved else 1.0))
        for name, (case, spacing, series) in SERIES.items()
        for a in series
        if only in (None, name) and (aspects is None or a in aspects)
    ]


def simulate(member: Member, out: Path, threads: int | None) -> Results:
    """Run a member, or return its completed run."""
    case, a, spacing = member
    folder = out / f"{case}-a{a:g}-h{spacing * 1e3:g}mm"
    if (folder / "result.json").exists() and Results(folder).summary["status"] == "done":
        return Results(folder)
    print(folder.name, flush=True)
    overrides = [f"geometry.aspect={a}", f"grid.spacing={spacing}"]
    return run(
        load_case(case, overrides), folder, threads=threads, fresh=True, notify=lambda s: print(" ", s, flush=True)
    )


def make_row(member: Member, results: Results) -> dict[str, Any]:
    """Return the row of a run."""
    summary, measured, (case, a, spacing) = results.summary, results.measure(), member
    geometry, ranges = results.case.geometry, measured.zeta_range
    experiment = find_experiment("paper", geometry.model, geometry.section)
    laws = {quantity: experiment.expected(quantity, a) for quantity in ("zeta", "beta")}
    return {
        "case": case, "a": f"{a:g}", "h_mm": f"{spacing * 1e3:g}", "points": summary["points"],
        **{name: f"{measured.zeta[name]:.4f}" for name in FRONTS}, "beta": f"{measured.beta:.4f}",
        "front_max_range": "-".join(f"{zeta:.3f}" for zeta in ranges["front_max"]) if ranges else "",
        **{f"{name}_law": "" if law is None else f"{law[0]:.4f}" for name, law in laws.items()},
        "J_min": f"{summary['worst_J'][0]:.4f}", "J_max": f"{summary['worst_J'][1]:.4f}",
        "end_over_tau": f"{summary['time_over_tau']:.2f}", "steps": summary["steps"],
        "ns_per_point_step": f"{summary['ns_per_point_step']:.0f}",
        "minutes": f"{sum(summary['wall_s'].values()) / 60.0:.1f}", "version": __version__,
    }  # fmt: skip


def read_table() -> dict[Member, dict[str, Any]]:
    """Read the rows by member."""
    if not TABLE.exists():
        return {}
    with TABLE.open(newline="") as file:
        rows = list(csv.DictReader(file))
    return {(row["case"], float(row["a"]), float(row["h_mm"]) * 1e-3): row for row in rows}


def save(member: Member, row: dict[str, Any]) -> None:
    """Add a row to the table, or replace the one of this member."""
    rows = read_table() | {member: row}
    with TABLE.open("w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows[key] for key in sorted(rows, key=lambda m: (m[0], -m[2], m[1])))


def markdown(rows: list[dict[str, Any]]) -> str:
    """Format the table."""

    def compared(value: str, law: str) -> str:
        return f"{float(value):.3f} ({float(value) / float(law) - 1.0:+.0%})" if law else f"{float(value):.3f}"

    lines = ["| case | a | h (mm) | zeta: front_max | front_connected | front_height | law | beta | law |"]
    lines.append("|---" * 9 + "|")
    for row in rows:
        zeta = [compared(row[name], row["zeta_law"]) for name in FRONTS]
        if row["front_max_range"]:  # over azimuth
            zeta[0] += f" {row['front_max_range']}"
        laws = [f"{float(row[law]):.3f}" if row[law] else "none" for law in ("zeta_law", "beta_law")]
        cells = [row["case"], row["a"], row["h_mm"], *zeta, laws[0], compared(row["beta"], row["beta_law"]), laws[1]]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def main() -> None:
    """Run the selected members and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path, help="folder of the runs")
    parser.add_argument("--threads", type=int)
    parser.add_argument("--only", choices=list(SERIES), help="one series")
    parser.add_argument("--halved", action="store_true", help="half the paper's spacing")
    parser.add_argument(
        "--aspect", type=lambda text: [float(a) for a in text.split(",")], help="aspect ratios, separated by commas"
    )
    args = parser.parse_args()
    for member in members(args.only, args.halved, args.aspect):
        if not any(known[:2] == member[:2] and abs(known[2] / member[2] - 1.0) < 1e-6 for known in read_table()):
            save(member, make_row(member, simulate(member, args.out, args.threads)))
    print(markdown(list(read_table().values())))


if __name__ == "__main__":
    main()
