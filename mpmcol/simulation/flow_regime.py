"""Inertial number I and friction mu(I) of the flowing column, over the whole collapse.

At each record of the history the mass of the flowing points is added to a histogram of log I. The percentiles are
those of mass times time.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from mpmcol.case import Case
from mpmcol.mpm.constitutive import mu_i
from mpmcol.mpm.particles import COLUMN, Points
from mpmcol.simulation.derived import derived_quantities

QUASI_STATIC = 1e-3  # I below which a flow is quasi-static (GDR MiDi 2004, doi:10.1140/epje/i2003-10153-0)
LARGEST = 1e3
PER_DECADE = 50
EDGES = np.geomspace(QUASI_STATIC, LARGEST, 6 * PER_DECADE + 1)
CENTRES = np.sqrt(EDGES[:-1] * EDGES[1:])
PERCENTILES = (0.05, 0.5, 0.95)
MOST_ILL_POSED = 0.1  # share of the flow


@dataclass(frozen=True)
class FlowRegime:
    """Percentiles 5, 50 and 95 of I and mu of the flow, in mass times time, and the share where it is ill-posed."""

    I_p5: float
    I_median: float
    I_p95: float
    mu_p5: float
    mu_median: float
    mu_p95: float
    ill_posed: float


class FlowHistogram:
    """Mass times number of records by I; empty for laws without an inertial number."""

    def __init__(self, case: Case) -> None:
        self.case, self.mass = case, np.zeros(len(CENTRES))
        self.material = case.material if isinstance(case.material, mu_i.Material) else None

    def add(self, points: Points) -> None:
        """Add the present state of the points with the material of the column."""
        if self.material:
            own = points.kind == COLUMN
            number = derived_quantities(self.case, points)["inertial_number"][own]
            self.mass += np.histogram(np.minimum(number, CENTRES[-1]), EDGES, weights=points.m[own])[0]

    def memory(self) -> list[float]:
        """The sums, for a checkpoint."""
        return [float(mass) for mass in self.mass] if self.material else []

    def set_memory(self, memory: Sequence[float]) -> None:
        """Continue from `memory`."""
        if self.material:
            self.mass[:] = memory

    @property
    def regime(self) -> FlowRegime | None:
        """What the flow has reached so far; None without flow."""
        total, material = self.mass.sum(), self.material
        if material is None or total == 0.0:
            return None
        numbers = CENTRES[np.searchsorted(np.cumsum(self.mass), np.array(PERCENTILES) * total)]
        ill_posed = self.mass[~mu_i.well_posed(CENTRES, material)].sum() / total
        return FlowRegime(*map(float, (*numbers, *mu_i.friction_of(numbers, material), ill_posed)))

    def as_dict(self) -> dict[str, Any] | None:
        """`regime` for result.json."""
        return asdict(regime) if (regime := self.regime) else None

    def notes(self) -> Iterator[str]:
        """What a user must know of the rates of the flow."""
        regime, material = self.regime, self.material
        if material is None or regime is None or regime.ill_posed <= MOST_ILL_POSED:
            return
        allowed = CENTRES[mu_i.well_posed(CENTRES, material)]
        limits = f"{allowed.min():.2g} to {allowed.max():.2g}" if len(allowed) else "no I"
        yield (
            f"the mu(I) law is well-posed for I of {limits} (Barker et al. 2015); {100.0 * regime.ill_posed:.0f} % of "
            "the flow is outside: details of the flow depend on grid.spacing, so compare two spacings"
        )
