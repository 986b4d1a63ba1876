"""Velocity of the flow over its height above floors with friction and without slip.

python scripts/boundaries/floor_profile.py runs/floor_profile      # the table in friction.md, some minutes
"""

from __future__ import annotations

import argparse
from math import sqrt
from pathlib import Path

import numpy as np

import mpmcol
from mpmcol.case import load_case

TIME = 0.15  # s after the release
FRONT, BACK = 0.02, 0.08  # m in front of the gate, between which points are averaged
ROWS = 8  # of half a cell
FLOORS = {
    "no slip": "friction={}",
    "0.545": "friction.floor=0.545",
    "0.268": "friction.floor=0.268",
    "0.1": "friction.floor=0.1",
}
SETTINGS = ("output.wall_forces=false", "output.snapshots=1", "stages.collapse.end=time")


def profile(folder: Path, floor: str) -> np.ndarray:
    """Mean velocity along the floor by height, (ROWS,), m/s."""
    geometry = load_case("frictional-floor").geometry
    duration = TIME / sqrt(geometry.h_i / geometry.gravity)
    case = load_case("frictional-floor", [*SETTINGS, floor, f"stages.collapse.max_time_factor={duration}"])
    last = mpmcol.run(case, folder).snapshot(-1)
    x, v = last.arrays["position"].astype(float), last.arrays["velocity"][:, 0].astype(float)
    row = np.floor(x[:, 1] / (0.5 * case.grid.spacing)).astype(int)
    inside = (x[:, 0] > geometry.r_i + FRONT) & (x[:, 0] < geometry.r_i + BACK)
    return np.array([v[inside & (row == number)].mean() for number in range(ROWS)])


def main(out: Path) -> None:
    """Print a row for each floor."""
    print("| floor | " + " | ".join(f"{0.5 * k:g} to {0.5 * (k + 1):g} h" for k in range(ROWS)) + " |")
    print("|---" * (ROWS + 1) + "|")
    for number, (name, floor) in enumerate(FLOORS.items()):
        row = profile(out / str(number), floor)
        print(f"| {name} | " + " | ".join(f"{one:.3f}" for one in row) + " |", flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    main(parser.parse_args().out)
