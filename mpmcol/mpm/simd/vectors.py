"""Operations on vectors of eight doubles in plain Python, on NumPy arrays of eight numbers."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmcol.mpm.lanes import LANES

SWAPPED = [0, 4, 5, 6, 1, 2, 3, 7]


def load(array: np.ndarray, index: int) -> np.ndarray:
    """Eight consecutive doubles of a flat array from `index` on; undefined beyond the end of the array."""
    found = array[index : index + LANES]
    return np.pad(found, (0, LANES - len(found)))


def load_half(array: np.ndarray, index: int) -> np.ndarray:
    """Four consecutive doubles of a flat array from `index` on, as half a vector."""
    return array[index : index + LANES // 2].copy()


def element(array: np.ndarray, index: int) -> Any:
    """`array[index]` of a flat array, for an index that is not negative; undefined beyond the end of the array."""
    return array[index]


def strided(array: np.ndarray, index: int, stride: int) -> np.ndarray:
    """Eight doubles of a flat array, `stride` apart, the first at `index`; undefined beyond the end of the array."""
    found = array[index : index + LANES * stride : stride]
    return np.pad(found, (0, LANES - len(found)))


def spread(array: np.ndarray, index: int) -> np.ndarray:
    """One double of a flat array in all lanes."""
    return np.full(LANES, array[index])


def spread_half(array: np.ndarray, index: int) -> np.ndarray:
    """One double of a flat array in all lanes of half a vector."""
    return np.full(LANES // 2, array[index])


def scratch(size: int) -> np.ndarray:
    """An array of `size` doubles, a constant, for the present function only; its content is undefined."""
    return np.empty(size)


def prefetch(array: np.ndarray, index: int) -> None:
    """Prefetch the cache line of `array[index]`; the index may lie beyond the end."""


def store(array: np.ndarray, index: int, value: np.ndarray) -> None:
    """Write a vector, or half a vector, to a flat array from `index` on."""
    array[index : index + len(value)] = value


def splat(x: float) -> np.ndarray:
    """A vector with the same number in all lanes."""
    return np.full(LANES, x)


def vector(x0: float, x1: float, x2: float, x3: float, x4: float, x5: float, x6: float, x7: float) -> np.ndarray:
    """A vector from its eight lanes."""
    return np.array([x0, x1, x2, x3, x4, x5, x6, x7], dtype=np.float64)


def half_vector(x0: float, x1: float, x2: float, x3: float) -> np.ndarray:
    """Half a vector from its four lanes."""
    return np.array([x0, x1, x2, x3], dtype=np.float64)


def extract(value: np.ndarray, index: int) -> float:
    """One lane of a vector."""
    return value[index]


def swap_halves(value: np.ndarray) -> np.ndarray:
    """Exchange lanes 1 to 3 (momentum, velocity) with lanes 4 to 6 (force, acceleration)."""
    return value[SWAPPED]


def transpose(
    r0: np.ndarray, r1: np.ndarray, r2: np.ndarray, r3: np.ndarray,
    r4: np.ndarray, r5: np.ndarray, r6: np.ndarray, r7: np.ndarray,
) -> tuple[np.ndarray, ...]:  # fmt: skip
    """Transpose eight vectors: lane k of all of them becomes vector k."""
    return tuple(np.array([r0, r1, r2, r3, r4, r5, r6, r7]).T)


def load_eight(array: np.ndarray, index: int, stride: int) -> tuple[np.ndarray, ...]:
    """Transpose of eight vectors of a flat array, `stride` doubles apart, the first from `index` on."""
    return transpose(*(load(array, index + k * stride) for k in range(LANES)))


def store_eight(
    array: np.ndarray, index: int, stride: int,
    r0: np.ndarray, r1: np.ndarray, r2: np.ndarray, r3: np.ndarray,
    r4: np.ndarray, r5: np.ndarray, r6: np.ndarray, r7: np.ndarray,
) -> None:  # fmt: skip
    """Inverse of `load_eight`."""
    for k, row in enumerate(transpose(r0, r1, r2, r3, r4, r5, r6, r7)):
        store(array, index + k * stride, row)


def fma(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """a * b + c; the compiled implementation rounds once."""
    return a * b + c


def sqrt(a: Any) -> Any:
    """Square root."""
    return np.sqrt(a)


def floor(a: np.ndarray) -> np.ndarray:
    """Largest integer not greater than each lane."""
    return np.floor(a)


def where_positive(condition: Any, a: Any, b: Any) -> Any:
    """a where the condition is above zero, else b, lane by lane; NaN is not above zero."""
    return np.where(condition > 0.0, a, b)


def any_positive(condition: Any) -> bool:
    """Whether any lane is above zero."""
    return bool(np.any(condition > 0.0))


def maximum(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Larger number of each lane; b where either is NaN."""
    return np.where(a > b, a, b)


def reduce_max(a: np.ndarray) -> float:
    """Largest of all lanes, compared pairwise; NaN in the first of a pair is skipped."""
    for width in (4, 2, 1):
        a = maximum(a[:width], a[width : 2 * width])
    return float(a[0])


def reduce_sum(a: np.ndarray) -> float:
    """Sum of all lanes, in a fixed order: halves are added first."""
    for width in (4, 2, 1):
        a = a[:width] + a[width : 2 * width]
    return float(a[0])
