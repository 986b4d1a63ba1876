"""Read the results folder of a run: case, result, history, snapshots, and what is measured from them."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping
from dataclasses import fields
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from mpmcol.case import Case
from mpmcol.errors import OutputError, UsageError
from mpmcol.io.columns import without_unit
from mpmcol.io.html import html_table
from mpmcol.io.names import CASE_FILE, HISTORY_FILE, PRESSURE_FILE, RESULT_FILE
from mpmcol.io.run_snapshots import find_snapshot, run_snapshots
from mpmcol.io.run_status import read_result, read_status
from mpmcol.io.snapshot import Snapshot, read_snapshot
from mpmcol.io.stored_case import read_stored_case, require_unchanged
from mpmcol.measure import (
    Array,
    ColumnShape,
    Erosion,
    Material,
    Measurement,
    measure,
    measure_erosion,
    stop_time,
    surface_over_bed,
)
from mpmcol.setup.column_shape import column_shape
from mpmcol.setup.discretization import discretize

HISTORY = (
    "stage", "step", "time", "dt", "kinetic", "potential", "elastic", "plastic", "filter", "damping", "walls",
    "transfer", "residual", "front_max", "front_connected", "front_height", "height", "J_min", "J_max", "open_points",
    "grid_kinetic", "unbalanced",
)  # fmt: skip


def kind_of(path: Path) -> str:
    """What is at a path at which a folder was expected, as a part of a message."""
    return f"{path} is a file" if path.is_file() else f"{path}: no such folder"


class Results:
    """The results folder of a run, read on demand.

    Raises OutputError if the folder holds no run, or if a file in it is damaged.
    """

    def __init__(self, folder: Path | str) -> None:
        self.folder = Path(folder)
        if not (self.folder / CASE_FILE).is_file():
            expected = "expected the results folder of a run (`mpmcol run`)"
            missing = f"{self.folder}: {CASE_FILE} not found" if self.folder.is_dir() else kind_of(self.folder)
            raise OutputError(f"{missing}; {expected}")

    def __repr__(self) -> str:
        texts = (f"{name} {text}" for name, text in self._overview() if text and name != "folder")
        return f"<Results {str(self.folder)!r}: {'; '.join(texts)}>"

    def _repr_html_(self) -> str:
        return html_table([], self._overview())

    def _overview(self) -> Iterator[tuple[str, str]]:
        """Names and texts of the most important values; never fails, whatever the folder holds."""
        status = read_status(self.folder)
        result = status.result or {}
        rest = ", at rest" if result.get("at_rest") else ", not at rest"
        yield "folder", str(self.folder)
        yield "case", str(result.get("title", ""))
        yield "state", f"{status.name}{rest if status.name == 'done' else ''}"
        for quantity in ("zeta", "beta"):
            yield quantity, _numbers_text(result.get(quantity))
        ledger, shares = result.get("ledger") or {}, result.get("dissipation") or {}
        residual, released = ledger.get("residual"), shares.get("released")
        if residual is not None and released:  # null: not finite, in a failed run
            yield "energy error", f"{residual / released:.1e} of the released energy"

    @cached_property
    def case(self) -> Case:
        """The case with all defaults filled in. Raises OutputError also if it is not the one that was simulated."""
        path = self.folder / CASE_FILE
        case = read_stored_case(path)
        if self.status != "unfinished":
            require_unchanged(path, case, self.summary.get("case_hash"))
        return case

    @cached_property
    def summary(self) -> dict[str, Any]:
        """The content of result.json."""
        path = self.folder / RESULT_FILE
        result, problem = read_result(path)
        if problem:
            raise OutputError(f"{path}: {problem}; run the case again with --fresh")
        if result is None:
            raise OutputError(f"{path} is missing: the run has not ended; run the case again")
        return result

    @property
    def status(self) -> str:
        """How the run ended: "done", "failed" or "stopped"; "unfinished" if it has no result."""
        return str(self.summary["status"]) if (self.folder / RESULT_FILE).exists() else "unfinished"

    @property
    def came_to_rest(self) -> bool:
        """Whether the final state is a deposit at rest."""
        return self.status == "done" and bool(self.summary.get("at_rest"))

    @cached_property
    def history(self) -> dict[str, np.ndarray]:
        """Columns of history.csv: `stage` as text, all others as numbers."""
        return read_history(self.folder / HISTORY_FILE)

    @cached_property
    def wall_pressure(self) -> dict[str, np.ndarray]:
        """Columns of wall_pressure.csv: wall, face and state as text, all others as numbers; empty without the file."""
        path = self.folder / PRESSURE_FILE
        return _read_columns(path, ("wall", "face", "state")) if path.exists() else {}

    @cached_property
    def released_history(self) -> dict[str, np.ndarray]:
        """Columns of the history since the release. Raises UsageError if the run ended before it."""
        released = self.history["stage"] != "equilibrate"
        if not (released.any() and self.snapshots):
            raise UsageError(f"{self.folder}: the run ended before the column was released; there is nothing to chart")
        return {name: column[released] for name, column in self.history.items()}

    @property
    def fall_time(self) -> float:
        """Characteristic time sqrt(h_i / g), s."""
        return self.shape.fall_time(self.case.geometry.gravity)

    @property
    def snapshots(self) -> list[Path]:
        """Snapshot files in the order of writing; of a run that has ended, with files that are missing."""
        return run_snapshots(self.folder)

    def snapshot(self, index: int = -1) -> Snapshot:
        """One snapshot, by default the last.

        Raises UsageError if there is none with that index, OutputError if it is missing or damaged.
        """
        return read_snapshot(find_snapshot(self.folder, index))

    @cached_property
    def shape(self) -> ColumnShape:
        """Initial geometry of the column, to which measurements refer."""
        return column_shape(self.case, discretize(self.case))

    @property
    def erosion(self) -> Erosion | None:
        """Erosion of a granular bed; None without one, and of a version that did not measure all of it."""
        stored = self.summary.get("erosion") or {}
        return Erosion(**stored) if stored.keys() == {field.name for field in fields(Erosion)} else None

    def measure(self, index: int = -1) -> Measurement:
        """Fronts, height and profile of one snapshot."""
        return measure_snapshot(self.snapshot(index), self.shape)


def _numbers_text(value: Any) -> str:
    """A measured value, or its values by definition of the front, in 3D the means; "" if it is missing."""
    if not isinstance(value, dict):
        return "" if value is None else f"{value:.3f}"
    means = {front: one.get("mean") if isinstance(one, dict) else one for front, one in value.items()}
    return ", ".join(f"{mean:.3f} ({front})" for front, mean in means.items() if mean is not None)


def measure_snapshot(snapshot: Snapshot, shape: ColumnShape) -> Measurement:
    """Measure the column's points of a snapshot; points with a non-finite position are left out."""
    return measure(*_column(snapshot, shape), shape)


