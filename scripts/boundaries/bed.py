"""Granular beds on slopes below and above their limit: displacement in 10 sqrt(b / g) of a bed of thickness b.

python scripts/boundaries/bed.py runs/bed            # the table in README.md, some minutes
"""

from __future__ import annotations

import argparse
from math import atan, degrees, radians, sin
from pathlib import Path

import numpy as np

import mpmcol
from mpmcol.io.snapshot import Snapshot
from mpmcol.mpm.particles import BASE

THICKNESS, RADIUS, LENGTH, FRICTION = 0.03, 0.09, 2.0, 33.0  # m; degrees
LIMIT = degrees(atan(sin(radians(FRICTION))))
ROWS = ((0.005, (0.0, 0.5, 0.8, 0.9, 1.0, 1.1)),)  # spacing in m, shares of the limit slope
CASE = (
    f"geometry.radius={RADIUS}", f"geometry.height={THICKNESS}", f"geometry.base_thickness={THICKNESS}",
    f"geometry.domain_length={LENGTH}", f"material.friction_deg={FRICTION}", "material.cohesion=2000",
    "base_material.cohesion=0", "stages.collapse.end=time", "stages.collapse.max_time_factor=10",
    "grid.points_per_cell=4",
)  # fmt: skip  # a column as high as the bed and so cohesive that it stands


def main(out: Path) -> None:
    """Print a row for each slope and spacing."""
    print("| slope | of the limit | h (mm) | bed in front of the column | whole bed |")
    print("|---|---|---|---|---|")
    for spacing, shares in ROWS:
        for share in shares:
            near, anywhere = _displacements(out / f"{1e3 * spacing:g}-{share:g}", spacing, share * LIMIT)
            print(
                f"| {share * LIMIT:.1f} deg | {share:.2f} | {1e3 * spacing:g} | h/{spacing / near:.3g} | "
                f"h/{spacing / anywhere:.3g} |",
                flush=True,
            )


def _displacements(folder: Path, spacing: float, slope: float) -> tuple[float, float]:
    """Largest displacement after the release, m: from 2 b off the column to 2 b off the end, and of all points."""
    overrides = [*CASE, f"geometry.slope_deg={slope}", f"grid.spacing={spacing}"]
    results = mpmcol.run(mpmcol.load_case("granular-bed", overrides), folder)
    (first, _), (last, is_bed) = (_positions(results.snapshot(k)) for k in (0, -1))
    moved, x = np.linalg.norm(last - first, axis=1)[is_bed], last[is_bed, 0]
    inner = (x > RADIUS + 2.0 * THICKNESS) & (x < LENGTH - 2.0 * THICKNESS)
    return float(moved[inner].max()), float(moved.max())


def _positions(snapshot: Snapshot) -> tuple[np.ndarray, np.ndarray]:
    """Positions of all points, in the order of their numbers, and which are those of the bed."""
    order = np.argsort(snapshot.arrays["id"])
    return snapshot.arrays["position"][order], snapshot.arrays["material"][order] == BASE


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path, help="folder of the runs; runs that are done are not repeated")
    main(parser.parse_args().out)
