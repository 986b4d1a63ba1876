"""Results of the study of laws: rows from the sweeps, CSV, and Markdown tables of values and of differences."""

from __future__ import annotations

import csv
from collections import defaultdict
from collections.abc import Iterator, Sequence
from pathlib import Path
from statistics import fmean
from typing import NamedTuple

from mpmcol.case import conditions_of
from mpmcol.experiments import EXPERIMENTS, mark, score
from mpmcol.sweep.table import CSV_FILE, read_table
from scripts.laws.study import QUANTITIES, Quantity, Study

UNVERIFIED = "*"
INTRODUCTION = f"""Output of `python -m scripts.laws.which_law`. Runout is zeta by `front_height`, height is beta, stop
time is in sqrt(h_i/g). Values with {UNVERIFIED} are unverified: see
[mpmcol/experiments](../../mpmcol/experiments/README.md)."""


class Row(NamedTuple):
    """Result of a run: zeta by `front_height`, beta, and the stop time in sqrt(h_i/g)."""

    column: str
    law: str
    a: float
    zeta: float
    beta: float
    stop_time: float


def stored_rows(study: Study, out: Path) -> list[Row]:
    """Rows of the finished runs in a folder, in the order of the study."""
    return [row for column, law in study.pairs() for row in _rows_of_sweep(column, law, out / f"{column}-{law}")]


def _rows_of_sweep(column: str, law: str, folder: Path) -> Iterator[Row]:
    if (folder / CSV_FILE).exists():
        for one in read_table(folder / CSV_FILE):
            if one["status"] == "done":
                yield Row(column, law, *(float(one[key]) for key in ("a", "zeta.front_height", "beta", "stop_time")))


def write_rows(rows: Sequence[Row], file: Path) -> None:
    """CSV with five digits."""
    with file.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(Row._fields)
        writer.writerows([*row[:2], *(f"{value:.5g}" for value in row[2:])] for row in rows)


def read_rows(file: Path) -> list[Row]:
    """Rows of a file of `write_rows`."""
    with file.open(newline="", encoding="utf-8") as stream:
        return [Row(column, law, *map(float, values)) for column, law, *values in list(csv.reader(stream))[1:]]


def markdown(study: Study, rows: Sequence[Row]) -> str:
    """Differences from the experiments, and a table of values for each quantity."""
    parts = ["# Constitutive laws: results", "", INTRODUCTION, "", "## Difference from the experiments", ""]
    parts += ["Per cent: mean (smallest to largest).", "", *difference_table(study, rows)]
    for quantity, name in QUANTITIES.items():
        parts += ["", f"## {name.capitalize()}", "", *value_table(study, rows, quantity)]
    return "\n".join([*parts, ""])


def value_table(study: Study, rows: Sequence[Row], quantity: Quantity) -> list[str]:
    """A line for each column and aspect ratio: the experiments with sand and with beads, then the laws."""
    laws = _laws(study, rows)
    values = {(row.column, row.a, row.law): getattr(row, quantity) for row in rows}
    table = _header("column", "a", "experiment, sand", "experiment, beads", *(study.laws[law].title for law in laws))
    for column, a in dict.fromkeys((row.column, row.a) for row in rows):
        published = [_published(study, column, grains, quantity, a) for grains in ("sand", "beads")]
        found = [values.get((column, a, law)) for law in laws]
        table.append(_line(column, f"{a:g}", *published, *("" if x is None else f"{x:.3g}" for x in found)))
    return table


def difference_table(study: Study, rows: Sequence[Row]) -> list[str]:
    """A line for each column, quantity and published law: difference of each law whose material fits, in per cent."""
    laws = _laws(study, rows)
    errors: dict[tuple[str, str, str], dict[str, list[float]]] = defaultdict(lambda: defaultdict(list))
    aspects: dict[tuple[str, str, str], set[float]] = defaultdict(set)
    for row, quantity, experiment, error in _errors(study, rows):
        errors[row.column, quantity, experiment][row.law].append(100.0 * error)
        aspects[row.column, quantity, experiment].add(row.a)
    table = _header("column", "", "experiment", "a", *(study.laws[law].title for law in laws))
    for column in study.columns:
        for quantity, name in QUANTITIES.items():
            for key in [key for key in errors if key[:2] == (column, quantity)]:
                span = f"{min(aspects[key]):g} to {max(aspects[key]):g}"
                table.append(_line(column, name, key[2], span, *(_summary(errors[key][law]) for law in laws)))
    return table


def _errors(study: Study, rows: Sequence[Row]) -> Iterator[tuple[Row, str, str, float]]:
    """Row, quantity, experiment and relative error for each laboratory law that applies."""
    for row in rows:
        case = study.load(row.column, row.law, f"geometry.aspect={row.a:g}")
        measured = {quantity: getattr(row, quantity) for quantity in QUANTITIES}
        for one in score(measured, row.a, case.geometry.model, conditions=conditions_of(case)):
            experiment = EXPERIMENTS[one.experiment]
            if one.error is not None and experiment.kind == "laboratory":
                yield row, one.quantity, experiment.citation + mark(one.verified), one.error


def _published(study: Study, column: str, grains: str, quantity: Quantity, a: float) -> str:
    law = next(name for name, law in study.laws.items() if law.grains == grains)
    expected = study.expected(column, law, quantity, a)
    return "" if expected is None else f"{expected[0]:.3g}{'' if expected[2] else UNVERIFIED}"


def _laws(study: Study, rows: Sequence[Row]) -> list[str]:
    return [law for law in study.laws if any(row.law == law for row in rows)]


def _summary(errors: Sequence[float]) -> str:
    return f"{_signed(fmean(errors))} ({_signed(min(errors))} to {_signed(max(errors))})" if errors else ""


def _signed(number: float) -> str:
    return f"{round(number):+d}" if round(number) else "0"


def _header(*names: str) -> list[str]:
    return [_line(*names), "|---" * len(names) + "|"]


def _line(*cells: str) -> str:
    return f"| {' | '.join(cells)} |"
