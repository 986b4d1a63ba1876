"""What a report consists of, as TOML files: reading and checking them, and the values in them."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from difflib import get_close_matches
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from mpmcol.case.source import shipped_cases
from mpmcol.errors import UsageError

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
    """Read a definition: a shipped one by its name, or a file. Raises UsageError that names file and key.

    Args:
        kind: what it is called, such as "study".
    """
    path = shipped.get(source, Path(source))
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        near = get_close_matches(source, shipped, n=1)
        hint = f"did you mean {near[0]!r}?" if near else f"shipped: {', '.join(shipped)}"
        raise UsageError(f"{source}: no such {kind}; {hint}") from None
    except (OSError, ValueError) as error:  # a TOMLDecodeError tells line and column
        raise UsageError(f"{path}: cannot be read: {error}") from None
    try:
        return model.model_validate(content)
    except ValidationError as invalid:
        raise UsageError("\n".join(_told(path, error) for error in invalid.errors())) from None


def as_text(value: Value) -> str:
    """A value as it is written in `--set KEY=VALUE`."""
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:.9g}" if isinstance(value, float) else str(value)


def _told(path: Path, error: Any) -> str:
    key = ".".join(str(part) for part in error["loc"])
    return f"{path}: {key + ': ' if key else ''}{error['msg'].removeprefix('Value error, ')}"
