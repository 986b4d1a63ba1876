"""Table of a sweep: a row for each run with its inputs, measurements, errors relative to published laws, and cost."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from mpmcol.case import experiment_of, resolved_toml
from mpmcol.case.fields import number_of
from mpmcol.case.reference import field_at
from mpmcol.errors import OutputError
from mpmcol.io import columns
from mpmcol.io.atomic import atomic_write, read_bytes
from mpmcol.io.glossary import TABLE
from mpmcol.io.names import ACCURACY_FILE
from mpmcol.io.run_status import read_status
from mpmcol.io.values import flatten
from mpmcol.io.vtkhdf import create_in_memory, image
from mpmcol.sweep.engine import Outcome

CSV_FILE, HDF5_FILE = "table.csv", "table.h5"
TABLE_SCHEMA = 1
AGAIN = "delete it and repeat the `mpmcol sweep` command"
MOVING = "still moving at the end: not compared with experiments"

SIZES = ("spacing_used", "r_i", "h_i", "base_used")
MEASURED = (
    "front", "zeta", "spread", "height", "beta", "area_factor", "repose_angle_deg", "undisturbed_radius", "stop_time",
    "at_rest", "time_over_tau",
)  # fmt: skip
FINER_GRIDS = "finer_grids"  # last part of the columns of these intervals
COST = ("points", "column_points", "steps", "dt", "ns_per_point_step", "core_seconds", "peak_memory_bytes", "threads")

Row = dict[str, Any]


def make_rows(outcomes: Sequence[Outcome]) -> list[Row]:
    """A row for each run, in the given order, all with the same columns; None where there is no value.

    Only runs that are done have measurements, and only those at rest are compared with experiments. In three dimensions
    the column of a front is the mean around the axis, and the columns .min and .max are its range. Errors are relative;
    their columns are named by the experiment, the quantity and the front. law.zeta and
    law.beta are the values expected by the experiment of the case.
    """
    parts = [_parts(outcome) for outcome in outcomes]
    names = dict.fromkeys(name for alike in zip(*parts, strict=True) for part in alike for name in part)
    rows = [{name: value for part in row for name, value in part.items()} for row in parts]
    return [{name: row.get(name) for name in names} for row in rows]


def csv_text(rows: Sequence[Row]) -> str:
    """The table as CSV, with all digits."""
    text = io.StringIO()
    writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows({name: _cell(value) for name, value in row.items()} for row in rows)
    return text.getvalue()


def table_text(rows: Sequence[Row]) -> str:
    """The table as CSV; columns with units are named "name [unit]"."""
    return csv_text([{columns.with_unit(name, unit_of(name)): value for name, value in row.items()} for row in rows])


def read_table(path: Path, required: Collection[str] = ()) -> list[dict[str, str]]:
    """Rows of a table of a sweep or a run, with names without units.

    Raises OutputError if it is missing or damaged, or lacks a required column.
    """
    if not path.exists():
        raise OutputError(
            f"{path} is missing: the sweep has not ended; repeat the `mpmcol sweep` command to complete it"
        )
    try:
        with path.open(newline="", encoding="utf-8") as file:
            names = [columns.without_unit(column) for column in next(csv.reader(file), [])]
            rows = list(csv.DictReader(file, names, strict=True))
        if not rows or any(None in row or None in row.values() for row in rows):
            raise ValueError("rows are missing or truncated")
        if missing := set(required) - rows[0].keys():
            raise ValueError(f"it lacks the columns {', '.join(sorted(missing))}")
    except (OSError, ValueError, csv.Error) as error:
        raise OutputError(f"{path} is damaged ({error}); {AGAIN}") from None
    return rows


def write_hdf5(out: Path, rows: Sequence[Row], outcomes: Sequence[Outcome]) -> Path:
    """Write table.h5: a dataset with its unit for each column, and `case`, the resolved case of each run."""
    with create_in_memory() as file:
        file.attrs["schema"] = TABLE_SCHEMA
        for name in rows[0]:
            file[name] = _column([row[name] for row in rows])
            file[name].attrs["unit"] = unit_of(name)
        file["case"] = [resolved_toml(outcome.run.case) for outcome in outcomes]
        atomic_write(out / HDF5_FILE, image(file))
    return out / HDF5_FILE


def _parts(outcome: Outcome) -> tuple[Row, ...]:
    """Parts of a row: inputs, sizes, measurements, erosion, finer grids, laws, errors, cost, versions, message."""
    run = outcome.run
    geometry = run.case.geometry
    result = read_status(run.folder).result or {}
    measured = result if outcome.status == "done" else {}
    wall, at_rest = result.get("wall_s", {}), bool(measured.get("at_rest"))

    def compared(value: float | None) -> float | None:
        return value if at_rest else None

    inputs = {"folder": run.folder.name, "status": outcome.status, **run.inputs}
    seconds = {"seconds": sum(wall.values()) if wall else None, "compile_seconds": wall.get("compile")}
    return (
        inputs | {"model": geometry.model, "a": geometry.a},
        {name: result.get(name) for name in SIZES},
        dict(flatten({name: measured[name] for name in MEASURED if name in measured}, unnamed=("mean",))),
        dict(flatten({"erosion": measured.get("erosion") or {}})),
        _finer_grids(outcome),
        _laws(outcome),
        {
            error_column(error["experiment"], error["quantity"], error["front_definition"]): compared(error["error"])
            for error in measured.get("errors", ())
        },
        {f"rms_mm.{score['experiment']}": compared(score["rms_mm"]) for score in measured.get("profile_scores", ())},
        seconds | {name: result.get(name) for name in COST},
        {f"version.{name}": version for name, version in result.get("versions", {}).items()},
        {"message": outcome.result.message or (MOVING if measured and not at_rest else "")},
    )


def _finer_grids(outcome: Outcome) -> Row:
    """Intervals of runout and height from the statement of accuracy, with their middle; empty without one."""
    path = outcome.run.folder / ACCURACY_FILE
    if outcome.status != "done" or not path.exists():
        return {}
    try:
        statement = json.loads(read_bytes(path))
        ends = {name: [statement[name][FINER_GRIDS][end] for end in ("low", "high")] for name in ("zeta", "beta")}
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise OutputError(f"{path} is damaged ({type(error).__name__}: {error}); {AGAIN}") from None
    row: Row = {}
    for name, (low, high) in ends.items():
        column = f"{name}.{FINER_GRIDS}"
        row |= {column: 0.5 * (low + high), f"{column}.low": low, f"{column}.high": high}
    return row


def _laws(outcome: Outcome) -> Row:
    case = outcome.run.case
    geometry = case.geometry
    experiment = experiment_of(case)
    expected = {name: experiment.expected(name, geometry.a) for name in ("zeta", "beta")}
    unverified = [law.quantity for law in experiment.laws if expected.get(law.quantity) and not law.verified]
    values = {f"law.{quantity}": law[0] if law else None for quantity, law in expected.items()}
    return {**values, "law.unverified": ";".join(unverified)}


def error_column(experiment: str, quantity: str, front: str) -> str:
    """Column of the error of a quantity relative to an experiment's law; `front` is "" for a quantity without one."""
    return ".".join(filter(None, ("error", experiment, quantity, front)))


def _cell(value: Any) -> Any:
    return str(value).lower() if isinstance(value, bool) else value


def _column(values: list[Any]) -> Any:
    """Numbers, NaN where they are missing; anything else as text."""
    if all(isinstance(value, (int, float)) for value in values):
        return np.array(values)
    if all(value is None or isinstance(value, (int, float)) for value in values):
        return np.array([np.nan if value is None else value for value in values], dtype=np.float64)
    return ["" if value is None else str(value) for value in values]


def unit_of(column: str) -> str:
    """Unit of a column of table.csv, which may be a key of the case; "1" if it has none."""
    number = number_of(field_at(tuple(column.split(".")), ""))
    return (number.unit if number else None) or columns.unit_of(TABLE, column) or "1"
