"""Unknowns of a fit: keys of the case with the ranges in which their values are sought."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from mpmcol.case import load_case
from mpmcol.case.fields import number_of
from mpmcol.case.problem import case_error, set_option
from mpmcol.case.reference import field_at
from mpmcol.case.values import leaf_values
from mpmcol.errors import CaseError, UsageError
from mpmcol.studies.runs import CFL

MOST = 3
SPACING = "grid.spacing"
OWN_KEYS = (SPACING, CFL)  # in which repeated runs differ
DIGITS = 6  # of the values at which runs are computed
EXPECTED = "expected KEY=LOW:HIGH, for example material.friction_deg=20:45"


@dataclass(frozen=True)
class Unknown:
    """A key of the case and the ends of its range, in the unit of the key."""

    key: str
    low: float
    high: float

    @property
    def name(self) -> str:
        """The key without its table."""
        return self.key.rpartition(".")[2]

    @property
    def unit(self) -> str:
        """Unit of the values."""
        number = number_of(field_at(tuple(self.key.split(".")), ""))
        return number.unit if number else ""

    def at(self, share: float) -> float:
        """The value at a share of the range, 0 to 1, with DIGITS digits."""
        return float(f"{self.low + share * (self.high - self.low):.{DIGITS}g}")


def parse_unknowns(texts: Sequence[str], source: str | Path, overrides: Sequence[str]) -> list[Unknown]:
    """The unknowns given as KEY=LOW:HIGH; both ends must be valid values of the case.

    Raises:
        UsageError: a text is not of this form, a key is not a real number, or is given twice, or there are too many.
        CaseError: a value is invalid.
    """
    unknowns: list[Unknown] = []
    for text in texts:
        key, _, ends = (part.strip() for part in text.partition("="))
        low, colon, high = (part.strip() for part in ends.partition(":"))
        if not (key and colon and low and high):
            raise UsageError(f"--vary {text}: {EXPECTED}")
        unknowns.append(_checked(text, key, [_value(text, key, end, source, overrides) for end in (low, high)]))
    _require_different(unknowns, overrides)
    return unknowns


def unknowns_of(ranges: Mapping[str, Sequence[float]], source: str | Path, overrides: Sequence[str]) -> list[Unknown]:
    """The unknowns given as numbers. Raises as `parse_unknowns`."""
    for key, ends in ranges.items():
        if np.shape(ends) != (2,):
            raise UsageError(f"vary {key} = {ends!r}: expected the two ends of a range, for example (20, 45)")
    texts = [f"{key}={float(low)!r}:{float(high)!r}" for key, (low, high) in ranges.items()]
    return parse_unknowns(texts, source, overrides)


def settings(unknowns: Sequence[Unknown], shares: np.ndarray) -> list[str]:
    """Values at shares (n,) of the ranges, as `--set` takes them."""
    return [f"{one.key}={one.at(float(share))!r}" for one, share in zip(unknowns, shares, strict=True)]


def _value(text: str, key: str, end: str, source: str | Path, overrides: Sequence[str]) -> float:
    """A value of a key in the unit of the key. Raises CaseError if it is invalid."""
    setting = f"{key}={end}"
    try:
        value = leaf_values(load_case(source, [*overrides, setting])).get(key)
    except CaseError as error:  # the user gave --vary
        own = set_option(setting)
        found = [replace(one, file=f"--vary {text}") if one.file == own else one for one in error.problems]
        raise case_error(found) from None
    if not isinstance(value, float) or not np.isfinite(value):
        raise UsageError(f"--vary {text}: {key} is not a real number; {EXPECTED}")
    return float(value)


def _checked(text: str, key: str, ends: Sequence[float]) -> Unknown:
    low, high = ends
    if not low < high:
        raise UsageError(f"--vary {text}: the end of a range must be greater than its start; {EXPECTED}")
    return Unknown(key, low, high)


def _require_different(unknowns: Sequence[Unknown], overrides: Sequence[str]) -> None:
    keys = [one.key for one in unknowns]
    given = {text.partition("=")[0].strip() for text in overrides}
    if len(keys) > MOST:
        raise UsageError(f"{len(keys)} unknowns; a fit takes at most {MOST}")
    for key in keys:
        if key in OWN_KEYS:
            raise UsageError(f"a fit varies {key} itself, between repeated runs; choose other keys")
        if keys.count(key) > 1 or key in given:
            raise UsageError(f"{key} is given twice; give each key once, with --vary or with --set")
