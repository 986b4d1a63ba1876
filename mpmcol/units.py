"""Keys of a case file: quantities in SI units or as strings with a unit, and options."""

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

# unit -> (base unit, factor); units with the same base unit can be converted into each other
FACTORS: dict[str, tuple[str, float]] = {
    "m": ("m", 1.0), "mm": ("m", 1e-3), "cm": ("m", 1e-2),
    "s": ("s", 1.0), "ms": ("s", 1e-3),
    "Pa": ("Pa", 1.0), "kPa": ("Pa", 1e3), "MPa": ("Pa", 1e6), "GPa": ("Pa", 1e9),
    "deg": ("rad", DEGREE), "°": ("rad", DEGREE), "rad": ("rad", 1.0),
    "kg/m3": ("kg/m3", 1.0), "g/cm3": ("kg/m3", 1e3),
    "m/s": ("m/s", 1.0), "mm/s": ("m/s", 1e-3), "cm/s": ("m/s", 1e-2),
    "m/s2": ("m/s2", 1.0),
    "": ("", 1.0), "%": ("", 1e-2),
}  # fmt: skip

_UNIT_WEIGHTS = {"N/m3": 1.0, "kN/m3": 1e3, "MN/m3": 1e6}  # N/m3, given instead of a density

# Limits of the magnitude of a quantity: no column needs more, and products of larger numbers could overflow.
SMALLEST, LARGEST = 1e-30, 1e30
# possessive quantifiers (++, *+): the time is linear in the length of the text
_NUMBER_AND_UNIT = re.compile(r"\s*+([-+]?(?:\d++\.?\d*+|\.\d++)(?:[eE][-+]?\d++)?)\s*+(\S*+)\s*+", re.ASCII)
DECIMAL_COMMA = re.compile(r"\s*+[-+]?\d++,\d", re.ASCII)
_COMPARISONS = {
    "gt": (">", operator.gt),
    "ge": (">=", operator.ge),
    "lt": ("<", operator.lt),
    "le": ("<=", operator.le),
}


