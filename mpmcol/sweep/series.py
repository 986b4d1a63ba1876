"""Grouping of the rows of a sweep into series for a chart, and the choice of its horizontal axis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from mpmcol.sweep.names import short_names

ASPECT_COLUMN = "a"
ASPECT_KEYS = ("geometry.aspect", "geometry.height")  # keys that determine the aspect ratio


@dataclass(frozen=True)
class Series:
    """Rows that differ only in the value on the horizontal axis."""

    label: str  # "" if there is only one series
    rows: list[Mapping[str, Any]]


def choose_axis(rows: Sequence[Mapping[str, Any]], keys: Sequence[str]) -> str:
    """The column for the horizontal axis: the aspect ratio if it varies or nothing does, else the first of the `keys`
    that varies."""
    varied = [key for key in keys if _count(rows, key) > 1]
    return ASPECT_COLUMN if _count(rows, ASPECT_COLUMN) > 1 or not varied else varied[0]


def group_rows(rows: Sequence[Mapping[str, Any]], keys: Sequence[str], axis: str) -> list[Series]:
    """Series by all other keys that vary; a single series if no two rows share a value on the axis."""
    others = [key for key in keys if key != axis and _count(rows, key) > 1]
    if axis == ASPECT_COLUMN:
        others = [key for key in others if key not in ASPECT_KEYS]
    if not others or _count(rows, axis) == len(rows):
        return [Series("", list(rows))]
    names = short_names(others)
    groups: dict[str, list[Mapping[str, Any]]] = {}
    for row in rows:
        label = ", ".join(f"{names[key]} = {_value_text(row[key])}" for key in others)
        groups.setdefault(label, []).append(row)
    return [Series(label, group) for label, group in groups.items()]


def _count(rows: Sequence[Mapping[str, Any]], column: str) -> int:
    return len({str(row[column]) for row in rows})


def _value_text(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
