"""Forces on walls and mass that overtops a dam, at three spacings, and peaks by window: the tables of walls.md."""

from __future__ import annotations

import sys
from math import radians, sin
from pathlib import Path

import numpy as np

import mpmcol
from mpmcol.io.results import Results
from mpmcol.measure.wall_forces import peak_forces

SPACINGS = (0.0075, 0.005, 0.00375)  # m
WINDOWS = (0.02, 0.05, 0.1, 0.2, 0.5)  # sqrt(h_i / g)
G, RHO, R_I, H_I, PHI = 9.81, 2650.0, 0.09, 0.09, radians(33.0)
ACTIVE = (1.0 - sin(PHI)) / (1.0 + sin(PHI))
LOW = ("walls.0.from=0.12", "walls.0.to=0.15", "friction.floor=0.1", "stages.collapse.max_time_factor=4")
CASES = {  # name -> overrides of the case dam, position of the face that is hit, of the face behind
    "dam": ((), 0.15, 0.18),
    "end wall": (("walls=[{from=0.135, name='dam'}]",), 0.135, 9.0),
    "low dam": ((*LOW, "walls.0.height=0.015"), 0.12, 0.15),
    "higher dam": ((*LOW, "walls.0.height=0.03"), 0.12, 0.15),
}


def row(name: str, results: Results, face: float, behind: float) -> str:
    """One line: peak, final force over rho g h_w^2 / 2, arm over h_w, mass behind the wall over that of the column."""
    forces, snapshot, h = results.summary["wall_forces"]["dam"], results.snapshot(-1), results.shape.spacing
    x, mass = snapshot.x, snapshot.arrays["mass"]
    height = x[(x[:, 0] > face - h) & (x[:, 0] < face), 1].max(initial=0.0) + 0.25 * h
    ratio = forces["at_end"] / (0.5 * RHO * G * height**2)
    arm = forces["moment_at_end"] / forces["at_end"] / height
    over = mass[x[:, 0] > behind].sum() / (RHO * R_I * H_I)
    return (
        f"| {name} | {1e3 * h:.3g} | {forces['peak']:.1f} | {forces['time']:.3f} | {forces['at_end']:.2f} | "
        f"{1e3 * height:.0f} | {ratio:.2f} | {arm:.2f} | {100.0 * over:.1f} |"
    )


def window_row(name: str, results: Results) -> str:
    """One line: the largest mean force over windows in sqrt(h_i / g)."""
    peaks = [peak_forces(results.history, window * (H_I / G) ** 0.5) for window in WINDOWS]
    values = [f"{peak['dam']['peak']:.1f}" for peak in peaks if peak]
    return " | ".join(["", name, f"{1e3 * results.shape.spacing:.3g}", *values, ""]).strip()


def gate_row(results: Results) -> str:
    """Force and arm of the gate before the release, and of the floor."""
    forces, table = results.summary["wall_forces"], results.wall_pressure
    gate, rows = forces["gate"], (table["wall"] == "gate") & (table["state"] == "release")
    exact = ACTIVE * RHO * G * np.maximum(H_I - table["position"][rows], 0.0)
    worst = np.abs(table["pressure"][rows] - exact)[1:-1].max() / exact.max()
    force = gate["at_release"] / (0.5 * ACTIVE * RHO * G * H_I**2)
    return f"gate at rest: force {force:.3f}, arm {gate['moment_at_release'] / gate['at_release'] / H_I:.4f} H, " + (
        f"largest deviation of a row between the first and the last {100.0 * worst:.1f} % of that at the foot"
    )


def main(folder: Path) -> None:
    """Run all cases and print the tables."""
    print(f"K_a = {ACTIVE:.3f}, K_p = {1.0 / ACTIVE:.2f}")
    for name, (overrides, face, behind) in CASES.items():
        for spacing in SPACINGS:
            case = mpmcol.load_case("dam", [*overrides, f"grid.spacing={spacing}", "output.snapshots=6"])
            results = mpmcol.run(case, folder / f"{name}-{spacing}", threads=1, fresh=True)
            print(row(name, results, face, behind), flush=True)
            print(window_row(name, results), flush=True)
            if name == "dam":
                print(gate_row(results), flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "walls"))
