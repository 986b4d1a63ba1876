"""Memory that the arrays of a model need, and the refusal of models that do not fit."""

from __future__ import annotations

from math import prod

import psutil

from mpmcol.errors import UnfitCase, UsageError
from mpmcol.mpm.grid import NODE
from mpmcol.setup.discretization import Discretization

# measured: record of a point and of the last valid state, sorting, its share of the nodes, and copies for a snapshot
BYTES_PER_POINT = {2: 1100, 3: 1140}
BYTES_PER_NODE = 6  # masks, and the arrays that they are made from
BYTES_PER_SLOT, BYTES_PER_CONTACT = 4, 135  # with friction or recorded forces: of each node, and of each on the floor
LARGE = 1e9  # numbers whose digits are not written out
BYTES_PER_CUT_CELL = 64  # of the lattice of points of an outline, while its volumes are computed


def memory_bytes(discretization: Discretization) -> int:
    """Memory in use, bytes: of the node records, only those near material are ever touched."""
    points = discretization.most_points * BYTES_PER_POINT[discretization.dimension]
    if discretization.outline is not None:
        points += discretization.lattice_cells * BYTES_PER_CUT_CELL
    cells, cells_up = prod(discretization.cells), discretization.cells_up
    contacts = cells * BYTES_PER_SLOT + cells // cells_up * BYTES_PER_CONTACT if discretization.walls else 0
    return points + cells * BYTES_PER_NODE + contacts


def grid_bytes(discretization: Discretization) -> int:
    """Size of the array of node records, bytes; some systems do not allocate more than their memory."""
    return prod(discretization.cells) * NODE * 8


def require_memory_for(discretization: Discretization) -> None:
    """Raise UnfitCase if the arrays of a model do not fit into the memory of this machine."""
    cells = " x ".join(_count(n) for n in discretization.cells)
    what = f"grid.spacing = {discretization.h:.4g} m: {_count(discretization.most_points)} points and {cells} cells"
    if lack := _lack(max(memory_bytes(discretization), grid_bytes(discretization))):
        remedy = "increase grid.spacing, or check whether a length is in mm instead of m"
        raise UnfitCase("grid.spacing", f"{what} {lack}", remedy)


def machine_memory() -> int:
    """Memory of this machine, bytes."""
    return int(psutil.virtual_memory().total)


def require_memory(needed: int, what: str, fix: str) -> None:
    """Raise UsageError if `needed` bytes exceed the memory of this machine; `what` needs them."""
    if lack := _lack(needed):
        raise UsageError(f"{what} {lack}; {fix}")


def _lack(needed: int) -> str:
    """That `needed` bytes exceed the memory of this machine; "" if they do not."""
    memory = machine_memory()
    return f"need {_count(needed / 1e9)} GB, this machine has {_count(memory / 1e9)} GB" if needed > memory else ""


def _count(number: float) -> str:
    """A number with all digits, or with three if it is large."""
    return f"{number:,.0f}" if number < LARGE else f"{number:.3g}"
