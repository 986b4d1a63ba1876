"""Studies defined by TOML files: reading and validating them."""

from __future__ import annotations

import os
from collections.abc import Mapping
from itertools import islice
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from mpmcol.case.fields import shortened
from mpmcol.case.problem import MOST_SHOWN
from mpmcol.case.source import Source, read_source, shipped_cases
from mpmcol.errors import UsageError, suggestion

Value = str | bool | float
CASE_KEYS = {"extends", "geometry", "stages", "material"}  # at the top of a case file; a study does not have them


class DefinitionTable(BaseModel):
    """A table of the TOML file of a study; unknown keys are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True)


T = TypeVar("T", bound=DefinitionTable)


def shipped_definitions(folder: str) -> dict[str, Path]:
    """Return the shipped definitions of one kind by name, from a folder beside the shipped cases."""
    found = (next(iter(shipped_cases().values())).parent / folder).glob("*.toml")
    return {path.stem: path for path in sorted(found)}


def load_definition(source: str, shipped: Mapping[str, Path], kind: str, model: type[T]) -> T:
    """Load a definition: a shipped one by its name, or a file.

    Args:
        kind: word for messages, such as "study".

    Raises:
        CaseError: the file cannot be read or is not valid TOML.
        UsageError: there is no such file, or a value is wrong; the message names file, line and key.
    """
    path = shipped.get(source, Path(source))
    if not os.path.exists(path):  # unlike Path.exists it accepts any text, for example one that is too long for a path
        raise UsageError(f"{shortened(source, 200)}: no such {kind}; {suggestion(source, shipped)}")
    content = read_source(shortened(str(path), 200), path)
    try:
        return model.model_validate(content.tables)
    except ValidationError as invalid:
        if CASE_KEYS & content.tables.keys():
            raise UsageError(f"{content.name} is a case file; expected the TOML file of a {kind}") from None
        errors = islice(invalid.errors(include_url=False), MOST_SHOWN)
        raise UsageError("\n".join(_message(content, error) for error in errors)) from None


def as_text(value: Value) -> str:
    """Format a value as in `--set KEY=VALUE`."""
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:.9g}" if isinstance(value, float) else str(value)


def as_overrides(values: Mapping[str, Value]) -> list[str]:
    """Format values as `--set` takes them."""
    return [f"{key}={as_text(value)}" for key, value in values.items()]


def _message(source: Source, error: Any) -> str:
    key = tuple(str(part) for part in error["loc"])
    line, name = source.location(key)[0], shortened(".".join(key), 100)
    where = f"{source.name}:{line}" if line else source.name
    return f"{where}: {name + ': ' if name else ''}{error['msg'].removeprefix('Value error, ')}"
