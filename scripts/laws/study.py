"""The study of constitutive laws as its TOML file defines it."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal

from pydantic import ValidationError

import mpmcol
from mpmcol.case import Case
from mpmcol.errors import UsageError
from mpmcol.experiments import find_experiment
from mpmcol.units import Table

Quantity = Literal["zeta", "beta", "stop_time"]
QUANTITIES: dict[Quantity, str] = {"zeta": "runout", "beta": "height", "stop_time": "stop time"}
FILE = Path(__file__).with_name("which_law.toml")


class Column(Table):
    """Names of the experiments with sand and with beads in a kind of column."""

    sand: str
    beads: str


class Law(Table):
    """A material, the damping of its collapse, and where it is run: by default in all columns and for all aspects."""

    title: str
    grains: Literal["sand", "beads"]
    damping: float
    material: dict[str, Any]
    columns: list[str] | None = None
    aspect: list[float] | None = None


class Study(Table):
    """Columns by shipped case, laws by name, aspect ratios, and the values of the cases that change for all laws."""

    aspect: list[float]
    columns: dict[str, Column]
    case: dict[str, Any]
    laws: dict[str, Law]

    def pairs(self) -> Iterator[tuple[str, str]]:
        """Columns and laws of all sweeps."""
        for column in self.columns:
            for name, law in self.laws.items():
                if law.columns is None or column in law.columns:
                    yield column, name

    def aspects(self, law: str) -> list[float]:
        """Aspect ratios of a law."""
        return self.laws[law].aspect or self.aspect

    def load(self, column: str, law: str, *overrides: str) -> Case:
        """The case of a column with a law; raises CaseError."""
        chosen = self.laws[law]
        values = [*_overrides(self.case), f"material={_toml(chosen.material)}"]
        return mpmcol.load_case(column, [*values, f"stages.collapse.damping={chosen.damping}", *overrides])

    def expected(self, column: str, law: str, quantity: Quantity, a: float) -> tuple[float, float, bool] | None:
        """Value and relative scatter of the experiment with the grains of a law, and whether the value is verified."""
        experiment = find_experiment(getattr(self.columns[column], self.laws[law].grains), _kind(column))
        published = experiment.law(quantity)
        value = published(a) if published else None
        return None if published is None or value is None else (value, published.scatter, published.verified)


def read_study(file: Path = FILE) -> Study:
    """Read and check the file; UsageError names every key that is unknown, missing or of another type."""
    try:
        return Study.model_validate(tomllib.loads(file.read_text(encoding="utf-8")))
    except tomllib.TOMLDecodeError as error:
        raise UsageError(f"{file}: {error}") from None
    except ValidationError as error:
        problems = [f"{'.'.join(map(str, one['loc']))}: {one['msg']}" for one in error.errors()]
        raise UsageError("\n".join(f"{file}: {problem}" for problem in problems)) from None


def _kind(column: str) -> str:
    return mpmcol.load_case(column).geometry.model


def _overrides(values: dict[str, Any], prefix: str = "") -> Iterator[str]:
    """key=value of all values in nested tables."""
    for key, value in values.items():
        if isinstance(value, dict):
            yield from _overrides(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}={_toml(value)}"


def _toml(value: Any) -> str:
    """A value in TOML on one line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {_toml(one)}" for key, one in value.items()) + "}"
    return str(value).lower() if isinstance(value, bool) else repr(value)
