"""Measure the scatter of single runs: the same column with time steps that differ by a few per cent.

    python scripts/front_scatter.py CASE OUT [--set KEY=VALUE ...] [--threads N]

Prints mean and standard deviation of zeta, for each definition of the front, and of beta over runs that differ only in
`time.cfl`. The flow is sensitive to round-off: single points at the front end at different positions.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from mpmcol.case import load_case
from mpmcol.measure import FRONTS
from mpmcol.simulation.run import run
from mpmcol.studies.runs import CFL, repeated_cfl


def main() -> None:
    """Run the column with each time step and print the statistics."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("case", help="case file or shipped case")
    parser.add_argument("out", type=Path, help="folder of the runs")
    parser.add_argument("--set", dest="overrides", action="append", default=[], metavar="KEY=VALUE")
    parser.add_argument("--threads", type=int)
    args = parser.parse_args()
    rows = []
    for cfl in repeated_cfl(0.5, 8, first=-0.08, step=0.02):
        case = load_case(args.case, [*args.overrides, f"{CFL}={cfl}"])
        measured = run(case, args.out / f"cfl{cfl}", threads=args.threads, fresh=True).measure()
        rows.append([*(measured.zeta[name] for name in FRONTS), measured.beta])
        print(f"{float(cfl):.2f}", *(f"{value:8.4f}" for value in rows[-1]), flush=True)
    for name, mean, deviation in zip((*FRONTS, "beta"), np.mean(rows, 0), np.std(rows, 0, ddof=1), strict=True):
        print(f"{name:16s} {mean:.3f} +- {deviation:.3f} ({deviation / mean:.1%})")


if __name__ == "__main__":
    main()
