"""Principal stresses in three dimensions against LAPACK, also where they are equal or nearly equal."""

from __future__ import annotations

import numpy as np
import pytest

from mpmcol.mpm.kernels.principal_stress import determinant, distinct_eigenvalue, eigenvector, second_invariant


def deviators(values: np.ndarray, n: int, seed: int) -> np.ndarray:
    """Tensors (n, 3, 3) with these eigenvalues minus their mean, in random directions."""
    axes = np.linalg.qr(np.random.default_rng(seed).normal(size=(n, 3, 3)))[0]
    tensors = axes @ np.diag(values - values.mean()) @ axes.swapaxes(1, 2)
    return 0.5 * (tensors + tensors.swapaxes(1, 2))


def components(tensors: np.ndarray) -> tuple[np.ndarray, ...]:
    return tuple(tensors[:, a, b] for a, b in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)))


VALUES = [(3, 1, -4), (1, 1, -2), (2, -1, -1), (1, 0, -1), (1 + 1e-9, 1, -2), (2, -1, -1 - 1e-13)]
VALUES += [(5e8, 1e8, -7e8), (2e-9, 0, 0)]


@pytest.mark.parametrize("values", VALUES, ids=str)
def test_distinct_eigenvalue_and_its_eigenvector(values: tuple[float, ...]) -> None:
    tensors = deviators(np.array(values, float), 300, seed=1)
    d = components(tensors)
    value = distinct_eigenvalue(second_invariant(d), determinant(d))
    expected = np.linalg.eigvalsh(tensors)
    scale = np.abs(expected).max()
    distinct = np.where(np.abs(expected[:, 0]) > np.abs(expected[:, 2]), expected[:, 0], expected[:, 2])
    np.testing.assert_allclose(np.abs(value), np.abs(distinct), rtol=0.0, atol=2e-14 * scale)
    n = np.stack(eigenvector(d, value), axis=-1)
    np.testing.assert_allclose(np.linalg.norm(n, axis=1), 1.0, rtol=1e-14)
    np.testing.assert_allclose(np.einsum("nab,nb->na", tensors, n), value[:, None] * n, rtol=0.0, atol=3e-14 * scale)


def test_zero_deviator_has_the_x_axis_as_eigenvector() -> None:
    zero = tuple(np.zeros(1) for _ in range(6))
    with np.errstate(all="ignore"):
        value = distinct_eigenvalue(second_invariant(zero), determinant(zero))
        n = np.concatenate(eigenvector(zero, value))
    assert value[0] == 0.0
    np.testing.assert_array_equal(n, [1.0, 0.0, 0.0])
