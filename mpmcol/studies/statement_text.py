"""The statement of accuracy in words, and its file beside the result."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

from mpmcol.errors import OutputError
from mpmcol.io.atomic import atomic_write, read_bytes
from mpmcol.io.names import ACCURACY_FILE
from mpmcol.io.values import to_json
from mpmcol.studies.judgement import NAMES
from mpmcol.studies.pareto.error_interval import ErrorInterval
from mpmcol.units import length_scale, length_text

Content = TypeVar("Content")


def write_statement(folder: Path, record: Mapping[str, Any]) -> None:
    """Write the record of `make_statement` into the folder of its run, unless it is there. Raises OutputError."""
    path, content = folder / ACCURACY_FILE, (to_json(record, indent=1) + "\n").encode()
    if not path.is_file() or read_bytes(path) != content:
        atomic_write(path, content)


def stored_lines(folder: Path) -> list[str]:
    """The statement of the run in a folder in words; no lines for a run without a requested accuracy.

    Raises OutputError if its file is damaged.
    """
    return _from_record(folder, statement_lines) or []


def corrected_values(folder: Path) -> dict[str, tuple[float, float]]:
    """Length in m and value, corrected for the error of the grid, by quantity; of a run by `--corrected`.

    Empty for other runs. Raises OutputError if the file of the statement is damaged.
    """
    return _from_record(folder, _corrected) or {}


def _corrected(record: Mapping[str, Any]) -> dict[str, tuple[float, float]]:
    return {name: _middle(record[name]["finer_grids"]) for name in NAMES if record["corrected"]}


def _middle(interval: Mapping[str, float]) -> tuple[float, float]:
    """Length in m and value in the middle of an interval."""
    length = 0.5 * (interval["low_length"] + interval["high_length"])
    return length, 0.5 * (interval["low"] + interval["high"])


def _from_record(folder: Path, read: Callable[[Mapping[str, Any]], Content]) -> Content | None:
    """What `read` finds in the record of a statement; None without one. Raises OutputError if it is damaged."""
    path = folder / ACCURACY_FILE
    if not path.exists():
        return None
    try:
        return read(json.loads(path.read_text("utf-8")))
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise OutputError(
            f"{path} is damaged ({type(error).__name__}: {error}); repeat the command of the run, which writes it again"
        ) from None


def statement_lines(record: Mapping[str, Any]) -> list[str]:
    """The statement in words, from its record: five lines."""
    outside = record["outside_study"]
    return [
        *(line for name in NAMES for line in _quantity_lines(name, record[name], record["corrected"])),
        f"confidence {record['confidence']:.0%}; {_source(record)}"
        + (f"; outside the study, intervals may be too narrow: {'; '.join(outside)}" if outside else ""),
    ]


def _source(record: Mapping[str, Any]) -> str:
    if record["source"] == "study":
        variant = f'"{record["variant"]}" at r_i/h = {record["cells"]:g}'
        return f"grid: errors of {variant} in the study ({'; '.join(record['cases'])})"
    return f"error bars of runs up to r_i/h = {record['cells']:g}, values extrapolated to zero spacing"


def _quantity_lines(name: str, record: Mapping[str, Any], corrected: bool) -> list[str]:
    error, finer = record["error"], record["finer_grids"]
    middle = f", corrected {_middle(finer)[1]:.3f}" * corrected
    grid = f"error bar {record['grid']:.1%}" if error is None else f"error of this one {ErrorInterval(**error)}"
    return [
        f"{NAMES[name]} {length_text(record['length'])}, {name} = {record['value']:.3f}; finer grids: "
        f"{_interval_text(finer)}{middle}, {grid}",
        f"  experiments: {_experiments_text(record)}",
    ]


def _experiments_text(record: Mapping[str, Any]) -> str:
    if record["experiment"] is None:
        return f"no interval; {record['reason']}"
    differences = "; ".join(map(_difference_text, record["experiments"]))
    model = f"model {record['model']:.1%} (grid-converged {differences})"
    return f"{_interval_text(record['experiment'])}, from finer grids and {model}"


def _difference_text(record: Mapping[str, Any]) -> str:
    difference, scatter = record["difference"], f"{record['experiment']}, scatter {record['scatter']:.0%}"
    return f"not compared with {scatter}" if difference is None else f"{difference:+.1%} against {scatter}"


def _interval_text(interval: Mapping[str, float]) -> str:
    unit, factor = length_scale(interval["high_length"])
    low, high = factor * interval["low_length"], factor * interval["high_length"]
    return f"{interval['low']:.3f} to {interval['high']:.3f} ({low:.4g} to {high:.4g} {unit})"
