"""How the farthest point's runout in 3D depends on how finely it is looked at around the axis.

    python scripts/front_sectors.py DIR ...

For each results folder of a quarter: zeta of the farthest point, mean over sectors of azimuth of 10, 5, 2 and 1
degrees. The more points a sector holds, the farther the farthest of them is; the axisymmetric model has one sector that
is one point wide.
"""

from __future__ import annotations

import sys

import numpy as np

from mpmcol.io.results import Results

WIDTHS = (10.0, 5.0, 2.0, 1.0)  # degrees


def mean_farthest(r: np.ndarray, azimuth: np.ndarray, width: float) -> float:
    """Mean over the sectors of a quarter of the largest r in each; r (n,), azimuth (n,) in degrees, 0 to 90."""
    sector = np.minimum(azimuth // width, 90.0 // width - 1.0).astype(int)
    farthest = np.zeros(round(90.0 / width))
    np.maximum.at(farthest, sector, r)
    return float(farthest.mean())


def main() -> None:
    for folder in sys.argv[1:]:
        results = Results(folder)
        snapshot, shape = results.snapshot(), results.shape
        x = snapshot.arrays["position"][snapshot.column].astype(float)
        edge, azimuth = np.hypot(x[:, 0], x[:, 2]) + 0.5 * shape.point_size, np.degrees(np.arctan2(x[:, 2], x[:, 0]))
        zeta = [mean_farthest(edge, azimuth, width) / shape.r_i - 1.0 for width in WIDTHS]
        print(folder, *(f"{width:g} deg: {value:.3f}" for width, value in zip(WIDTHS, zeta, strict=True)), sep="  ")


if __name__ == "__main__":
    main()
