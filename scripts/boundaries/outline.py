"""Heaps of several slopes on a rigid floor: displacement and loss of height in 10 sqrt(h_i / g) after the release.

python scripts/boundaries/outline.py runs/outline            # the table in outline.md, some minutes
"""

from __future__ import annotations

import argparse
from math import radians, tan
from pathlib import Path

import numpy as np

import mpmcol

WIDTH = 0.3  # m, at the base
ROWS = (  # model, spacing in m, slopes in degrees
    ("plane", 0.01, (20, 25, 28, 30, 31, 32, 33, 34, 36, 40)),
    ("plane", 0.005, (25, 28, 30, 32, 34)),
    ("axisymmetric", 0.01, (20, 25, 28, 30, 32, 34, 36)),
)


def main(out: Path) -> None:
    """Print a row for each run."""
    print("| model | h (mm) | slope (deg) | largest displacement / h | loss of height | runout zeta |")
    print("|---|---|---|---|---|---|")
    for model, spacing, slopes in ROWS:
        for slope in slopes:
            print(_row(out / f"{model}-{1e3 * spacing:g}-{slope}", model, spacing, slope), flush=True)


def _row(folder: Path, model: str, spacing: float, slope: float) -> str:
    outline = [[0.0, 0.0], [WIDTH, 0.0], [0.0, WIDTH * tan(radians(slope))]]
    overrides = [
        f"geometry.outline={outline}", f"geometry.model={model}", "geometry.release=one-sided",
        f"grid.spacing={spacing}", "grid.points_per_cell=4", "stages.collapse.end=time",
    ]  # fmt: skip
    results = mpmcol.run(mpmcol.load_case("heap", overrides), folder)
    snapshots = map(results.snapshot, range(len(results.snapshots)))
    largest = max(np.linalg.norm(one.arrays["displacement"][one.column], axis=1).max() for one in snapshots)
    first, last = results.measure(0), results.measure()
    return (
        f"| {model} | {1e3 * spacing:g} | {slope} | {largest / spacing:.2g} | {1.0 - last.height / first.height:.2%} | "
        f"{last.zeta['front_height'] - first.zeta['front_height']:+.3f} |"
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path, help="folder of the runs; runs that are done are not repeated")
    main(parser.parse_args().out)
