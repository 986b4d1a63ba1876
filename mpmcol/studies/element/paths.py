"""Strain paths of element tests, as in the laboratory.

A path prescribes rates of strain and may control one stress: the rate of the entries in `free` is found in each step
so that the stress `controlled` stays at its initial value. A new path is one entry of PATHS.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

XX, XY, YY, ZZ = 0, 1, 4, 8  # entries of a velocity gradient xx xy xz yx yy yz zx zy zz


@dataclass(frozen=True)
class StrainPath:
    """description: for the chart. rates: entry of the velocity gradient -> its rate, per unit of the strain.

    strain: name of the strain. free: entries with the rate that keeps the stress component `controlled` constant.
    """

    description: str
    strain: str
    rates: dict[int, float]
    free: tuple[int, ...] = ()
    controlled: int = 0  # of xx yy zz xy yz xz
    measures: Literal["shear", "tension"] = "shear"  # strength that the test gives

    def gradient(self, free_rate: float) -> tuple[float, ...]:
        """The velocity gradient (9) at unit rate of the strain."""
        rates = self.rates | dict.fromkeys(self.free, free_rate)
        return tuple(rates.get(entry, 0.0) for entry in range(9))


PATHS = {
    "plane-strain": StrainPath(
        "plane-strain compression at constant lateral stress", "vertical strain", {YY: -1.0}, (XX,), 0
    ),
    "triaxial": StrainPath(
        "triaxial compression at constant lateral stress", "vertical strain", {YY: -1.0}, (XX, ZZ), 0
    ),
    "shear": StrainPath("simple shear at constant normal stress", "shear strain", {XY: 1.0}, (YY,), 1),
    "extension": StrainPath(
        "isotropic extension", "volumetric strain", {XX: 1 / 3, YY: 1 / 3, ZZ: 1 / 3}, measures="tension"
    ),
}
