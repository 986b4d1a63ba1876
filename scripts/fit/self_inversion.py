"""Fits of the friction angle to deposits of known friction, computed at another time step and spacing.

    python scripts/fit/self_inversion.py OUT                          # all columns, hours on two cores
    python scripts/fit/self_inversion.py OUT --columns channel-1 --accuracy 10%

For each column and friction angle a deposit is computed on the grid of the accuracy, refined by FINER and with another
time step. Its runout and height are then "measured" without error, and the friction angle is fitted to them.
Writes OUT/self_inversion.csv as the fits end; the same command resumes.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import mpmcol
from mpmcol.cli.options import ACCURACY
from mpmcol.studies.pareto.recommend import recommend
from mpmcol.sweep.table import csv_text

COLUMNS = {"channel-1": ("channel", 1.0), "channel-3": ("channel", 3.0), "cylinder-0.9": ("cylinder", 0.9)}
ANGLES = (22.0, 28.5, 33.0, 40.0)
RANGE = (18.0, 45.0)
FINER, CFL = 1.13, 0.43  # of the deposit that is "measured": r_i/h over that of the fit, Courant number
FRICTION = "material.friction_deg"
NO_ERROR = 1e-3  # relative standard error of the "measurement"


def deposit(case: str, aspect: float, angle: float, accuracy: float, out: Path) -> dict[str, tuple[float, float]]:
    """Runout and height of a column of known friction, with standard errors."""
    values = [f"geometry.aspect={aspect}", f"{FRICTION}={angle}"]
    advice = recommend(case, values, accuracy)
    base = mpmcol.load_case(case, [*values, *advice.overrides])
    grid = [f"grid.spacing={base.geometry.r_i / round(FINER * advice.cells)}", f"time.cfl={CFL}"]
    results = mpmcol.run(mpmcol.load_case(case, [*values, *advice.overrides, *grid]), out, threads=1)
    measured = results.measure()
    found = {"zeta": measured.zeta["front_height"], "beta": measured.beta}
    return {name: (value, NO_ERROR * value) for name, value in found.items()}


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
            to = deposit(case, aspect, angle, accuracy, folder / "deposit")
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
