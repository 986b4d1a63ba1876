"""Regular expressions take time in proportion to the length of a text, whatever a user gives."""

from __future__ import annotations

import importlib
import pkgutil
import re
import time
from collections.abc import Iterator
from itertools import product

import pytest

import mpmcol

PACKAGES = ("case", "cli", "io", "plotting", "setup", "sweep", "studies")
LENGTH, LONGEST = 5_000, 0.02  # characters; s of processor time, of which proportional time is a hundredth
REPEATED = (" ", "a", "1", ".", ",", "_", "-", "[", "(", "\t", "\\", "a ", "1 ", "a.", "1,", "[ ", ", ", "a = ", "e1")
STARTS, ENDS = ("", "a", "1", "a [", ",", "extends"), ("", "x", "!", "]")
NEVER_SEARCHED = ("mpmcol.sweep.axes._DASHED", "mpmcol.sweep.axes._RANGE")  # nor those that begin with spaces


def patterns() -> Iterator[tuple[str, re.Pattern[str]]]:
    """All compiled patterns that are values of a module, with their names."""
    names = ["mpmcol.units"]
    for package in PACKAGES:
        path = [f"{folder}/{package}" for folder in mpmcol.__path__]
        names += [one.name for one in pkgutil.walk_packages(path, f"mpmcol.{package}.") if ".render" not in one.name]
    for name in names:
        for key, value in vars(importlib.import_module(name)).items():
            if isinstance(value, re.Pattern):
                yield f"{name}.{key}", value


def seconds(pattern: re.Pattern[str], text: str, searches: bool) -> float:
    """Processor time of a match of the whole text or of a search, the shortest of three times."""
    times = []
    for _ in range(3):
        started = time.process_time()
        (pattern.search if searches else pattern.fullmatch)(text)
        times.append(time.process_time() - started)
        if times[-1] <= LONGEST:
            break
    return min(times)


def slow_texts(pattern: re.Pattern[str], searches: bool) -> Iterator[str]:
    """Texts of LENGTH characters with which a pattern takes too long: what is repeated, between a start and an end."""
    for unit, start, end in product(REPEATED, STARTS, ENDS):
        if seconds(pattern, start + unit * (LENGTH // len(unit)) + end, searches) > LONGEST:
            yield f"{start!r} + {unit!r} * n + {end!r}"


def test_no_text_takes_long() -> None:
    found = {}
    for name, pattern in patterns():
        searches = name not in NEVER_SEARCHED and not pattern.pattern.startswith(r"\s*")
        found[name] = [*slow_texts(pattern, False), *(slow_texts(pattern, True) if searches else [])]
    assert len(found) > 10 and {name: texts for name, texts in found.items() if texts} == {}


@pytest.mark.parametrize(
    ("pattern", "searches"), [(r",? *\ba = (\d+)", True), (r"\s*(\w+)\s*(?:[\[(](\w*)[\])])?\s*", False)]
)
def test_slow_patterns_are_found(pattern: str, searches: bool) -> None:
    assert next(slow_texts(re.compile(pattern), searches))
