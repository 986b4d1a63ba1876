"""Runout, height and stop time of channels and cylinders with each law: a sweep for each law, tables and chart.

    python -m scripts.laws.which_law OUT [--model channel|cylinder] [--law NAME] [--aspect A,...] [--spacing H]
    python -m scripts.laws.which_law OUT --stored

which_law.toml defines columns and laws. Finished runs in OUT are not repeated; the script can be interrupted and
repeated. In full it takes some hours. Writes which_law.csv, which_law.md and laws.png from all finished runs in OUT.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import mpmcol
from mpmcol.errors import MpmcolError
from scripts.laws.chart import draw
from scripts.laws.study import Study, read_study
from scripts.laws.tables import markdown, read_rows, stored_rows, write_rows


def main() -> None:
    """Run the sweeps unless the results are stored, print the tables and draw the chart."""
    study = read_study()
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--model", choices=tuple(study.columns))
    parser.add_argument("--law", choices=tuple(study.laws))
    parser.add_argument("--aspect", help="default: those of the file")
    parser.add_argument("--spacing", default="0.0045", help="m; default: %(default)s")
    parser.add_argument("--stored", action="store_true", help="start no runs")
    options = parser.parse_args()
    if not options.stored:
        run(study, options)
    found = stored_rows(study, options.out)
    if not found:
        parser.error(f"{options.out} has no finished runs of this study")
    write_rows(found, options.out / "which_law.csv")
    rows = read_rows(options.out / "which_law.csv")  # with the digits of the file, from which the tables follow
    text = markdown(study, rows)
    print(text)
    (options.out / "which_law.md").write_text(text, encoding="utf-8")
    draw(study, rows, options.out / "laws.png")


def run(study: Study, options: argparse.Namespace) -> None:
    """The sweeps of the chosen columns and laws."""
    for column, law in study.pairs():
        if options.model in (None, column) and options.law in (None, law):
            case = study.load(column, law, f"grid.spacing={options.spacing}")
            mpmcol.sweep(case, aspect=options.aspect or study.aspects(law), out=options.out / f"{column}-{law}")


if __name__ == "__main__":
    try:
        main()
    except MpmcolError as error:
        raise SystemExit(f"error: {error}") from None
