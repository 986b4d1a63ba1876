"""What two sweeps must have in common: tables without costs, and final positions."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mpmcol.io.results import Results
from mpmcol.sweep.table import read_table

COST = ("second", "ns_", "memory")  # parts of the names of columns that differ from one sweep to the next


def measured_table(folder: Path) -> list[dict[str, str]]:
    """Rows of a sweep's table without the columns that depend on the machine."""
    rows = read_table(folder / "table.csv")
    return [{name: value for name, value in row.items() if not any(part in name for part in COST)} for row in rows]


def final_positions(folder: Path) -> list[np.ndarray]:
    """Positions in the last snapshot of each finished run of a sweep."""
    return [Results(path.parent).snapshot(-1).arrays["position"] for path in sorted(folder.glob("*/result.json"))]