class Table(BaseModel):
    """A table of a case file; immutable, unknown keys are errors."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)


@dataclass(frozen=True)
class Number:
    """Unit and bounds of a quantity; calling it converts a value of a case file to a float in `unit`."""

    unit: str
    bounds: dict[str, float]
    allow_inf: bool = False
    is_tangent: bool = False  # an angle with its unit is replaced by its tangent

    @cached_property
    def interval(self) -> str:
        """Bounds of the accepted values, for example "> 0 and < 0.5"; empty without bounds."""
        limits = " and ".join(f"{_COMPARISONS[name][0]} {bound:g}" for name, bound in self.bounds.items())
        return limits + (", or inf" if self.allow_inf else "")

    @cached_property
    def expected(self) -> str:
        """Description of the accepted values, for example "a number > 0 and < 0.5, in Pa"."""
        angle = ', or an angle such as "22 deg"' if self.is_tangent else ""
        return f"a number {self.interval}".rstrip() + (f", in {self.unit}" if self.unit else "") + angle

    def __call__(self, value: Any) -> float | None:
        """Convert and check a value; None stays None. Raises PydanticCustomError with the reason."""
        if value is None:
            return None
        try:
            number = self._convert(value)
        except (ValueError, OverflowError) as wrong:
            raise self._error(str(wrong) if isinstance(value, str) else "") from None
        if math.isnan(number) or (math.isinf(number) and not self.allow_inf) or not self._within(number):
            raise self._error()
        if number and not SMALLEST <= abs(number) <= LARGEST and math.isfinite(number):
            raise self._error(f"magnitude not between {SMALLEST:g} and {LARGEST:g}")
        return number

    def _convert(self, value: Any) -> float:
        if isinstance(value, str):
            return tangent(value) if self.is_tangent else to_unit(value, self.unit)
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise ValueError
        return float(value)

    def _within(self, number: float) -> bool:
        return all(_COMPARISONS[name][1](number, bound) for name, bound in self.bounds.items())

    def _error(self, reason: str = "") -> PydanticCustomError:
        text = f"{reason}; expected {self.expected}" if reason else f"expected {self.expected}"
        return PydanticCustomError("quantity", "{text}", {"text": text})


def quantity(
    description: str,
    unit: str = "",
    default: Any = PydanticUndefined,
    *,
    gt: float | None = None,
    ge: float | None = None,
    lt: float | None = None,
    le: float | None = None,
    allow_inf: bool = False,
    is_tangent: bool = False,
) -> Any:
    """Declare a key for a physical quantity; without a default it is required.

    The key accepts an integer, a float, or a string with a unit such as "2 mm"; its value is a float in `unit`.

    Args:
        description: one sentence for the reference.
        unit: unit of the value, a key of FACTORS.
        default: default value in `unit`, or None for an optional key.
        gt, ge, lt, le: bounds in `unit`.
        allow_inf: whether inf is accepted.
        is_tangent: whether a string with an angle, such as "22 deg", is accepted and replaced by its tangent.
    """
    limits = {"gt": gt, "ge": ge, "lt": lt, "le": le}
    number = Number(unit, {name: bound for name, bound in limits.items() if bound is not None}, allow_inf, is_tangent)
    field: FieldInfo = Field(default=default, description=description, json_schema_extra={"unit": unit})
    field.metadata += [number, BeforeValidator(number)]
    return field


def option(description: str, default: Any = PydanticUndefined) -> Any:
    """Declare a key that is not a quantity (string, boolean, integer or table); without a default it is required."""
    return Field(default=default, description=description)


def to_unit(text: str, unit: str) -> float:
    """Convert a number with an optional unit ("2 mm") to `unit`; raises ValueError with the reason."""
    match = _NUMBER_AND_UNIT.fullmatch(text)
    if DECIMAL_COMMA.match(text):
        raise ValueError("the decimal separator is a point")
    if match is None:
        raise ValueError("not a number with a unit")
    number, written = float(match[1]), match[2] or unit
    if unit == "kg/m3" and (weight := _UNIT_WEIGHTS.get(written)):
        raise ValueError(
            f'"{written}" is a unit weight; the density is that over g: "{number * weight / 9.81:.4g} kg/m3"'
        )
    if written not in FACTORS:
        raise ValueError(f'unknown unit "{written[:20]}"{_known(unit)}')
    (base, factor), (target, divisor) = FACTORS[written], FACTORS[unit]
    if base != target:
        raise ValueError(f'"{written}" cannot be converted to {unit or "a number without unit"}{_known(unit)}')
    # rounded to 15 digits, so that "2 mm" is exactly 0.002
    return number if written == unit else float(f"{number * factor / divisor:.15g}")


def _known(unit: str) -> str:
    """The units that can be converted to `unit`, as an addition to a message."""
    names = [name for name, (base, _) in FACTORS.items() if name and base == FACTORS[unit][0]]
    return f" (known: {', '.join(names)})"


def tangent(text: str) -> float:
    """A number, or the tangent of an angle with its unit; raises ValueError with the reason."""
    try:
        return to_unit(text, "")
    except ValueError:
        return math.tan(to_unit(text, "rad"))


def counted(count: int, noun: str) -> str:
    """A number of things: "1 cell", "2 cells"."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def duration_text(seconds: float) -> str:
    """A time in the unit that gives a readable number."""
    if seconds < 120.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 7200.0 else f"{seconds / 3600.0:.1f} h"


def length_text(metres: float) -> str:
    """A length with four digits, in mm below one metre and in m above."""
    return f"{1e3 * metres:.4g} mm" if abs(metres) < 1.0 else f"{metres:.4g} m"


def pressure_text(pascals: float) -> str:
    """A stress with four digits, in Pa below one kPa and in kPa above."""
    return f"{pascals:.4g} Pa" if abs(pascals) < 1e3 else f"{1e-3 * pascals:.4g} kPa"


def length_scale(metres: float) -> tuple[str, float]:
    """Unit for the axis of a chart that shows lengths up to `metres`, "mm" or "m", and the factor from m to it."""
    return ("mm", 1e3) if abs(metres) < 1.0 else ("m", 1.0)
