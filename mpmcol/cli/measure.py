"""`mpmcol measure`: runout, height and profile of a deposit, and their errors relative to published laws."""

from __future__ import annotations

from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mpmcol.cli.options import json_option, results_argument
from mpmcol.io.values import to_json as as_json

if TYPE_CHECKING:
    from mpmcol.api.measured import Measured
    from mpmcol.measure import Array


@click.command()
@results_argument(of="a run")
@click.option("--snapshot", metavar="N", default=-1, show_default=True, help="Snapshot index (-1: last).")
@json_option("measurements, profile and all errors")
@click.option("--csv", "to_csv", is_flag=True, help="Print CSV: a header and one row.")
def measure(folder: Path, snapshot: int, to_json: bool, to_csv: bool) -> None:
    """Measure a deposit and compare it with published laws.

    DIR is a results folder. Prints the fronts by three definitions, height, spread, and relative errors of runout
    (zeta) and height (beta) to all laws for this kind of column.
    """
    if to_json and to_csv:
        raise click.UsageError("--json and --csv are two forms of the same result; give one of them")
    from mpmcol.api.measured import measure as measure_run
    from mpmcol.cli.measure_text import text_of

    measured = measure_run(folder, snapshot, notify=partial(click.echo, err=True))
    form = _json if to_json else _csv if to_csv else text_of
    click.echo(form(measured))


def _state(measured: Measured) -> dict[str, Any]:
    return {name: getattr(measured, name) for name in ("status", "at_rest", "stage", "time")}


def _json(measured: Measured) -> str:
    from mpmcol.measure import friction_bias

    measurement = measured.measurement
    record = {
        **_state(measured),
        **measurement.scalars(),
        "friction_from_repose_deg": measured.friction_from_repose,
        "friction_from_repose_bias_deg": friction_bias(measured.shape),
        "stop_time": measured.stop_time,
        "energy_released": measured.energy_released,
        "energy_unit": measured.energy_unit,
        "wall_forces": measured.wall_forces,
        "profile": _points(measurement.profile),
        "erosion": _erosion(measured),
        "surface_over_bed": _points(measured.surface_over_bed),
        "scores": [score.as_dict() for score in measured.scores],
        "profile_scores": [vars(profile) for profile in measured.profiles],
    }
    return as_json(record)


def _points(line: tuple[Array, Array] | None) -> dict[str, list[float]] | None:
    return None if line is None else {"x": line[0].tolist(), "y": line[1].tolist()}


def _erosion(measured: Measured) -> dict[str, float] | None:
    return None if measured.erosion is None else asdict(measured.erosion)


def _csv(measured: Measured) -> str:
    """Header and row; the columns depend only on the kind of column, so that rows of several runs can be combined."""
    from mpmcol.io.columns import header
    from mpmcol.io.glossary import MEASURE
    from mpmcol.io.values import flatten
    from mpmcol.sweep.table import error_column

    row = _state(measured) | {"at_rest": str(measured.at_rest).lower()}
    row |= dict(flatten(measured.measurement.scalars()))
    row |= dict(flatten({"erosion": _erosion(measured) or {}}))
    row["friction_from_repose_deg"] = measured.friction_from_repose
    row["stop_time"] = measured.stop_time
    for score in measured.scores:
        if score.quantity != "stop_time":
            row[error_column(score.experiment, score.quantity, score.front_definition)] = score.error
    return ",".join(header(row, MEASURE)) + "\n" + ",".join(map(_cell, row.values()))


def _cell(value: Any) -> str:
    if isinstance(value, str):
        return value
    return "" if value is None else f"{value:.6g}"
