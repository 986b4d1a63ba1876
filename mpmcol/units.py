"""Quantities of a case file: strict numbers in SI, or strings with a unit that are converted to it."""

from __future__ import annotations

import math
import operator
import re
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field
from pydantic.fields import FieldInfo
from pydantic_core import PydanticCustomError, PydanticUndefined

DEGREE = math.pi / 180.0

# unit -> (base unit, factor): two units convert into each other when they share the base unit
FACTORS: dict[str, tuple[str, float]] = {
    "m": ("m", 1.0), "mm": ("m", 1e-3), "cm": ("m", 1e-2),
    "s": ("s", 1.0), "ms": ("s", 1e-3),
    "Pa": ("Pa", 1.0), "kPa": ("Pa", 1e3), "MPa": ("Pa", 1e6), "GPa": ("Pa", 1e9),
    "deg": ("rad", DEGREE), "rad": ("rad", 1.0),
    "kg/m3": ("kg/m3", 1.0), "g/cm3": ("kg/m3", 1e3),
    "m/s": ("m/s", 1.0), "mm/s": ("m/s", 1e-3), "cm/s": ("m/s", 1e-2),
    "m/s2": ("m/s2", 1.0),
    "": ("", 1.0), "%": ("", 1e-2),
}  # fmt: skip

# Beyond these no quantity of a column lies, and products of some of them would overflow.
SMALLEST, LARGEST = 1e-30, 1e30
# possessive (++, *+): a long text that does not match takes no longer than one that does
_NUMBER_AND_UNIT = re.compile(r"\s*+([-+]?(?:\d++\.?\d*+|\.\d++)(?:[eE][-+]?\d++)?)\s*+(\S*+)\s*+", re.ASCII)
_COMPARISONS = {
    "gt": (">", operator.gt),
    "ge": (">=", operator.ge),
    "lt": ("<", operator.lt),
    "le": ("<=", operator.le),
}


class Keys(BaseModel):
    """A table of a case file: frozen, and a key that it does not know is an error."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)


@dataclass(frozen=True)
class Number:
    """What a float key accepts; calling it turns a value of the case file into a float in `unit`."""

    unit: str
    bounds: dict[str, float]
    allow_inf: bool = False

    @cached_property
    def expected(self) -> str:
        """Say what the number must be, for example "a number > 0 and < 0.5, in Pa"."""
        limits = " and ".join(f"{_COMPARISONS[name][0]} {bound:g}" for name, bound in self.bounds.items())
        parts = ["a number", f" {limits}" if limits else "", ", or inf" if self.allow_inf else ""]
        return "".join(parts) + (f", in {self.unit}" if self.unit else "")

    def __call__(self, value: Any) -> float | None:
        """Convert and check; an absent value (None) stays absent. PydanticCustomError says what is wrong."""
        if value is None:
            return None
        try:
            number = self._convert(value)
        except (ValueError, OverflowError) as wrong:
            raise self._error(str(wrong) if isinstance(value, str) else "") from None
        if math.isnan(number) or (math.isinf(number) and not self.allow_inf) or not self._within(number):
            raise self._error()
        if number and not SMALLEST <= abs(number) <= LARGEST and math.isfinite(number):
            raise self._error(f"too {'large' if abs(number) > 1.0 else 'small'} for any quantity")
        return number

    def _convert(self, value: Any) -> float:
        if isinstance(value, str):
            return to_unit(value, self.unit)
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise ValueError
        return float(value)

    def _within(self, number: float) -> bool:
        return all(_COMPARISONS[name][1](number, bound) for name, bound in self.bounds.items())

    def _error(self, reason: str = "") -> PydanticCustomError:
        text = f"{reason}; expected {self.expected}" if reason else f"expected {self.expected}"
        return PydanticCustomError("quantity", "{text}", {"text": text})


def quantity(
    doc: str,
    unit: str = "",
    default: Any = PydanticUndefined,
    *,
    gt: float | None = None,
    ge: float | None = None,
    lt: float | None = None,
    le: float | None = None,
    allow_inf: bool = False,
) -> Any:
    """Declare a float key: one sentence, its unit, its default (without one the key is required), its bounds.

    The key takes an integer, a float, or a string with a unit such as "2 mm"; the value is in `unit`.
    """
    limits = {"gt": gt, "ge": ge, "lt": lt, "le": le}
    number = Number(unit, {name: bound for name, bound in limits.items() if bound is not None}, allow_inf)
    field: FieldInfo = Field(default=default, description=doc, json_schema_extra={"unit": unit})
    field.metadata += [number, BeforeValidator(number)]
    return field


def choice(doc: str, default: Any = PydanticUndefined) -> Any:
    """Declare a key that is a word, a text, a yes or no, or an integer: one sentence and its default."""
    return Field(default=default, description=doc)


def to_unit(text: str, unit: str) -> float:
    """Read a number with an optional unit ("2 mm") and give it in `unit`; ValueError says what is wrong."""
    match = _NUMBER_AND_UNIT.fullmatch(text)
    if match is None:
        raise ValueError("this is not a number with a unit")
    number, written = float(match[1]), match[2] or unit
    if written not in FACTORS:
        raise ValueError(f'unknown unit "{written[:20]}"')
    (base, factor), (wanted, divisor) = FACTORS[written], FACTORS[unit]
    if base != wanted:
        raise ValueError(f'"{written}" cannot be converted')
    # rounded to 15 digits, so that "2 mm" is exactly 0.002 and not 0.002 plus an ulp
    return number if written == unit else float(f"{number * factor / divisor:.15g}")
