"""What a simulation is made of: one record of lanes per material point, one cache line per node.

A point's record holds three vectors of eight doubles. The columns of the velocity gradient L and of the stress
stand in the lanes that momentum and force have in a node, so that P2G needs no shuffles:

    lane      0      1     2     3      4     5     6     7
    row 0     m      v_x   v_y   V0     x     y     J     id
    row 1     e_o    L_xx  L_yx  L_zz   s_xx  s_xy  s_zz  q_0
    row 2     q_1    L_xy  L_yy  kind   s_xy  s_yy  -     -
    node      m      mv_x  mv_y  -      f_x   f_y   -     -        after P2G
    node      m      v~_x  v~_y  -      a_x   a_y   -     -        after the grid update

Plane strain: z is out of plane and L_zz = 0. Axisymmetry: x is the radius r, y the axis, zz the hoop direction,
L_zz = v_r / r; masses and volumes are per radian. `e_o` is the opening strain, `q` the history of the law,
`kind` 0 for the column and 1 for the base.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mpmcol.jit import device

ROW = 24
M, VX, VY, V0, X, Y, J, ID = range(8)
OPENING, LXX, LYX, LZZ, SXX, SXY, SZZ, Q0 = range(8, 16)
Q1, LXY, LYY, KIND, SXY_COPY, SYY = range(16, 22)

NODE = 8
TILE = 4
TILE_NODES = TILE * TILE
TILE_DOUBLES = TILE_NODES * NODE

COLUMN, BASE = 0, 1


class Points:
    """Material points: `rows` (n, 24) float64, 64-byte aligned, with named views of its lanes (SI units)."""

    def __init__(self, n: int) -> None:
        self.rows = aligned_zeros(n * ROW).reshape(n, ROW)
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
        """Position (n, 2), m."""
        return self.rows[:, X : Y + 1]

    @property
    def v(self) -> np.ndarray:
        """Velocity (n, 2), m/s."""
        return self.rows[:, VX : VY + 1]

    @property
    def V0(self) -> np.ndarray:
        """Initial volume (n,), m3 per metre or per radian."""
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
        return self.rows[:, Q0 : Q1 + 1]

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
        out = np.zeros((len(self), 6))
        out[:, :4] = self.rows[:, [SXX, SYY, SZZ, SXY]]
        return out

    @sigma.setter
    def sigma(self, value: np.ndarray) -> None:
        self.rows[:, [SXX, SYY, SZZ, SXY]] = value[:, :4]
        self.rows[:, SXY_COPY] = value[:, 3]

    @property
    def grad_v(self) -> np.ndarray:
        """Velocity gradient (n, 3, 3): [a, b] = d v_a / d x_b, 1/s; a copy."""
        out = np.zeros((len(self), 3, 3))
        out[:, 0, 0], out[:, 0, 1] = self.rows[:, LXX], self.rows[:, LXY]
        out[:, 1, 0], out[:, 1, 1] = self.rows[:, LYX], self.rows[:, LYY]
        out[:, 2, 2] = self.rows[:, LZZ]
        return out

    @grad_v.setter
    def grad_v(self, value: np.ndarray) -> None:
        self.rows[:, LXX], self.rows[:, LXY] = value[:, 0, 0], value[:, 0, 1]
        self.rows[:, LYX], self.rows[:, LYY] = value[:, 1, 0], value[:, 1, 1]
        self.rows[:, LZZ] = value[:, 2, 2]


class Grid(NamedTuple):
    """Background grid: a virtual dense array in tile-major order; only tiles near material are ever touched.

    The first node of an axis stands on one wall, the last on the other. Address of node (i, j): ax[i] + ay[j].
    """

    nodes: np.ndarray  # (n_addresses * 8,) node records
    fixed: np.ndarray  # (n_addresses,) uint8: bit 0 fixes v_x, bit 1 fixes v_y
    ax: np.ndarray  # (n_x,) offset of column i in `nodes`, in doubles
    ay: np.ndarray  # (n_y,) offset of row j
    origin_x: float  # m
    origin_y: float  # m
    h: float  # node spacing, m
    n_x: int
    n_y: int


class Tiles(NamedTuple):
    """Points in order: tile t holds points start[t] to start[t + 1], the column's before split[t]."""

    start: np.ndarray  # (n_tiles + 1,)
    split: np.ndarray  # (n_tiles,)
    by_colour: np.ndarray  # (n_tiles,) tiles of colour c: by_colour[colour_start[c] : colour_start[c + 1]]
    colour_start: np.ndarray  # (5,)
    active: np.ndarray  # (n_active,) address in `nodes` of each tile that can be touched


class Settings(NamedTuple):
    """Numbers of the method that stay constant during a stage (DESIGN words in `case.method`)."""

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


def aligned_zeros(n: int, alignment: int = 64) -> np.ndarray:
    """Flat float64 zeros whose first element starts a cache line; untouched pages are never committed."""
    raw = np.zeros(n + alignment // 8)
    skip = (-raw.ctypes.data % alignment) // 8
    return raw[skip : skip + n]


@device
def tile_count(n_nodes: int) -> int:
    """Tiles along an axis of `n_nodes` nodes."""
    return (n_nodes + TILE - 1) // TILE


def allocate_grid(origin: tuple[float, float], h: float, cells: tuple[int, int]) -> Grid:
    """A grid of `cells` cells of size `h` whose first node stands at `origin`; nothing is fixed."""
    n_x, n_y = cells[0] + 1, cells[1] + 1
    tiles_y = tile_count(n_y)
    i, j = np.arange(n_x), np.arange(n_y)
    ax = (i // TILE) * (tiles_y * TILE_DOUBLES) + (i % TILE) * (TILE * NODE)
    ay = (j // TILE) * TILE_DOUBLES + (j % TILE) * NODE
    size = tile_count(n_x) * tiles_y * TILE_DOUBLES
    fixed = np.zeros(size // NODE, dtype=np.uint8)
    return Grid(aligned_zeros(size), fixed, ax, ay, float(origin[0]), float(origin[1]), float(h), n_x, n_y)


def node_coordinates(grid: Grid) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates of all nodes, two arrays (n_x, n_y), m."""
    x = grid.origin_x + grid.h * np.arange(grid.n_x)
    y = grid.origin_y + grid.h * np.arange(grid.n_y)
    return np.meshgrid(x, y, indexing="ij")


def node_addresses(grid: Grid) -> np.ndarray:
    """Index of each node in `fixed` (and of its record in `nodes`), (n_x, n_y)."""
    return (grid.ax[:, None] + grid.ay[None, :]) // NODE


def node_records(grid: Grid) -> np.ndarray:
    """The records of all nodes as a copy (n_x, n_y, 8)."""
    return grid.nodes.reshape(-1, NODE)[node_addresses(grid)]


def set_fixed(grid: Grid, fixed_x: np.ndarray, fixed_y: np.ndarray) -> None:
    """Fix velocity components by two boolean masks (n_x, n_y)."""
    grid.fixed[:] = 0
    grid.fixed[node_addresses(grid)] = fixed_x.astype(np.uint8) | (fixed_y.astype(np.uint8) << 1)
