"""`mpmcol measure`: runout, height and profile of a deposit, and their errors relative to published laws."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mpmcol.cli.options import PATH

if TYPE_CHECKING:
    from mpmcol.cli.measured import Measured


@click.command()
@click.argument("folder", metavar="DIR", type=PATH)
@click.option("--snapshot", metavar="N", default=-1, show_default=True, help="Snapshot index (-1: last).")
@click.option("--json", "form", flag_value="json", help="Print one line of JSON, with the profile and all errors.")
@click.option("--csv", "form", flag_value="csv", help="Print CSV: a header and one row.")
def measure(folder: Path, snapshot: int, form: str | None) -> None:
    """Measure a deposit and compare it with published laws.

    DIR is a results folder. Prints the fronts by three definitions, height, spread, and relative errors of runout
    (zeta) and height (beta) to all laws for this kind of column.
    """
    from mpmcol.cli.measure_text import text_of
    from mpmcol.cli.measured import measure_results
    from mpmcol.io.results import Results

    measured = measure_results(Results(folder), snapshot)
    formats = {"json": _json, "csv": _csv, None: text_of}
    click.echo(formats[form](measured))


def _state(measured: Measured) -> dict[str, Any]:
    return {name: getattr(measured, name) for name in ("status", "at_rest", "stage", "time")}


def _json(measured: Measured) -> str:
    measurement = measured.measurement
    record = {
        **_state(measured),
        **measurement.scalars(),
        "stop_time": measured.stop_time,
        "energy_released": measured.energy_released,
        "energy_unit": measured.energy_unit,
        "profile": {"x": measurement.profile_x.tolist(), "y": measurement.profile_y.tolist()},
        "scores": [score.as_dict() for score in measured.scores],
        "profile_scores": [vars(profile) for profile in measured.profiles],
    }
    return json.dumps(record)


def _csv(measured: Measured) -> str:
    """Header and row; the columns depend only on the kind of column, so that rows of several runs can be combined."""
    from mpmcol.io.columns import header
    from mpmcol.io.glossary import MEASURE
    from mpmcol.io.values import flatten
    from mpmcol.sweep.table import error_column

    row = _state(measured) | {"at_rest": str(measured.at_rest).lower()}
    row |= dict(flatten(measured.measurement.scalars()))
    row["stop_time"] = measured.stop_time
    for score in measured.scores:
        if score.quantity != "stop_time":
            row[error_column(score.experiment, score.quantity, score.front_definition)] = score.error
    return ",".join(header(row, MEASURE)) + "\n" + ",".join(map(_cell, row.values()))


def _cell(value: Any) -> str:
    if isinstance(value, str):
        return value
    return "" if value is None else f"{value:.6g}"
