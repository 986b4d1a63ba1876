"""`mpmcol measure`: runout, height and profile of a deposit, and their errors relative to published laws."""

from __future__ import annotations

import json
from dataclasses import dataclass
from math import sqrt
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mpmcol.cli.options import PATH

if TYPE_CHECKING:
    from mpmcol.experiments import ProfileScore, Score
    from mpmcol.io.results import Results
    from mpmcol.measure import ColumnShape, Measurement


@dataclass(frozen=True)
class Measured:
    """A measured snapshot of a run, and its errors relative to published laws and profiles."""

    status: str  # of the run: "done" | "failed" | "stopped" | "unfinished"
    at_rest: bool  # whether the run ended with the column at rest
    stage: str
    time: float  # s since release
    is_last: bool  # whether the snapshot is the last one
    measurement: Measurement
    shape: ColumnShape
    stop_time: float | None  # sqrt(h_i / g); None unless it is the final deposit
    scores: list[Score]
    profiles: list[ProfileScore]

    @property
    def is_deposit(self) -> bool:
        """Whether this is the final deposit, as opposed to a state during the collapse."""
        return self.at_rest and self.is_last


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
    from mpmcol.io.results import Results

    measured = measure_results(Results(folder), snapshot)
    formats = {"json": _json, "csv": _csv, None: text_of}
    click.echo(formats[form](measured))


def measure_results(results: Results, snapshot: int) -> Measured:
    """Measure a snapshot of a run."""
    from mpmcol.experiments import profile_scores, score

    taken, shape, measurement = results.snapshot(snapshot), results.shape, results.measure(snapshot)
    is_last = snapshot in (-1, len(results.snapshots) - 1)
    stop = _stop_time(results) if results.came_to_rest and is_last else None
    values: dict[str, Any] = {"zeta": measurement.zeta, "beta": measurement.beta}
    return Measured(
        status=results.status,
        at_rest=results.came_to_rest,
        stage=taken.stage,
        time=taken.time,
        is_last=is_last,
        measurement=measurement,
        shape=shape,
        stop_time=stop,
        scores=score(values if stop is None else {**values, "stop_time": stop}, shape.a, shape.model, shape.section),
        profiles=profile_scores(
            measurement.profile_x, measurement.profile_y, shape.model, shape.r_i, shape.h_i, shape.section
        ),
    )


def _stop_time(results: Results) -> float | None:
    """Time at which the front stops, in sqrt(h_i / g); None, with a note, if the history cannot be read."""
    from mpmcol.errors import OutputError
    from mpmcol.io.names import HISTORY_FILE
    from mpmcol.io.results import measure_stop_time

    try:
        history = results.history
    except OutputError:
        history = {}
    if not len(history.get("time", ())):
        path = results.folder / HISTORY_FILE
        problem = "is damaged: rows or columns are missing or truncated" if path.exists() else "is missing"
        click.echo(f"note: {path} {problem}; the stop time of the front is omitted", err=True)
        return None
    fall_time = sqrt(results.shape.h_i / results.case.geometry.gravity)
    return measure_stop_time(history, results.shape.spacing, fall_time)


def _state(measured: Measured) -> dict[str, Any]:
    return {name: getattr(measured, name) for name in ("status", "at_rest", "stage", "time")}


def _json(measured: Measured) -> str:
    measurement = measured.measurement
    record = {
        **_state(measured),
        **measurement.scalars(),
        "stop_time": measured.stop_time,
        "profile": {"x": measurement.profile_x.tolist(), "y": measurement.profile_y.tolist()},
        "scores": [score.as_dict() for score in measured.scores],
        "profile_scores": [vars(profile) for profile in measured.profiles],
    }
    return json.dumps(record)


def _csv(measured: Measured) -> str:
    """Header and row; the columns depend only on the kind of column, so that rows of several runs can be combined."""
    from mpmcol.io.values import flatten
    from mpmcol.sweep.table import error_column

    row = _state(measured) | {"at_rest": str(measured.at_rest).lower()}
    row |= dict(flatten(measured.measurement.scalars()))
    row["stop_time"] = measured.stop_time
    for score in measured.scores:
        if score.quantity != "stop_time":
            row[error_column(score.experiment, score.quantity, score.front_definition)] = score.error
    return ",".join(row) + "\n" + ",".join(map(_cell, row.values()))


def _cell(value: Any) -> str:
    if isinstance(value, str):
        return value
    return "" if value is None else f"{value:.6g}"
