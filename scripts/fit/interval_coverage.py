"""How often the 90 % intervals of fits contain the friction angle of computed deposits.

    python -m scripts.fit.interval_coverage OUT --count 40 --accuracy 20%

Columns with random model, aspect ratio and friction angle are computed on a fine grid with another time step. The
friction angle is fitted to their runout, and to runout and height, on grids of the accuracy. Writes OUT/intervals.csv
as the fits end; the same command resumes.
"""

from __future__ import annotations

import argparse
import random
from pathlib import Path

import mpmcol
from mpmcol.cli.options import ACCURACY
from mpmcol.sweep.table import csv_text
from scripts.fit.fine_deposit import FRICTION, fine_deposit

RANGE = (18.0, 45.0)
QUANTITIES = (("zeta",), ("zeta", "beta"))


def main() -> None:
    """Compute and fit; print one line for each, and the share of intervals that hold."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--count", type=int, default=40)
    parser.add_argument("--accuracy", default="20%")
    parser.add_argument("--jobs", type=int)
    arguments = parser.parse_args()
    accuracy = ACCURACY.convert(arguments.accuracy, None, None)
    arguments.out.mkdir(parents=True, exist_ok=True)
    rows: list[dict[str, object]] = []
    for number in range(arguments.count):
        draw = random.Random(number)
        case, aspect = draw.choice(("channel", "cylinder")), round(draw.uniform(1.0, 2.0), 2)
        angle = round(draw.uniform(23.0, 41.0), 1)
        folder = arguments.out / f"{number:02}-{case}-a{aspect:g}-{angle:g}deg"
        to = fine_deposit(case, aspect, angle, folder / "deposit")
        for quantities in QUANTITIES:
            found = mpmcol.fit(
                case, {one: to[one] for one in quantities}, {FRICTION: RANGE}, overrides=[f"geometry.aspect={aspect}"],
                accuracy=accuracy, jobs=arguments.jobs, out=folder / "-".join(quantities), notify=lambda line: None,
            )  # fmt: skip
            fitted, interval = found.values[0], found.values[0].interval
            holds = interval is not None and interval[0] <= angle <= interval[1]
            rows.append(
                {"case": case, "a": aspect, "quantities": " ".join(quantities), "angle": angle,
                 "fitted": fitted.value, "standard_error": fitted.error, "grid": (fitted.parts or {}).get("grid"),
                 "holds": holds, "core_seconds": found.record["core_seconds"]}
            )  # fmt: skip
            print(rows[-1], flush=True)
            (arguments.out / "intervals.csv").write_text(csv_text(rows))
    for quantities in QUANTITIES:
        own = [row["holds"] for row in rows if row["quantities"] == " ".join(quantities)]
        print(f"{' and '.join(quantities)}: {sum(map(bool, own))} of {len(own)} intervals hold")


if __name__ == "__main__":
    main()
