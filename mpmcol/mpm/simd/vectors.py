"""The operations on vectors of eight doubles in plain Python, on NumPy arrays of eight numbers."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmcol.mpm.lanes import LANES

SWAPPED = [0, 4, 5, 6, 1, 2, 3, 7]


def load(array: np.ndarray, index: int) -> np.ndarray:
    """Eight consecutive doubles of a flat array, starting at `index`; behind its end, whatever memory holds there."""
    found = array[index : index + LANES]
    return np.pad(found, (0, LANES - len(found)))


def prefetch(array: np.ndarray, index: int) -> None:
    """Ask for the cache line of `array[index]`, which is read soon; the index may lie behind the end."""


def store(array: np.ndarray, index: int, value: np.ndarray) -> None:
    """Write eight doubles to a flat array, starting at `index`."""
    array[index : index + LANES] = value


def splat(x: float) -> np.ndarray:
    """The same number in all lanes."""
    return np.full(LANES, x)


def vector(x0: float, x1: float, x2: float, x3: float, x4: float, x5: float, x6: float, x7: float) -> np.ndarray:
    """A vector from its eight lanes."""
    return np.array([x0, x1, x2, x3, x4, x5, x6, x7], dtype=np.float64)


def lane(value: np.ndarray, index: int) -> float:
    """One lane of a vector."""
    return value[index]


def swap_halves(value: np.ndarray) -> np.ndarray:
    """Lanes 1 to 3 (momentum, velocity) and 4 to 6 (force, acceleration) exchanged."""
    return value[SWAPPED]


def transpose(
    r0: np.ndarray, r1: np.ndarray, r2: np.ndarray, r3: np.ndarray,
    r4: np.ndarray, r5: np.ndarray, r6: np.ndarray, r7: np.ndarray,
) -> tuple[np.ndarray, ...]:  # fmt: skip
    """Lane k of the eight vectors becomes vector k."""
    return tuple(np.array([r0, r1, r2, r3, r4, r5, r6, r7]).T)


def fma(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """a * b + c, rounded once where it is compiled."""
    return a * b + c


def root(a: Any) -> Any:
    """Square root."""
    return np.sqrt(a)


def round_down(a: np.ndarray) -> np.ndarray:
    """The largest whole number that is not above, lane by lane."""
    return np.floor(a)


def where_positive(condition: Any, a: Any, b: Any) -> Any:
    """a where the condition is above zero, else b, lane by lane; a number that is none is not above zero."""
    return np.where(condition > 0.0, a, b)


def any_positive(condition: Any) -> bool:
    """Whether a lane is above zero."""
    return bool(np.any(condition > 0.0))


def larger(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The larger one in each lane; b where either is not a number."""
    return np.where(a > b, a, b)


def largest_lane(a: np.ndarray) -> float:
    """The largest of all lanes; lanes that are not numbers are passed over where they can be."""
    for width in (4, 2, 1):
        a = larger(a[:width], a[width : 2 * width])
    return float(a[0])


def sum_lanes(a: np.ndarray) -> float:
    """Sum of all lanes: halves first, always in the same order."""
    for width in (4, 2, 1):
        a = a[:width] + a[width : 2 * width]
    return float(a[0])
