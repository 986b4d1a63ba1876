"""The values of an axis of a sweep, from the text in which they are given."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from math import isfinite

DEFAULT_STEP = 0.5
MOST_VALUES = 10_000
EXPECTED = "expected LO:HI, LO:HI:STEP or LO:HI/COUNT, such as 0.5:7, 0.5:7:0.25 or 0.5:7/14"

# possessive (++, *+): a long text that does not match takes no longer than one that does
_NUMBER = r"[-+]?(?:\d++\.?\d*+|\.\d++)(?:[eE][-+]?\d++)?"
_PLAIN = re.compile(_NUMBER)
_RANGE = re.compile(rf"({_NUMBER}):({_NUMBER})(?::({_NUMBER})|/(\d+))?")
_DECIMALS = 12
_CLOSE = 1e-9  # in steps: how near to a whole number of them the length of a range must be
_BRACKETS = {"[": 1, "{": 1, "]": -1, "}": -1}


@dataclass(frozen=True)
class Axis:
    """A key of the case and the values that it takes, each as the text of a TOML value or a bare word."""

    key: str
    values: tuple[str, ...]


def parse_values(text: str) -> tuple[str, ...]:
    """Read values separated by commas, each a word, a number or a range; every value once.

    0.5:7 goes in steps of 0.5, 0.5:7:0.25 in the given ones, and 0.5:7/14 is 14 values; both ends are values. What
    stands in quotes or brackets is one value.

    Raises:
        ValueError: in words, with all that is wrong; also where a range is not a whole number of steps long.
    """
    values: dict[str, None] = {}
    wrong: list[str] = []
    for part in _split(text):
        try:
            values |= dict.fromkeys(_values_of(part.strip()))
        except ValueError as error:
            wrong.append(str(error))
    if wrong:
        raise ValueError("; ".join(wrong))
    if len(values) > MOST_VALUES:
        raise ValueError(f"{len(values):,} values are too many")
    return tuple(values)


def _split(text: str) -> Iterator[str]:
    """The parts between commas, those in quotes and brackets left alone."""
    quote, depth, start = "", 0, 0
    for i, character in enumerate(text):
        if quote:
            quote = "" if character == quote else quote
        elif character in "\"'":
            quote = character
        elif character == "," and depth == 0:
            yield text[start:i]
            start = i + 1
        else:
            depth += _BRACKETS.get(character, 0)
    yield text[start:]


def _values_of(part: str) -> Iterator[str]:
    if not part:
        raise ValueError("a value is missing: expected values separated by commas, such as 0.55,0.9 or 0.5:7")
    if _PLAIN.fullmatch(part):
        yield _written(float(part))
    elif ":" in part and part[0] not in "\"'[{":
        yield from _range(part)
    else:
        yield part


def _range(part: str) -> Iterator[str]:
    match = _RANGE.fullmatch(part)
    if match is None:
        raise ValueError(f"{part}: {EXPECTED}")
    low, high = float(match[1]), float(match[2])
    if not (low < high and isfinite(high - low)):
        raise ValueError(f"{part}: a range must rise, from one number to another; {EXPECTED}")
    steps = _steps(part, low, high, match[3], match[4])
    for i in range(steps):
        yield _written(round(low + i * (high - low) / steps, _DECIMALS))
    yield _written(high)


def _steps(part: str, low: float, high: float, step_text: str | None, count_text: str | None) -> int:
    """How many steps there are between the ends."""
    if count_text is not None:
        steps = float(count_text) - 1.0
        if steps < 1.0:
            raise ValueError(f"{part}: a range has at least 2 values")
    else:
        step = DEFAULT_STEP if step_text is None else float(step_text)
        if step <= 0.0:
            raise ValueError(f"{part}: the step must be above 0")
        steps = (high - low) / step
        if abs(steps - round(steps)) > _CLOSE * max(steps, 1.0) or steps < 0.5:
            raise ValueError(_misfit(part, low, high, step))
    if steps >= MOST_VALUES:
        raise ValueError(f"{part}: {steps + 1.0:,.0f} values are too many")
    return round(steps)


def _misfit(part: str, low: float, high: float, step: float) -> str:
    whole = int((high - low) / step)
    last = f"{_written(low)}:{_written(round(low + whole * step, _DECIMALS))}:{_written(step)}"
    instead = f"{last} or {_written(low)}:{_written(high)}/{max(whole, 1) + 1}"
    if whole == 0:
        instead = f"a smaller step or a count, such as {_written(low)}:{_written(high)}/5"
    return f"{part}: the range is not a whole number of steps of {step:g} long; give {instead}"


def _written(number: float) -> str:
    """A number as a case file has it; 2 and not 2.0, so that it also suits keys that want a whole number."""
    return repr(number).removesuffix(".0")
