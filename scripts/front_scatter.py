"""How far one run's numbers can be trusted: the same column with time steps that differ by a few per cent.

    python scripts/front_scatter.py CASE OUT [--set KEY=VALUE ...] [--threads N]

Prints mean and standard deviation of zeta under each front definition and of beta over runs that differ only in
time.cfl. The flow is chaotic: single grains at the tip land elsewhere when round-off differs.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from mpmcol.case import load_case
from mpmcol.measure import FRONTS
from mpmcol.simulation.run import run

CFL = (0.46, 0.47, 0.48, 0.49, 0.50, 0.51, 0.52, 0.53)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("case")
    parser.add_argument("out", type=Path)
    parser.add_argument("--set", dest="overrides", action="append", default=[])
    parser.add_argument("--threads", type=int)
    asked = parser.parse_args()
    rows = []
    for cfl in CFL:
        case = load_case(asked.case, [*asked.overrides, f"time.cfl={cfl}"])
        measured = run(case, asked.out / f"cfl{cfl:g}", threads=asked.threads, fresh=True).measure()
        rows.append([*(measured.zeta[name] for name in FRONTS), measured.beta])
        print(f"{cfl:.2f}", *(f"{value:8.4f}" for value in rows[-1]), flush=True)
    for name, mean, deviation in zip((*FRONTS, "beta"), np.mean(rows, 0), np.std(rows, 0, ddof=1), strict=True):
        print(f"{name:16s} {mean:.3f} +- {deviation:.3f} ({deviation / mean:.1%})")


if __name__ == "__main__":
    main()