def erosion_of(snapshot: Snapshot, shape: ColumnShape) -> Erosion:
    """Erosion of the granular bed in a snapshot; points with a non-finite position are left out."""
    return measure_erosion(_column(snapshot, shape), _bed(snapshot), shape)


def surface_of(snapshot: Snapshot, shape: ColumnShape) -> tuple[Array, Array] | None:
    """Height of the surface over that of a granular bed at the release, as `surface_over_bed`; None without a bed."""
    if shape.bed_density is None:
        return None
    return surface_over_bed(_column(snapshot, shape), _bed(snapshot), shape)


def _column(snapshot: Snapshot, shape: ColumnShape) -> Material:
    """Points of the column, with the masses that they would have at its density."""
    own = snapshot.column & _is_finite(snapshot)
    column = _material(snapshot, own)
    return column._replace(mass=shape.uniform_mass(column.mass, snapshot.arrays["material"][own]))


def _bed(snapshot: Snapshot) -> Material:
    return _material(snapshot, ~snapshot.column & _is_finite(snapshot))


def _is_finite(snapshot: Snapshot) -> np.ndarray:
    """Mask (n) of the points with a finite position."""
    return np.asarray(np.isfinite(snapshot.arrays["position"]).all(axis=1))


def _material(snapshot: Snapshot, points: np.ndarray) -> Material:
    names = ("position", "mass", "displacement")
    return Material(*(snapshot.arrays[name][points].astype(np.float64) for name in names))


def measure_stop_time(history: Mapping[str, np.ndarray], spacing: float, fall_time: float) -> float | None:
    """Time after release from which on the front stays within one cell of its final position, in sqrt(h_i / g).

    history: columns "stage", "time" (s) and "front_height" (m); spacing in m, fall_time sqrt(h_i / g) in s. None if the
    front has not stopped before the last row, or has moved by less than a cell.
    """
    collapse = history["stage"] == "collapse"
    stop = stop_time(history["time"][collapse], history["front_height"][collapse], spacing)
    return None if stop is None else stop / fall_time


def read_history(path: Path) -> dict[str, np.ndarray]:
    """Columns of a history.csv: `stage` as text, all others as numbers. Raises OutputError."""
    return _read_columns(path, ("stage",), HISTORY)


def _read_columns(path: Path, texts: tuple[str, ...], required: tuple[str, ...] = ()) -> dict[str, np.ndarray]:
    """Columns of a CSV file, `required` first: `texts` as text, all others as numbers. Raises OutputError."""
    try:
        with path.open(encoding="utf-8", newline="") as file:
            columns = [without_unit(column) for column in next(csv.reader(file), [])]
            rows = list(csv.DictReader(file, columns))
        if missing := [name for name in required if name not in columns]:
            raise ValueError(f"no column {missing[0]}")
        names = [*required, *(name for name in columns if name not in required)]
        return {name: np.array([row[name] if name in texts else float(row[name]) for row in rows]) for name in names}
    except (OSError, KeyError, TypeError, ValueError, csv.Error):
        raise OutputError(f"{path} is missing or damaged; run the case again with --fresh") from None
