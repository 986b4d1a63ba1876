"""Names in results and in JSON output: their entries in the glossaries, and columns of CSV files with units.

A column is named "name [unit]" if it has a unit with which its name does not end: time [s], front.front_height [m],
repose_angle_deg. `without_unit` gives the name.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cache

from mpmcol.io.glossary import UNITS_BY_MODEL, Names
from mpmcol.io.json_glossary import ALL_NAMES

_PERCENTILE = re.compile(r"_(p\d+|median)$")
_PER_MODEL = "per metre of width in the plane model, per radian in axisymmetry, of the modelled part in 3D"


@dataclass
class Entry:
    """A unit and a meaning, with the names that have them and the files or commands in which these occur."""

    unit: str
    meaning: str
    names: list[str] = field(default_factory=list)
    where: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        unit = f"{self.unit}: {_PER_MODEL}" if self.unit in UNITS_BY_MODEL else self.unit
        return "\n".join(
            [
                ", ".join(dict.fromkeys(self.names)),
                f"    {self.meaning}",
                f"    {f'unit {unit}; ' if unit else ''}in {', '.join(dict.fromkeys(self.where))}",
            ]
        )


def explain_name(name: str) -> str:
    """Meaning, unit and occurrence of a name in results or of a term of the summary; "" if there is none.

    Spaces may stand for the underscores of a name.
    """
    return "\n".join(map(str, find_entries(name) or find_entries(name.replace(" ", "_"))))


def explain_word(name: str) -> str:
    """Explanation of the first word of an unknown name that is a name in results: kinetic of kinetic_energy."""
    return next(filter(None, map(explain_name, name.split("_"))), "")


def names_with(text: str) -> dict[str, str]:
    """Names in results that contain a text, or whose meaning does, and their meanings; all for "".

    Underscores are spaces.
    """
    words = text.replace("_", " ").lower()
    return {
        name: meaning
        for names in ALL_NAMES.values()
        for name, (_, meaning) in names.items()
        if words in f"{name.replace('_', ' ')}; {meaning}".lower()
    }


def explain_names() -> str:
    """All names in results, by the file or the command in which they occur."""
    return "\n\n".join("\n".join([f"[{where}]", *_listed(names)]) for where, names in ALL_NAMES.items())


def _listed(names: Names) -> list[str]:
    return [f"  {name}\n    {meaning}" + (f" ({unit})" if unit else "") for name, (unit, meaning) in names.items()]


def find_entries(name: str) -> list[Entry]:
    """Entries of a full name, its first parts or its last one, which may lack its percentile: I of flow.I_p5.

    Names with equal unit and meaning are one entry.
    """
    found: dict[tuple[str, str], Entry] = {}
    for where, names in ALL_NAMES.items():
        for full, content in names.items():
            is_part = full.startswith(f"{name}.") or _PERCENTILE.sub("", f".{full}").endswith(f".{name}")
            if is_part or full.endswith(f".{name}") or _pattern(full).fullmatch(name):
                entry = found.setdefault(content, Entry(*content))
                entry.names.append(full)
                entry.where.append(where)
    return list(found.values())


def unit_of(where: str, name: str, model: str = "") -> str | None:
    """Unit of a name in a file or command, "" if it has none; None if the name is not in the table."""
    names = ALL_NAMES[where]
    matching = [full for full in names if _pattern(full).fullmatch(name)]
    # that with the most parts: WALL.peak rather than WALL, which stands for any parts
    unit = names[max(matching, key=lambda full: full.count("."))][0] if matching else None
    return UNITS_BY_MODEL[unit][model] if model and unit in UNITS_BY_MODEL else unit


def header(names: Iterable[str], where: str, model: str = "") -> list[str]:
    """Header of a CSV file: each name, with its unit in brackets if it has one that the name does not end with."""
    return [with_unit(name, unit_of(where, name, model) or "") for name in names]


def with_unit(name: str, unit: str) -> str:
    """A name with its unit in brackets; without it if it is "" or 1, or if the name ends with it."""
    return name if unit in ("", "1") or name.endswith(f"_{unit}") else f"{name} [{unit}]"


def without_unit(column: str) -> str:
    """The name of a column of a CSV file."""
    return column.partition(" [")[0]


@cache
def _pattern(full: str) -> re.Pattern[str]:
    """Pattern of a full name, in which capitals stand for any parts, and which may be a mean or a limit in 3D."""
    variable = re.sub(r"[A-Z]{4,}(\\\.[A-Z]{4,})*", r"[\\w.:+-]+", re.escape(full))
    return re.compile(rf"{variable}(\.(mean|min|max))?")
