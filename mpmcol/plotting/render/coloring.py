"""Quantities by which material points can be coloured. A new one is one row of COLORINGS."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mpmcol.errors import OutputError
from mpmcol.io.snapshot import Meta, Snapshot


@dataclass(frozen=True)
class Coloring:
    """A quantity of the points.

    label: of the colour bar, with the unit. factor: from SI units to that unit. values: (n,) of a snapshot, SI units.
    percentile: of the values of the column, at the upper end of the colour scale. least: smallest upper end, SI units,
    or the name of the datum of the run that it equals.
    """

    label: str
    factor: float
    values: Callable[[Snapshot], np.ndarray]
    percentile: float = 100.0
    least: float | str = 1e-9

    def limit(self, snapshot: Snapshot, meta: Meta) -> float:
        """Value at the upper end of the colour scale of this snapshot, SI units. Raises OutputError."""
        values = self.values(snapshot)[snapshot.column]
        least = float(meta[self.least]) if isinstance(self.least, str) else self.least
        return max(float(np.percentile(values, self.percentile)), least)


def _stored(name: str) -> Callable[[Snapshot], np.ndarray]:
    def values(snapshot: Snapshot) -> np.ndarray:
        if name not in snapshot.arrays:
            raise OutputError(
                f"the snapshot has no array {name}: an earlier version of mpmcol wrote it; run the case again with "
                "--fresh, or choose another --color"
            )
        return snapshot.arrays[name]

    return values


def _speed(snapshot: Snapshot) -> np.ndarray:
    return np.linalg.norm(snapshot.arrays["velocity"], axis=1)


def _displacement(snapshot: Snapshot) -> np.ndarray:
    return snapshot.displacement_magnitude


COLORINGS = {
    "displacement": Coloring("displacement magnitude (mm)", 1e3, _displacement, least="point_size"),
    "velocity": Coloring("speed (m/s)", 1.0, _speed),
    "pressure": Coloring("pressure, mean of the cell (kPa)", 1e-3, _stored("pressure"), 99.5),
    "shear": Coloring("shear stress, mean of the cell (kPa)", 1e-3, _stored("shear_stress"), 99.5),
}
