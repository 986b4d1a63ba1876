"""The outline of a column: a polygon whose points are given in the case or in a CSV file."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pydantic_core import PydanticCustomError

from mpmcol.case.fields import shortened, shown
from mpmcol.case.small_file import read_small
from mpmcol.units import Number

Point = tuple[float, float]
Outline = tuple[Point, ...]

COORDINATE = Number("m", {"ge": 0.0})
FEWEST, MOST = 3, 500  # points
LARGEST_FILE = 200_000  # bytes
THINNEST = 1e-6  # of the area of the bounding box
RECTANGLE = 1.0 - 1e-12  # of that rectangle: a larger part is all of it
_HEADER = re.compile(r"\s*+([a-z]\w*+)\s*+(?:[\[(]\s*+(\S*?)\s*+[\])])?\s*+", re.IGNORECASE)


@dataclass(frozen=True)
class OutlinePoints:
    """Conversion of the points of a case file to an outline, counterclockwise and without a repeated last point."""

    expected: str = f"an array of {FEWEST} to {MOST} points [x, y] in m, x and y >= 0, or the path of a CSV file"

    def __call__(self, value: Any) -> Outline | None:
        """Convert and check the points; None stays None. Raises PydanticCustomError that names the wrong point."""
        if value is None:
            return None
        try:
            return _checked(value)
        except ValueError as wrong:
            text = str(wrong) or f"expected {self.expected}"
            raise PydanticCustomError("quantity", "{text}", {"text": text}) from None


def area(outline: Outline) -> float:
    """Area of a polygon, m2; positive if its points are counterclockwise."""
    x, y = np.array(outline).T
    return float(0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def extent(outline: Outline) -> Point:
    """Largest x and y, m."""
    return max(x for x, _ in outline), max(y for _, y in outline)


def is_rectangle(outline: Outline) -> bool:
    """Whether the polygon fills the rectangle from (0, 0) to its largest x and y."""
    width, height = extent(outline)
    return area(outline) > RECTANGLE * width * height


def read_outline(path: Path) -> list[list[Any]]:
    """Read points from a CSV file: two columns x and y in m, or with a unit in a header such as "x [mm],y [mm]".

    Raises ValueError with line and reason.
    """
    try:
        content = read_small(path, LARGEST_FILE, "an outline")
    except OSError as error:
        raise ValueError(f"cannot be read: {error.strerror}") from None
    try:
        lines = content.decode("utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise ValueError("not a text file in UTF-8") from None
    rows = [(k, line.split(",")) for k, line in enumerate(lines, 1) if line.strip() and line.lstrip()[0] != "#"]
    units = _units(*rows[0]) if rows and _HEADER.match(rows[0][1][0]) else None
    return [_point(k, row, units or ("m", "m")) for k, row in (rows[1:] if units else rows)]


def _units(line: int, header: list[str]) -> tuple[str, ...]:
    """Units of x and y from a header."""
    cells = [_HEADER.fullmatch(cell) for cell in header]
    if [cell[1].lower() if cell else "" for cell in cells] != ["x", "y"]:
        raise ValueError(f"line {line}: expected the header x,y or x [mm],y [mm], or two numbers")
    return tuple((cell[2] if cell else "") or "m" for cell in cells)


def _point(line: int, row: list[str], units: tuple[str, ...]) -> list[Any]:
    if len(row) != 2:
        hint = "" if len(row) < 2 else "; the decimal separator is a point"
        raise ValueError(f"line {line}: {len(row)} values, expected x and y, separated by a comma{hint}")
    try:
        return [COORDINATE(f"{text} {unit}") for text, unit in zip(row, units, strict=True)]
    except PydanticCustomError as wrong:
        raise ValueError(f"line {line}: {shortened(','.join(row), 40)}: {wrong.message()}") from None


def _checked(value: Any) -> Outline:
    if not isinstance(value, (list, tuple)):
        raise ValueError
    points = [_converted(k, point) for k, point in enumerate(value, 1)]
    if len(points) > FEWEST and points[0] == points[-1]:
        points.pop()
    if not FEWEST <= len(points) <= MOST:
        raise ValueError(f"{len(points)} points, expected {FEWEST} to {MOST}")
    for problem in _problems(np.array(points)):
        raise ValueError(problem)
    return tuple(points if area(tuple(points)) > 0.0 else points[::-1])


def _converted(number: int, point: Any) -> Point:
    if not isinstance(point, (list, tuple)) or len(point) != 2 or None in point:
        raise ValueError(f"point {number} is not a pair [x, y] of numbers")
    try:
        x, y = (COORDINATE(coordinate) for coordinate in point)
    except PydanticCustomError as wrong:
        raise ValueError(f"point {number}, {shown(point)}: {wrong.message()} for x and y") from None
    assert x is not None and y is not None
    return x, y


def _problems(points: np.ndarray) -> Iterator[str]:
    """What is wrong with a polygon of points (n, 2)."""
    names = [f"point {k}, [{x:g}, {y:g}]" for k, (x, y) in enumerate(points.tolist(), 1)]
    ends, edges = np.roll(points, -1, axis=0), np.roll(points, -1, axis=0) - points
    for repeated in np.flatnonzero(~edges.any(axis=1)):
        yield f"{names[repeated]} is given twice in a row"
    for k, crossed in enumerate(_crossings(points, ends)):
        for other in crossed[:1]:
            yield f"the edge from {names[k]}, crosses or touches the edge from {names[other]}: no polygon"
    size = points.max(axis=0)
    if not abs(area(tuple(map(tuple, points)))) > THINNEST * size.prod():
        yield "the points lie on a line: the polygon has no area"
    if points[:, 1].min() > 0.0:
        yield f"{names[points[:, 1].argmin()]} is the lowest: the material must stand on the base, y = 0"


def _crossings(starts: np.ndarray, ends: np.ndarray) -> Iterator[np.ndarray]:
    """For each edge, the later edges that it crosses or touches, apart from a common end of neighbours."""
    last = len(starts) - 1
    for k, (a, b) in enumerate(zip(starts, ends, strict=True)):
        other = np.arange(k + 1, last + 1)
        c, d = starts[other], ends[other]
        apart = (_side(a, b, c) * _side(a, b, d) > 0.0) | (_side(c, d, a) * _side(c, d, b) > 0.0)
        low, high = np.minimum(a, b), np.maximum(a, b)
        apart |= ((np.minimum(c, d) > high) | (np.maximum(c, d) < low)).any(axis=1)
        neighbour = (other == k + 1) | ((k == 0) & (other == last))
        reversing = (_side(a, b, c) == 0.0) & (_side(a, b, d) == 0.0) & ((d - c) @ (b - a) < 0.0)
        yield other[~apart & (~neighbour | reversing)]


def _side(a: np.ndarray, b: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Twice the area of the triangles a, b, p: its sign is the side of the line from a to b on which p lies."""
    return (b - a)[..., 0] * (p - a)[..., 1] - (b - a)[..., 1] * (p - a)[..., 0]
