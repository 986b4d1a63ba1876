"""The runs that the figures of the paper are made of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mpmcol.case import load_case
from mpmcol.results import Results
from mpmcol.sweep.points import Point, make_point
from mpmcol.sweep.table import Row

SNAPSHOTS = "output.snapshots"
FEW = {SNAPSHOTS: "1"}


@dataclass(frozen=True)
class Member:
    """One run: a shipped case with some of its values replaced. Figures that share a run share its folder."""

    case: str
    a: float
    h: float  # node spacing asked for, m
    settings: tuple[tuple[str, str], ...] = tuple(FEW.items())  # key of the case, value

    def point(self, out: Path) -> Point:
        """The run in a folder of `out`."""
        inputs: dict[str, Any] = {
            "case": self.case, "geometry.aspect": self.a, "grid.spacing": self.h, **dict(self.settings)
        }  # fmt: skip
        overrides = [f"{key}={value}" for key, value in list(inputs.items())[1:]]
        words = [f"{key.rpartition('.')[2]}-{value}" for key, value in self.settings if key != SNAPSHOTS]
        name = "-".join((self.case, f"a{self.a:g}", f"h{self.h * 1e3:g}mm", *words))
        return make_point(load_case(self.case, overrides), out, inputs, name)


@dataclass(frozen=True)
class Finished:
    """A run that has ended well: its row in the table of a sweep, and its folder."""

    row: Row
    folder: Path

    @property
    def results(self) -> Results:
        """Everything that the run has written."""
        return Results(self.folder)


Found = Mapping[Member, Finished]  # members that failed are missing


def with_settings(case: str, a: float, h: float, **settings: str) -> Member:
    """A member with values replaced; two underscores in a key stand for its dot."""
    return Member(
        case, a, h, tuple({**FEW, **{key.replace("__", "."): value for key, value in settings.items()}}.items())
    )
