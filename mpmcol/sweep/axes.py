"""Axes of a sweep: the keys of the case that vary and their values, parsed from the options of the command line."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import isfinite

from mpmcol.case import Problem
from mpmcol.case.overrides import split_setting
from mpmcol.case.problem import set_option

ASPECT, SLOPE = "geometry.aspect", "geometry.slope_deg"
DEFAULT_STEP = 0.5
MOST_VALUES = 10_000
EXPECTED = "expected LOW:HIGH, LOW:HIGH:STEP or LOW:HIGH/COUNT, for example 0.5:7, 0.5:7:0.25 or 0.5:7/14"

# Possessive quantifiers (++, *+): the time for a long text that does not match stays linear in its length.
_NUMBER = r"[-+]?(?:\d++\.?\d*+|\.\d++)(?:[eE][-+]?\d++)?"
_PLAIN = re.compile(_NUMBER)
_DASHED = re.compile(r"[\d.]++ *[-;] *[\d.]++")  # looks like a range or a list
_RANGE = re.compile(rf"({_NUMBER}):({_NUMBER})(?::({_NUMBER})|/(\d+))?")
_DECIMALS = 12
_STEP_TOLERANCE = 1e-9  # in steps: allowed deviation of a range from a whole number of steps
_BRACKETS = {"[": 1, "{": 1, "]": -1, "}": -1}


@dataclass(frozen=True)
class Axis:
    """A key of the case and the values that it takes, each as the text of a TOML value or a bare word."""

    key: str
    values: tuple[str, ...]


def parse_axes(
    aspect: str | None, settings: Sequence[str], slope: str | None = None
) -> tuple[list[Axis], list[Problem]]:
    """Axes from the values of --aspect and --slope and the KEY=VALUES of --set, and the problems of invalid ones."""
    axes: dict[str, Axis] = {}
    problems: list[Problem] = []
    for option, key, text in _options(aspect, slope, settings):
        try:
            if not (key and text):
                raise ValueError("expected KEY=VALUES, for example material.friction_deg=30,33,36")
            if key in axes:
                raise ValueError(f"{key} is given twice; give all its values once, separated by commas")
            axes[key] = Axis(key, parse_values(text))
        except ValueError as error:
            problems.append(Problem(option, None, key, str(error), ""))
    if not axes and not problems:
        hint = "give --aspect 0.5:7, --slope 0:20:5, or --set material.friction_deg=30,33,36"
        problems.append(Problem("mpmcol sweep", None, "", "no key to vary", hint))
    return list(axes.values()), problems


def _options(aspect: str | None, slope: str | None, settings: Iterable[str]) -> Iterator[tuple[str, str, str]]:
    """The option as it was given, its key and its values."""
    for name, key, values in (("--aspect", ASPECT, aspect), ("--slope", SLOPE, slope)):
        if values is not None:
            yield f"{name} {values}", key, values.strip()
    for setting in settings:
        yield set_option(setting), *split_setting(setting)


def parse_values(text: str) -> tuple[str, ...]:
    """Read values separated by commas, each a word, a number or a range; repeated values are dropped.

    0.5:7 has steps of 0.5, 0.5:7:0.25 the given step, and 0.5:7/14 is 14 values; both ends are included. Text in
    quotes or brackets is one value.

    Raises:
        ValueError: with all problems, also where a range is not a whole number of steps long.
    """
    values: dict[str, None] = {}
    problems: list[str] = []
    for part in _split(text):
        try:
            values |= dict.fromkeys(_values_of(part.strip()))
        except ValueError as error:
            problems.append(str(error))
    if problems:
        raise ValueError("; ".join(problems))
    if len(values) > MOST_VALUES:
        raise ValueError(f"{len(values):,} values are too many; expected at most {MOST_VALUES:,}")
    return tuple(values)


def _split(text: str) -> Iterator[str]:
    """The parts between commas; commas in quotes and brackets do not separate."""
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
        raise ValueError("a value is missing: expected values separated by commas, for example 0.55,0.9 or 0.5:7")
    if _PLAIN.fullmatch(part):
        yield _number_text(float(part))
    elif ":" in part and part[0] not in "\"'[{":
        yield from _range(part)
    elif _DASHED.fullmatch(part):
        raise ValueError(f"{part}: {EXPECTED}")
    else:
        yield part


def _range(part: str) -> Iterator[str]:
    match = _RANGE.fullmatch(part)
    if match is None:
        raise ValueError(f"{part}: {EXPECTED}")
    low, high = float(match[1]), float(match[2])
    if not (low < high and isfinite(high - low)):
        raise ValueError(f"{part}: the end of a range must be greater than its start; {EXPECTED}")
    steps = _steps(part, low, high, match[3], match[4])
    for i in range(steps):
        yield _number_text(round(low + i * (high - low) / steps, _DECIMALS))
    yield _number_text(high)


def _steps(part: str, low: float, high: float, step_text: str | None, count_text: str | None) -> int:
    """Number of steps between the ends."""
    if count_text is not None:
        steps = float(count_text) - 1.0
        if steps < 1.0:
            raise ValueError(f"{part}: a range has at least 2 values")
    else:
        step = DEFAULT_STEP if step_text is None else float(step_text)
        if step <= 0.0:
            raise ValueError(f"{part}: the step must be > 0")
        steps = (high - low) / step
        if abs(steps - round(steps)) > _STEP_TOLERANCE * max(steps, 1.0) or steps < 0.5:
            raise ValueError(_step_problem(part, low, high, step))
    if steps >= MOST_VALUES:
        raise ValueError(f"{part}: {steps + 1.0:,.0f} values are too many; expected at most {MOST_VALUES:,}")
    return round(steps)


def _step_problem(part: str, low: float, high: float, step: float) -> str:
    whole = int((high - low) / step)
    last = f"{_number_text(low)}:{_number_text(round(low + whole * step, _DECIMALS))}:{_number_text(step)}"
    instead = f"{last} or {_number_text(low)}:{_number_text(high)}/{max(whole, 1) + 1}"
    if whole == 0:
        instead = f"a smaller step or a count, for example {_number_text(low)}:{_number_text(high)}/5"
    return f"{part}: the range is not a whole number of steps of {step:g}; give {instead}"


def _number_text(number: float) -> str:
    """A number as a case file has it; 2 instead of 2.0, so that it is also valid for keys that require an integer."""
    return repr(number).removesuffix(".0")
