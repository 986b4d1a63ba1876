"""What a simulation is made of: one record of lanes per material point, and the numbers of the method.

A point's record holds three vectors of eight doubles in two dimensions, four in three. The columns of the velocity
gradient L and of the stress stand in the lanes that momentum and force have in a node, so that P2G needs no shuffles:

    lane      0      1     2     3      4     5     6     7
    row 0     m      v_x   v_y   v_z    x     y     z     V0
    row 1     J      L_xx  L_yx  L_zx   s_xx  s_xy  s_xz  e_o
    row 2     id     L_xy  L_yy  L_zy   s_xy  s_yy  s_yz  kind
    row 3     q_0    L_xz  L_yz  L_zz   s_xz  s_yz  s_zz  q_1
    node      m      mv_x  mv_y  mv_z   f_x   f_y   f_z   -        after P2G
    node      m      v~_x  v~_y  v~_z   a_x   a_y   a_z   -        after the grid update

In two dimensions there is no row 3, and the lanes that it leaves in rows 1 and 2 hold what is still needed of it:

    row 1     J      L_xx  L_yx  L_zz   s_xx  s_xy  s_zz  e_o
    row 2     id     L_xy  L_yy  q_0    s_xy  s_yy  q_1   kind

y is vertical. Plane strain: z is out of plane and L_zz = 0. Axisymmetry: x is the radius r, y the axis, zz the hoop
direction, L_zz = v_r / r; masses and volumes are per radian. `e_o` is the opening strain, `q` the history of the law,
`kind` 0 for the column and 1 for the base. Between steps, APIC keeps its affine matrix in the lanes of L.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

LANES = 8
ROW = {2: 3 * LANES, 3: 4 * LANES}  # doubles in a record
M, VX, VY, VZ, X, Y, Z, V0 = range(8)
J, OPENING, ID, KIND = 8, 15, 16, 23
HOOP = 14  # s_zz in two dimensions
_LINEAR = {2: ((9, 17), (10, 18)), 3: ((9, 17, 25), (10, 18, 26), (11, 19, 27))}  # lane of L[a, b]
L_ZZ = 11  # in two dimensions
DIAGONAL = {2: (9, 18, L_ZZ), 3: (9, 18, 27)}  # lanes of L_xx, L_yy, L_zz
_SIGMA = {2: (12, 21, HOOP, 13), 3: (12, 21, 30, 13, 22, 14)}  # xx yy zz xy yz xz
_SIGMA_AGAIN = {2: {3: 20}, 3: {3: 20, 4: 29, 5: 28}}  # the shear stresses stand in two columns
_HISTORY = {2: slice(19, 23, 3), 3: slice(24, 32, 7)}

COLUMN, BASE = 0, 1


class Points:
    """Material points in 2 or 3 dimensions: `rows` (n, 24 or 32) float64 with named views of its lanes (SI units)."""

    def __init__(self, n: int, dimension: int = 2) -> None:
        self.dimension = dimension
        row = ROW[dimension]
        # kernels read eight records at a time: the last of them may lie behind the last point
        self.rows = aligned_zeros((n + LANES) * row).reshape(-1, row)[:n]
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
        """Volume ratio of the material without its opening (n,)."""
        return self.rows[:, J]

    @property
    def opening(self) -> np.ndarray:
        """Opening strain e_o (n,): volume of the gaps over volume of the material."""
        return self.rows[:, OPENING]

    @property
    def history(self) -> np.ndarray:
        """History variables of the law (n, 2)."""
        return self.rows[:, _HISTORY[self.dimension]]

    @property
    def kind(self) -> np.ndarray:
        """0 for the column, 1 for the base (n,)."""
        return self.rows[:, KIND]

    @property
    def id(self) -> np.ndarray:
        """Number of the point, kept through sorting (n,)."""
        return self.rows[:, ID].astype(np.int64)

    @property
    def V(self) -> np.ndarray:
        """Current volume V = J V0 (n,), Eq. 30."""
        return self.J * self.V0

    @property
    def sigma(self) -> np.ndarray:
        """Cauchy stress (n, 6): xx yy zz xy yz xz, Pa, tension > 0; a copy."""
        out, lanes = np.zeros((len(self), 6)), list(_SIGMA[self.dimension])
        out[:, : len(lanes)] = self.rows[:, lanes]
        return out

    @sigma.setter
    def sigma(self, value: np.ndarray) -> None:
        lanes = list(_SIGMA[self.dimension])
        self.rows[:, lanes] = value[:, : len(lanes)]
        for component, lane in _SIGMA_AGAIN[self.dimension].items():
            self.rows[:, lane] = value[:, component]

    @property
    def grad_v(self) -> np.ndarray:
        """Velocity gradient (n, 3, 3): [a, b] = d v_a / d x_b, 1/s; a copy."""
        out, d = np.zeros((len(self), 3, 3)), self.dimension
        out[:, :d, :d] = self.rows[:, _LINEAR[d]]
        if d == 2:
            out[:, 2, 2] = self.rows[:, L_ZZ]
        return out

    @grad_v.setter
    def grad_v(self, value: np.ndarray) -> None:
        d = self.dimension
        self.rows[:, _LINEAR[d]] = value[:, :d, :d]
        if d == 2:
            self.rows[:, L_ZZ] = value[:, 2, 2]


class Settings(NamedTuple):
    """Numbers of the method that stay constant during a stage, from the words of [method]."""

    gravity_x: float  # m/s2
    gravity_y: float  # m/s2
    alpha_d: float  # local damping, Eq. 23
    cfl: float  # factor on Eq. 35
    taylor: float  # 1 keeps the velocity gradient in Eq. 20, 0 drops it
    flip_fraction: float  # share of Eq. 26 in the velocity update, the rest is PIC
    position_factor: float  # factor on dt^2 S a in Eq. 27: 1/2 trapezoid, 1 as printed, 0 end velocity
    wall_impulse: bool  # walls hand their impulse to the points
    opening_strain: bool
    kernel_correction: bool
    axisymmetric: bool
    axis_gap: float = 0.2  # in h: least distance of a point from the axis
    gravity_z: float = 0.0  # m/s2
    open_low_sides: bool = False  # whether the domain is open, too, where x and z begin
    free_speed: float = 0.0  # m/s that gravity can give; faster points are a fault if they are faster than waves, too
    exponential_volume: bool = False  # J grows by exp(dt tr L) in place of det(I + dt L), Eq. 29


class Scheme(NamedTuple):
    """Choices of the method that select code: kernels are compiled with them."""

    stress_order: str = "usl"  # when the stress is updated: "usl", "usf" or "musl"
    affine: bool = False  # APIC: points carry an affine matrix from the weights, not their velocity gradient
    basis: str = "quadratic"  # "linear", "quadratic" or "cubic"
    volumetric_strain: str = "point"  # each "point" has its own, or all of a "cell" their mean


PAPER = Scheme()


def aligned_zeros(n: int, alignment: int = 64) -> np.ndarray:
    """Flat float64 zeros whose first element starts a cache line; untouched pages are never committed."""
    raw = np.zeros(n + alignment // 8)
    skip = (-raw.ctypes.data % alignment) // 8
    return raw[skip : skip + n]
