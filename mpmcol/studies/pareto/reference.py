"""Converged values of a scene, from two families of settings that are refined independently."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from mpmcol.measure import FRONTS, Array
from mpmcol.measure.profile_distance import area_between, mean_height, stations
from mpmcol.studies.convergence import Limit, combine, find_limit
from mpmcol.studies.runs import Finished

QUANTITIES = (*(f"zeta.{front}" for front in FRONTS), "beta")

Levels = Mapping[float, Sequence[Finished]]  # runs of a family by r_i / h


@dataclass(frozen=True)
class Reference:
    """What runs of a scene tend to."""

    limits: Mapping[str, Limit]  # by quantity
    refinements: Sequence[Mapping[str, Limit]]  # the same from each family alone
    x: Array  # m
    height: Array  # m: mean of the finest runs of both families at x
    height_error: float  # half the area between the two families' finest, over the area

    def uncertainty(self, quantity: str) -> float:
        """Relative standard error of a quantity, or of the profile."""
        if quantity == "profile":
            return self.height_error
        limit = self.limits[quantity]
        return limit.error / abs(limit.value)


def make_reference(families: Sequence[Levels]) -> Reference | None:
    """The reference from two refinements; None if one of them has too few runs."""
    refinements = [_limits(levels) for levels in families]
    if any(len(limits) < len(QUANTITIES) for limits in refinements):
        return None
    first, second = refinements
    finest = [[run.results.measure(-1) for run in levels[max(levels)]] for levels in families]
    x = stations([deposit for deposits in finest for deposit in deposits])
    one, other = (mean_height(deposits, x) for deposits in finest)
    height = (one + other) / 2.0
    return Reference(
        limits={quantity: combine(first[quantity], second[quantity]) for quantity in QUANTITIES},
        refinements=refinements,
        x=x,
        height=height,
        height_error=area_between(one, height),
    )


def _limits(levels: Levels) -> dict[str, Limit]:
    found = {
        quantity: find_limit({1.0 / cells: [run.row[quantity] for run in runs] for cells, runs in levels.items()})
        for quantity in QUANTITIES
    }
    return {quantity: limit for quantity, limit in found.items() if limit}
