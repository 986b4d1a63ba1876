"""Further measurements that runs give at no cost: the collapse in time, and the profile of the deposit."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from mpmcol.studies.fit.forward import Evaluation
from mpmcol.studies.fit.quantities import ASSUMED_ERROR, FRONT, MEANINGS, PROFILE, STATIONS, Target
from mpmcol.studies.fit.response import pooled_variance

FURTHER_ERROR = 0.03  # relative standard error that is assumed of a further measurement


@dataclass(frozen=True)
class Further:
    """A measurement that the fit does not use, for several sets of the unknowns.

    values: means (k, q) for each set. value, variance: (q,) near the solution, and variance of its measurement and of
    the scatter of the runs.
    """

    name: str
    meaning: str
    within: str  # error that is assumed of the measurement
    values: np.ndarray
    value: np.ndarray
    variance: np.ndarray


def further_measurements(
    evaluations: Sequence[Evaluation], targets: Sequence[Target], shares: np.ndarray
) -> Iterator[Further]:
    """What the fit does not use and all evaluations have, near values of the unknowns `shares` (n,)."""
    used = {target.name for target in targets}
    nearest = min(range(len(evaluations)), key=lambda k: float(np.linalg.norm(evaluations[k].shares - shares)))
    for name, meaning in MEANINGS.items():
        groups = [np.array([[one.get(name, np.nan)] for one in each.quantities]) for each in evaluations]
        value = groups[nearest].mean(axis=0)
        if name not in used and value[0] > 0.0 and all(np.isfinite(group).all() for group in groups):
            yield _further(name, meaning, f"{FURTHER_ERROR:.0%}", groups, value, FURTHER_ERROR * value)
    if PROFILE not in used:
        deposit = evaluations[nearest].deposits[0]
        x = np.linspace(0.0, deposit.front[FRONT], STATIONS)
        stations = Target(PROFILE, "m", x, x, x)
        groups = [np.array([stations.of(one) for one in each.deposits]) for each in evaluations]
        value = groups[nearest].mean(axis=0)
        error = np.full(STATIONS, ASSUMED_ERROR * value.max())
        yield _further(PROFILE, "surface of the deposit", f"{ASSUMED_ERROR:.0%} of its height", groups, value, error)


def _further(
    name: str, meaning: str, within: str, groups: Sequence[np.ndarray], value: np.ndarray, error: np.ndarray
) -> Further:
    variance = pooled_variance(groups)
    runs = min(len(group) for group in groups)
    values = np.array([group.mean(axis=0) for group in groups])
    return Further(name, meaning, within, values, value, error**2 + variance / runs)
