"""Quantities by which material points can be coloured. A new one is one row of COLORINGS."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from mpmcol.errors import MpmcolError, OutputError, UsageError
from mpmcol.io.snapshot import Meta, Snapshot
from mpmcol.mpm.constitutive import LAWS
from mpmcol.units import FACTORS

Limits = tuple[float, float]  # values at both ends of a colour scale


@dataclass(frozen=True)
class Coloring:
    """A quantity of the points.

    name: for the colour bar. units: from the smallest, for the colour bar. values: (n,) of a snapshot, SI units.
    percentile: of the values of the column, at the upper end of the colour scale. least: smallest upper end, SI units,
    or the name of the datum of the run that it equals. from_zero: whether the colour scale begins at zero, else at the
    opposite percentile.
    """

    name: str
    units: tuple[str, ...]
    values: Callable[[Snapshot], np.ndarray]
    percentile: float = 100.0
    least: float | str = 1e-9
    from_zero: bool = True

    def limits(self, snapshot: Snapshot, meta: Meta) -> Limits:
        """Values at the ends of the colour scale of this snapshot, SI units. Raises OutputError."""
        values = self.values(snapshot)[snapshot.column]
        least = float(meta[self.least]) if isinstance(self.least, str) else self.least
        low = 0.0 if self.from_zero else float(np.percentile(values, 100.0 - self.percentile))
        return low, max(float(np.percentile(values, self.percentile)), low + least)

    def scale(self, limits: Limits) -> tuple[str, Limits]:
        """Label of a colour bar with these ends (SI units), with the unit that suits it, and the ends in that unit."""
        low, high = limits
        unit = next((unit for unit in reversed(self.units) if high >= FACTORS[unit][1]), self.units[0])
        factor = 1.0 / FACTORS[unit][1]
        return f"{self.name} ({unit})" if unit else self.name, (factor * low, factor * high)


def _stored(name: str) -> Callable[[Snapshot], np.ndarray]:
    def values(snapshot: Snapshot) -> np.ndarray:
        if name not in snapshot.arrays:
            raise _missing(name)
        return snapshot.arrays[name]

    return values


def _missing(name: str) -> MpmcolError:
    """What to report on a snapshot without an array, which every law has or only some."""
    if laws := [law for law, module in LAWS.items() if name in module.DERIVED]:
        return UsageError(f"only runs with law {' or '.join(laws)} have the {name}; choose another --color")
    return OutputError(
        f"the snapshot has no array {name}: an earlier version of mpmcol wrote it; choose another --color, or run the "
        "case again with --fresh"
    )


def _speed(snapshot: Snapshot) -> np.ndarray:
    return np.linalg.norm(snapshot.arrays["velocity"], axis=1)


def _displacement(snapshot: Snapshot) -> np.ndarray:
    return snapshot.displacement_magnitude


STRESS = ("Pa", "kPa", "MPa")
COLORINGS = {
    "displacement": Coloring("displacement magnitude", ("mm", "m"), _displacement, least="point_size"),
    "velocity": Coloring("speed", ("mm/s", "m/s"), _speed),
    "pressure": Coloring("pressure, mean of the cell", STRESS, _stored("pressure"), 99.5),
    "shear": Coloring("shear stress sqrt(J2), mean of the cell", STRESS, _stored("shear_stress"), 99.5),
    "inertial": Coloring("inertial number I", ("",), _stored("inertial_number"), 99.0),
    "friction": Coloring("friction angle (deg)", ("",), _stored("local_friction_angle"), 99.0, from_zero=False),
}


def widest(limits: Sequence[Limits]) -> Limits:
    """Ends of a colour scale that contains those of all snapshots."""
    lows, highs = zip(*limits, strict=True)
    return min(lows), max(highs)
