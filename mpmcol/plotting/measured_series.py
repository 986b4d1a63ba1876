"""Measurements of the user's own: points of a profile from a CSV file."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from mpmcol.case.small_file import read_small
from mpmcol.errors import UsageError
from mpmcol.measure import Array
from mpmcol.units import DECIMAL_COMMA, FACTORS

EXPECTED = 'expected columns "r" and "z" in m, or with a unit such as "r [mm]", and possibly "series" or "t"'
_HEADER = re.compile(r"\s*+(\w++)\s*+(?:[\[(]\s*+([^\])\s]*+)\s*+[\])])?\s*+")
_LARGEST = 1e9
LARGEST_FILE = 10_000_000  # bytes
MOST_SERIES = 7
ALIASES = {"x": "r", "y": "z"}  # as in the file of an outline
BASE_UNITS = {"r": "m", "z": "m", "series": "", "t": "s"}


class _Column(NamedTuple):
    name: str
    position: int
    unit: str


@dataclass(frozen=True)
class MeasuredSeries:
    """Points of one measured profile: distances r and heights z, (n,), m. `name` is "" if the file has one series."""

    file: str
    name: str
    r: Array
    z: Array

    @property
    def label(self) -> str:
        """For the legend."""
        return f"{self.file}: {self.name}" if self.name else self.file


def read_points(path: Path) -> list[MeasuredSeries]:
    """Read measured profiles, in the order of the file.

    The file has a header and columns separated by commas: r and z (or x and y) in m or with a unit in the header, and
    possibly a column "series" with the name of the profile, or "t" with its time in s.

    Raises:
        UsageError: with the line, if the file cannot be read or a value is not a number.
    """
    try:
        lines = read_small(path, LARGEST_FILE, "measured profiles").decode("utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise UsageError(f"{path}: cannot be read (it is not a text file); {EXPECTED}") from None
    except (OSError, ValueError) as error:
        raise UsageError(f"{path}: cannot be read ({getattr(error, 'strerror', None) or error}); {EXPECTED}") from None
    rows = list(_rows(path, lines))
    if not rows:
        raise UsageError(f"{path}: the file is empty; {EXPECTED}")
    r, z, *naming = _columns(path, *rows[0])
    series: dict[str, list[tuple[float, float]]] = {}
    for number, row in rows[1:]:
        if len(row) != len(rows[0][1]):
            hint = "; the decimal separator is a point" if len(row) > len(rows[0][1]) else ""
            raise UsageError(
                f"{path}, line {number}: {len(row)} values, expected {len(rows[0][1])} as in the header{hint}"
            )
        point = (_number(path, number, row, r), _number(path, number, row, z))
        series.setdefault(_name(row, naming), []).append(point)
    if not series:
        raise UsageError(f"{path}: no points below the header; expected one line for each point")
    if len(series) > MOST_SERIES:
        raise UsageError(f"{path}: {len(series)} series; one chart can show {MOST_SERIES}")
    return [MeasuredSeries(path.name, name, *np.array(points).T) for name, points in series.items()]


def _rows(path: Path, lines: list[str]) -> Iterator[tuple[int, list[str]]]:
    """Numbers and values of the lines that are neither empty nor comments."""
    for number, line in enumerate(lines, 1):
        if line.strip() and not line.lstrip().startswith("#"):
            try:
                yield number, next(csv.reader([line]))
            except csv.Error as error:
                raise UsageError(f"{path}, line {number}: cannot be read ({error}); {EXPECTED}") from None


def _columns(path: Path, number: int, header: list[str]) -> list[_Column]:
    """The columns r and z and, if there is one, the column that names the series."""
    found: dict[str, _Column] = {}
    for index, text in enumerate(header):
        match = _HEADER.fullmatch(text)
        name = match[1].lower() if match else ""
        name = ALIASES.get(name, name)
        if name not in BASE_UNITS or name in found:
            hint = "; columns are separated by commas" if ";" in text or "\t" in text else ""
            hint = "; the first line must be a header" if _is_number(text) else hint
            raise UsageError(f"{path}, line {number}: column {text.strip()[:40]!r} is not usable{hint}; {EXPECTED}")
        base = BASE_UNITS[name]
        unit = (match[2] if match else None) or base
        if FACTORS.get(unit, ("", 0.0))[0] != base:
            units = ", ".join(other for other, (own, _) in FACTORS.items() if own == base and other) or "no unit"
            raise UsageError(f"{path}, line {number}: {name} cannot be in {unit[:20]!r}; expected {units}")
        found[name] = _Column(name, index, unit)
    if not {"r", "z"} <= found.keys() or {"series", "t"} <= found.keys():
        raise UsageError(f"{path}, line {number}: columns {', '.join(found)}; {EXPECTED}")
    return [found[name] for name in BASE_UNITS if name in found]


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False


def _name(row: list[str], naming: list[_Column]) -> str:
    """Name of the series of a row."""
    if not naming:
        return ""
    text = row[naming[0].position].strip()
    return f"t = {text} {naming[0].unit}" if naming[0].name == "t" else text


def _number(path: Path, line: int, row: list[str], column: _Column) -> float:
    """A finite value of a column in SI units."""
    text = row[column.position]
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not abs(value) <= _LARGEST:
        reason = "; the decimal separator is a point" if DECIMAL_COMMA.match(text) else ""
        raise UsageError(f"{path}, line {line}: {column.name} = {text.strip()[:40]!r} is not a number{reason}")
    return value * FACTORS[column.unit][1]
