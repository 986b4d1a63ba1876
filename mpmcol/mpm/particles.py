"""Material points: an array of records (see `lanes`) with named views of its quantities."""

from __future__ import annotations

import numpy as np

from mpmcol.mpm.lanes import (
    HISTORY,
    ID,
    KIND,
    L_ZZ,
    LANES,
    OPENING,
    RECORD_SIZE,
    SIGMA,
    SIGMA_COPIES,
    V0,
    VX,
    J,
    L,
    M,
    X,
)

COLUMN, BASE, LAYER = range(3)  # kinds of points; from LAYER on, those of the layers of the column


class Points:
    """Material points in 2 or 3 dimensions: `rows` (n, 24 or 32) float64, a record each, and named views (SI units)."""

    def __init__(self, n: int, dimension: int = 2) -> None:
        self.dimension = dimension
        size = RECORD_SIZE[dimension]
        # kernels read eight records at a time: the last of them may lie behind the last point
        self.rows = aligned_zeros((n + LANES) * size).reshape(-1, size)[:n]
        self.rows[:, J] = 1.0
        self.rows[:, ID] = np.arange(n)

    def __len__(self) -> int:
        return len(self.rows)

    @property
    def m(self) -> np.ndarray:
        """Mass (n,), kg (per metre in plane strain, per radian in axisymmetry)."""
        return self.rows[:, M]

    @property
    def x(self) -> np.ndarray:
        """Position (n, d), m."""
        return self.rows[:, X : X + self.dimension]

    @property
    def v(self) -> np.ndarray:
        """Velocity (n, d), m/s."""
        return self.rows[:, VX : VX + self.dimension]

    @property
    def V0(self) -> np.ndarray:
        """Initial volume (n,), m3 (per metre or per radian in two dimensions)."""
        return self.rows[:, V0]

    @property
    def J(self) -> np.ndarray:
        """Volume ratio of the material (n,), without the opening strain."""
        return self.rows[:, J]

    @property
    def opening(self) -> np.ndarray:
        """Opening strain e_o (n,): volume of the gaps divided by volume of the material."""
        return self.rows[:, OPENING]

    @property
    def history(self) -> np.ndarray:
        """History variables of the constitutive law (n, 2)."""
        return self.rows[:, HISTORY[self.dimension]]

    @property
    def kind(self) -> np.ndarray:
        """COLUMN, BASE, or LAYER + k of the points of layer k (n,)."""
        return self.rows[:, KIND]

    @property
    def id(self) -> np.ndarray:
        """Number of the point (n,); sorting does not change it."""
        return self.rows[:, ID].astype(np.int64)

    @property
    def V(self) -> np.ndarray:
        """Current volume V = J V0 (n,), Eq. 30."""
        return self.J * self.V0

    @property
    def sigma(self) -> np.ndarray:
        """Cauchy stress (n, 6): xx yy zz xy yz xz, Pa, tension > 0; a copy."""
        out, lanes = np.zeros((len(self), 6)), list(SIGMA[self.dimension])
        out[:, : len(lanes)] = self.rows[:, lanes]
        return out

    @sigma.setter
    def sigma(self, value: np.ndarray) -> None:
        lanes = list(SIGMA[self.dimension])
        self.rows[:, lanes] = value[:, : len(lanes)]
        for component, lane in SIGMA_COPIES[self.dimension].items():
            self.rows[:, lane] = value[:, component]

    @property
    def grad_v(self) -> np.ndarray:
        """Velocity gradient (n, 3, 3): [a, b] = d v_a / d x_b, 1/s; a copy."""
        out, d = np.zeros((len(self), 3, 3)), self.dimension
        out[:, :d, :d] = self.rows[:, L[d]]
        if d == 2:
            out[:, 2, 2] = self.rows[:, L_ZZ]
        return out

    @grad_v.setter
    def grad_v(self, value: np.ndarray) -> None:
        d = self.dimension
        self.rows[:, L[d]] = value[:, :d, :d]
        if d == 2:
            self.rows[:, L_ZZ] = value[:, 2, 2]


def aligned_zeros(n: int, alignment: int = 64) -> np.ndarray:
    """Flat float64 zeros whose first element starts a cache line; untouched pages are never committed."""
    raw = np.zeros(n + alignment // 8)
    skip = (-raw.ctypes.data % alignment) // 8
    return raw[skip : skip + n]
