"""Measure how the runout of the farthest point in 3D depends on the width of the sectors of azimuth.

    python scripts/front_sectors.py DIR ...

Prints, for each results folder of a quarter, zeta of the farthest point as the mean over sectors of 10, 5, 2 and 1
degrees. The more points a sector contains, the farther is the farthest of them; the axisymmetric model corresponds to
one sector that is one point wide.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from mpmcol.io.results import Results

WIDTHS = (10.0, 5.0, 2.0, 1.0)  # degrees


def mean_farthest(r: np.ndarray, azimuth: np.ndarray, width: float) -> float:
    """Return the mean over the sectors of a quarter of the largest r in each; r (n,), azimuth (n,) in degrees."""
    sector = np.minimum(azimuth // width, 90.0 // width - 1.0).astype(int)
    farthest = np.zeros(round(90.0 / width))
    np.maximum.at(farthest, sector, r)
    return float(farthest.mean())


def main() -> None:
    """Measure all folders."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="+", type=Path, metavar="DIR", help="results folder of a quarter")
    for folder in parser.parse_args().folders:
        results = Results(folder)
        snapshot, shape = results.snapshot(), results.shape
        x = snapshot.arrays["position"][snapshot.column].astype(float)
        edge, azimuth = np.hypot(x[:, 0], x[:, 2]) + 0.5 * shape.point_size, np.degrees(np.arctan2(x[:, 2], x[:, 0]))
        zeta = [mean_farthest(edge, azimuth, width) / shape.r_i - 1.0 for width in WIDTHS]
        print(folder, *(f"{width:g} deg: {value:.3f}" for width, value in zip(WIDTHS, zeta, strict=True)), sep="  ")


if __name__ == "__main__":
    main()
