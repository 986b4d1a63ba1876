"""Noise of the stresses with and without the stress filter, and what it changes.

    python scripts/stress/noise.py OUT [GROUP ...] [--jobs N] [--threads N]

Runs the columns of the groups (default: all) and prints one Markdown table for each. Completed runs in OUT are not
repeated, so that the script can be interrupted and repeated.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path

from mpmcol.io.results import Results
from mpmcol.studies.runs import StudyRun, carry_out, study_run

NONE, FLOW = "none", "flow"
FILTER = "method__stress_filter"
COLUMNS = {  # name: case with the filter, aspect ratio, spacing (m)
    "channel, a = 3": ("channel", 3.0, 0.0045),
    "loose, a = 3": ("channel-loose", 3.0, 0.0045),
    "dense, a = 3": ("channel-dense", 3.0, 0.0045),
    "cylinder, a = 0.9": ("cylinder", 0.9, 0.0035),
}
CLAY = {
    "geometry__radius": "12", "geometry__base_thickness": "1.2", "material__friction_deg": "0.01",
    "material__cohesion": "35000", "material__poissons_ratio": "0.45",
}  # fmt: skip
LIGHT = {  # rigid floor, assigned stress
    "geometry__base": "rigid", "method__wall_impulse": "true", "stages__initial_stress": "k0",
}  # fmt: skip
Rows = dict[str, StudyRun]
HEADER = (
    "column", "zeta: max / height", "beta", "damping, % (times smooth)", "transfer, walls, filter, %", "stress-free, %",
    "p99 / max", "inside, over the weight above", "scatter", "J", "steps of equilibration",
)  # fmt: skip


def _channel(a: float, h: float, **overrides: str) -> StudyRun:
    return study_run("channel", a, h, **overrides)


GROUPS: dict[str, Rows] = {
    "filter": {
        f"{name}, {kind}": study_run(*column, **{FILTER: kind})
        for name, column in COLUMNS.items()
        for kind in (NONE, FLOW)
    },
    "strength": {
        f"strength {strength}": _channel(3.0, 0.0045, method__filter_strength=strength)
        for strength in ("0.125", "0.25", "1", "2", "4")
    },
    "time step": {f"cfl {cfl}": _channel(3.0, 0.0045, time__cfl=cfl) for cfl in ("0.125", "0.25")},
    "points per cell": {
        f"{points} points, {kind}": _channel(1.0, 0.003, grid__points_per_cell=points, **LIGHT, **{FILTER: kind})
        for points in ("4", "9", "16")
        for kind in (NONE, FLOW)
    },
    "points per cell, fine": {
        f"{points} points, {kind}": _channel(1.0, 0.002, grid__points_per_cell=points, **LIGHT, **{FILTER: kind})
        for points in ("4", "9")
        for kind in (NONE, FLOW)
    },
    "stiffness": {
        f"a = {a:g}, E = {stiffness}, {kind}": _channel(a, h, material__youngs_modulus=stiffness, **{FILTER: kind})
        for a, h in ((1.0, 0.003), (3.0, 0.0045))
        for stiffness in ("1e7", "1e6")
        for kind in (NONE, FLOW)
    },
    "clay": {
        f"h = {h} m, {kind}": _channel(0.8, h, **CLAY, **changed)
        for h in (0.6, 0.3)
        for kind, changed in {
            NONE: {FILTER: NONE},
            FLOW: {FILTER: FLOW},
            "cell-averaged strain": {FILTER: NONE, "method__volumetric_strain": "cell"},
        }.items()
    },
}


def row_of(name: str, results: Results) -> Iterator[str]:
    """The cells of a row of the table."""
    summary, history = results.summary, results.history
    shares, stress = summary["dissipation"], summary["stress"]
    loading = history["stage"] == "equilibrate"
    yield name
    yield f"{summary['zeta']['front_max']:.3f} / {summary['zeta']['front_height']:.3f}"
    yield f"{summary['beta']:.3f}"
    yield f"{100 * shares['damping']:.1f} ({shares['damping'] / shares['smooth_damping']:.1f})"
    yield f"{100 * shares['transfer']:.1f}, {100 * shares['walls']:.1f}, {100 * shares['filter']:.1f}"
    yield f"{100 * stress['stress_free']:.0f}"
    yield f"{stress['pressure_p99']:.2f} / {stress['pressure_max']:.2f}"
    yield f"{stress['local_pressure_p1']:z.2f} to {stress['local_pressure_p99']:.2f}"
    yield f"{stress['scatter']:.3f}"
    yield f"{summary['worst_J'][0]:.4f} to {summary['worst_J'][1]:.4f}"
    yield str(int(history["step"][loading][-1]))


def main() -> None:
    """Run the groups and print their tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path, help="folder of the runs")
    parser.add_argument("groups", nargs="*", metavar="GROUP", help=", ".join(GROUPS))
    parser.add_argument("--jobs", type=int)
    parser.add_argument("--threads", type=int, default=1)
    args = parser.parse_intermixed_args()
    for group in args.groups or GROUPS:
        rows = GROUPS[group]
        ended = carry_out(rows.values(), args.out, jobs=args.jobs, threads=args.threads)
        print(f"\n### {group}\n\n| {' | '.join(HEADER)} |\n|{'---|' * len(HEADER)}")
        for name, run in rows.items():
            if run in ended.completed:
                print(f"| {' | '.join(row_of(name, ended.completed[run].results))} |", flush=True)
            else:
                print(f"| {name} | {ended.failures[run]} |", flush=True)


if __name__ == "__main__":
    main()
