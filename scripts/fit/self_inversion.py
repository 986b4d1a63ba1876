"""Fits of the friction angle to deposits of known friction, computed at another time step and spacing.

    python -m scripts.fit.self_inversion OUT                          # all columns, hours on two cores
    python -m scripts.fit.self_inversion OUT --columns channel-1 --accuracy 10%

For each column and friction angle a deposit is computed on a fine grid and with another time step. Its runout and
height, corrected for the error of this grid in the study, are then "measured" without error, and the friction angle is
fitted to them on coarser grids. Writes OUT/self_inversion.csv as the fits end; the same command resumes.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import mpmcol
from mpmcol.cli.options import ACCURACY
from mpmcol.sweep.table import csv_text
from scripts.fit.fine_deposit import FRICTION, fine_deposit

COLUMNS = {"channel-1": ("channel", 1.0), "channel-3": ("channel", 3.0), "cylinder-0.9": ("cylinder", 0.9)}
ANGLES = (22.0, 28.5, 33.0, 40.0)
RANGE = (18.0, 45.0)


def main() -> None:
    """Compute and fit; print one line for each."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--columns", nargs="+", choices=COLUMNS, default=list(COLUMNS))
    parser.add_argument("--angles", nargs="+", type=float, default=list(ANGLES))
    parser.add_argument("--accuracy", default="10%")
    parser.add_argument("--jobs", type=int)
    arguments = parser.parse_args()
    accuracy = ACCURACY.convert(arguments.accuracy, None, None)
    arguments.out.mkdir(parents=True, exist_ok=True)
    rows = []
    for name in arguments.columns:
        case, aspect = COLUMNS[name]
        for angle in arguments.angles:
            folder = arguments.out / f"{name}-{angle:g}-{100.0 * accuracy:g}"
            to = fine_deposit(case, aspect, angle, arguments.out / f"{name}-{angle:g}-deposit")
            for quantities in (("zeta",), ("zeta", "beta")):
                found = mpmcol.fit(
                    case, {one: to[one] for one in quantities}, {FRICTION: RANGE},
                    overrides=[f"geometry.aspect={aspect}"], accuracy=accuracy, jobs=arguments.jobs,
                    out=folder / "-".join(quantities),
                )  # fmt: skip
                value = found.values[0]
                rows.append(
                    {"column": name, "accuracy": accuracy, "quantities": " ".join(quantities), "angle": angle,
                     "fitted": value.value, "standard_error": value.error, "runs": found.record["runs"],
                     "core_seconds": found.record["core_seconds"]}
                )  # fmt: skip
                print(rows[-1], flush=True)
                (arguments.out / "self_inversion.csv").write_text(csv_text(rows))


if __name__ == "__main__":
    main()
