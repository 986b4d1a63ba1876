"""Draw the charts of Figures 5, 6 and 8 again from the tables (CSV) beside them.

    python scripts/paper/redraw.py [DIR ...]

DIR: folders with tables of `mpmcol paper` (default: the folder of this script and those in it). Figures 7 and 9 show
snapshots, which are not kept here: `mpmcol paper fig7 fig9` draws them.
"""

from __future__ import annotations

import argparse
import csv
from itertools import groupby
from pathlib import Path
from typing import Any

from mpmcol.studies.paper import fig5, fig6, fig8
from mpmcol.sweep.series import Series

HERE = Path(__file__).parent
FIGURES = {"fig6": fig6, "fig8": fig8}


def read(path: Path) -> list[dict[str, Any]]:
    """The rows of a table, with numbers and true or false where a cell has them."""
    with path.open(newline="", encoding="utf-8") as file:
        return [{name: value_of(text) for name, text in row.items()} for row in csv.DictReader(file)]


def value_of(text: str) -> Any:
    """A cell as a value."""
    if text in ("true", "false"):
        return text == "true"
    try:
        return float(text)
    except ValueError:
        return text or None


def redraw(folder: Path) -> list[Path]:
    """Draw the charts for which the folder has tables; returns their paths."""
    drawn = []
    if (folder / "fig5.csv").exists():
        drawn.append(folder / "fig5.png")
        fig5.draw(drawn[-1], read(folder / "fig5.csv"))
    for name, figure in FIGURES.items():
        if (table := folder / f"{name}.csv").exists():
            rows = groupby(read(table), key=lambda row: row.get("material") or row.get("model"))
            for file, draw in figure.charts_of([Series(label, list(group)) for label, group in rows]).items():
                draw(folder / file)
                drawn.append(folder / file)
    return drawn


def main() -> None:
    """Draw what the folders have tables for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="*", type=Path, metavar="DIR")
    folders = parser.parse_args().folders or [HERE, *sorted(path for path in HERE.iterdir() if path.is_dir())]
    for path in [path for folder in folders for path in redraw(folder)]:
        print(path)


if __name__ == "__main__":
    main()
