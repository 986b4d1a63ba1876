"""What to take from a scored study: the front of cost and error, the cheapest setting, what each choice is worth."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from mpmcol.studies.convergence import FEWEST
from mpmcol.studies.pareto.score import BETA, PROFILE, ZETA, Error, Scored
from mpmcol.studies.pareto.study import Study

GOALS = (0.10, 0.05, 0.02, 0.01)
CHOSEN_BY = (ZETA, BETA, PROFILE)


def of_scene(scored: Sequence[Scored], scene: str) -> list[Scored]:
    """The settings of a scene."""
    return [one for one in scored if one.setting.scene == scene]


@dataclass(frozen=True)
class Kept:
    """A setting and the error that it and all finer settings of its family keep within."""

    one: Scored
    error: float


def kept_errors(scored: Sequence[Scored], quantity: str) -> list[Kept]:
    """Settings of a scene that can be relied on, with their errors.

    An error that grows again as the grid is refined was small by luck, so that the largest of a setting and those finer
    counts. Left out are settings with runs that failed or are yet to be made, and families at too few spacings to tell.
    """
    kept = []
    for family in dict.fromkeys(one.setting.family for one in scored):
        own = [one for one in scored if one.setting.family == family and quantity in one.errors and one.is_complete]
        worst = 0.0
        for one in sorted(own, key=lambda one: -one.setting.cells) if len(own) >= FEWEST else ():
            worst = max(worst, one.errors[quantity].usual)
            kept.append(Kept(one, worst))
    return kept


def pareto_front(scored: Sequence[Scored], quantity: str) -> list[Kept]:
    """Settings of a scene that no other beats in both cost and error, cheapest first."""
    front: list[Kept] = []
    for kept in sorted(kept_errors(scored, quantity), key=lambda kept: (kept.one.cost["core_seconds"], kept.error)):
        if not front or kept.error < front[-1].error:
            front.append(kept)
    return front


def cheapest(scored: Sequence[Scored], quantity: str, goal: float) -> Scored | None:
    """The cheapest setting of a scene whose error keeps to the goal."""
    return next((kept.one for kept in pareto_front(scored, quantity) if kept.error <= goal), None)


@dataclass(frozen=True)
class Effect:
    """What one choice alone is worth at one spacing: changes against the base family, with standard errors."""

    scene: str
    family: str
    cells: float
    cost_ratio: float  # core-seconds over those of the base
    steps_ratio: float  # point-steps over those of the base
    change: dict[str, tuple[float, float]]  # quantity -> relative change of the mean, its standard error


def effects(study: Study, scored: Sequence[Scored]) -> Iterator[Effect]:
    """Every family beside the base at each spacing that both have."""
    base = {(one.setting.scene, one.setting.cells): one for one in scored if one.setting.family == study.base}
    for one in scored:
        setting = one.setting
        other = base.get((setting.scene, setting.cells))
        if other is None or other is one or not one.errors or not other.errors:
            continue
        yield Effect(
            setting.scene,
            setting.family,
            setting.cells,
            one.cost["core_seconds"] / other.cost["core_seconds"],
            one.cost["point_steps"] / other.cost["point_steps"],
            {quantity: _change(one.errors[quantity], other.errors[quantity]) for quantity in (ZETA, BETA)},
        )


def _change(one: Error, other: Error) -> tuple[float, float]:
    change = (1.0 + one.bias) / (1.0 + other.bias) - 1.0
    error = np.hypot(one.scatter / np.sqrt(one.runs), other.scatter / np.sqrt(other.runs)) / (1.0 + other.bias)
    return float(change), float(error)
