"""Draw the second figure of the README: the pressure in the deposit of a channel collapse, a = 3.

    python scripts/figures/pressure.py [--runs DIR]

Runs the shipped case channel at a = 3 on a grid of 3 mm into DIR (runs/pressure) unless it is there, and writes
pressure.png beside this script.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import mpmcol
from mpmcol.io.names import RESULT_FILE
from mpmcol.plotting.render import render

TARGET = Path(__file__).with_suffix(".png")
COLUMN = ("geometry.aspect=3", "grid.spacing=0.003", "output.snapshots=1")


def main() -> None:
    """Run the column if needed, and draw it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=Path, default=Path("runs/pressure"), help="folder of the run")
    folder = parser.parse_args().runs
    if not (folder / RESULT_FILE).exists():
        mpmcol.run(mpmcol.load_case("channel", COLUMN), folder)
    render(folder, gif=False, color="pressure", size=(1280, 560), out=TARGET)


if __name__ == "__main__":
    main()
