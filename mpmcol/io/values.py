"""Nested values as JSON text and as flat tables."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Collection, Iterator, Mapping
from typing import Any


def undefined(value: float) -> None:
    """JSON null for a measured number that is not finite: it has no value."""


def toml_notation(value: float) -> str:
    """The TOML notation (inf, -inf, nan) of an input that is not finite, such as an infinite stages.gate_speed.

    With null, the run could not be repeated from the file.
    """
    return str(value)


def to_json(value: Any, non_finite: Callable[[float], Any] = undefined, indent: int | None = None) -> str:
    """Standard JSON, which has no NaN or infinity: `non_finite` replaces such numbers."""
    return json.dumps(_replaced(value, non_finite), indent=indent, allow_nan=False)


def flatten(values: Mapping[str, Any], unnamed: Collection[str] = (), prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Entries of nested mappings with dotted names; keys in `unnamed` (for example "mean") add nothing to the name."""
    for name, value in values.items():
        if isinstance(value, Mapping):
            yield from flatten(value, unnamed, f"{prefix}{name}.")
        else:
            yield prefix.rstrip(".") if name in unnamed else prefix + name, value


def _replaced(value: Any, non_finite: Callable[[float], Any]) -> Any:
    if isinstance(value, Mapping):
        return {name: _replaced(entry, non_finite) for name, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [_replaced(entry, non_finite) for entry in value]
    return non_finite(value) if isinstance(value, float) and not math.isfinite(value) else value
