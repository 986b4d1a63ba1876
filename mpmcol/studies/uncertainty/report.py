"""Files of an uncertainty study in the folder of its sweep."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mpmcol.io.atomic import atomic_write
from mpmcol.io.values import flatten, to_json
from mpmcol.studies.uncertainty.analysis import Analysis
from mpmcol.studies.uncertainty.record import as_record, quantity_row
from mpmcol.sweep.table import csv_text

JSON_FILE, CSV_FILE, CHART_FILE = "uncertainty.json", "uncertainty.csv", "uncertainty.png"


@dataclass(frozen=True)
class UncertaintyReport:
    """The record of uncertainty.json, and the files that were written."""

    record: dict[str, Any]
    files: list[Path]


def write_report(analysis: Analysis, out: Path) -> UncertaintyReport:
    """Write uncertainty.csv, uncertainty.png and uncertainty.json, unless they are up to date.

    uncertainty.json is written last, so that an up-to-date record implies up-to-date other files. Without quantities
    there are no table and no chart.
    """
    record = as_record(analysis)
    text = to_json(record, indent=1).encode() + b"\n"
    json_path, csv_path, chart_path = (out / name for name in (JSON_FILE, CSV_FILE, CHART_FILE))
    files = [json_path, *([csv_path, chart_path] if analysis.quantities else [])]
    if all(path.exists() for path in files) and json_path.read_bytes() == text:
        return UncertaintyReport(record, files)
    if analysis.quantities:
        from mpmcol.studies.uncertainty.chart import uncertainty_chart  # here, since it takes long to import

        rows = [dict(flatten(quantity_row(one))) for one in analysis.quantities]
        names = dict.fromkeys(name for row in rows for name in row)
        atomic_write(csv_path, csv_text([{name: row.get(name) for name in names} for row in rows]).encode())
        uncertainty_chart(chart_path, analysis)
    atomic_write(json_path, text)
    return UncertaintyReport(record, files)
