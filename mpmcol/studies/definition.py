"""What a report consists of, as TOML files: reading and checking them, and the values in them."""

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
from mpmcol.errors import UsageError
from mpmcol.selection import suggestion

Value = str | bool | float


class Strict(BaseModel):
    """A table of a definition: keys that it does not know are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True)


M = TypeVar("M", bound=Strict)


def shipped_definitions(folder: str) -> dict[str, Path]:
    """Definitions of a kind that come with mpmcol, by name: those in a folder beside the shipped cases."""
    found = (next(iter(shipped_cases().values())).parent / folder).glob("*.toml")
    return {path.stem: path for path in sorted(found)}


def load_definition(source: str, shipped: Mapping[str, Path], kind: str, model: type[M]) -> M:
    """Read a definition: a shipped one by its name, or a file.

    Args:
        kind: what it is called, such as "study".

    Raises:
        CaseError: it cannot be read or is no TOML; with file and line.
        UsageError: it is wrong; with file, line and key.
    """
    path = shipped.get(source, Path(source))
    if not os.path.exists(path):  # unlike Path.exists it is never upset by an impossible name
        raise UsageError(f"{shortened(source, 200)}: no such {kind}; {suggestion(source, shipped)}")
    content = read_source(shortened(str(path), 200), path)
    try:
        return model.model_validate(content.tables)
    except ValidationError as invalid:
        told = islice(invalid.errors(include_url=False), MOST_SHOWN)
        raise UsageError("\n".join(_told(content, error) for error in told)) from None


def as_text(value: Value) -> str:
    """A value as it is written in `--set KEY=VALUE`."""
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:.9g}" if isinstance(value, float) else str(value)


def _told(source: Source, error: Any) -> str:
    key = tuple(str(part) for part in error["loc"])
    line, name = source.location(key)[0], shortened(".".join(key), 100)
    place = f"{source.name}:{line}" if line else source.name
    return f"{place}: {name + ': ' if name else ''}{error['msg'].removeprefix('Value error, ')}"
