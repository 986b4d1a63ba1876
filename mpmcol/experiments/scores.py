"""Comparison of measured values and profiles with the published experiments."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from mpmcol.experiments.base import Conditions, Experiment, Law, Profile, ProfileScore, Score, mark
from mpmcol.experiments.height_difference import rms_difference


def score_laws(
    experiments: Mapping[str, Experiment], measured: Any, a: float, kind: str, conditions: Conditions | None
) -> list[Score]:
    """Scores against every law for columns of this kind."""
    values = list(_values(measured))
    return [
        _score(experiment, law, front, value, a, conditions)
        for experiment in experiments.values()
        if experiment.model == kind
        for law in experiment.laws
        for quantity, front, value in values
        if quantity == law.quantity
    ]


def score_profile(profile_x: ArrayLike, profile_y: ArrayLike, experiment: Experiment) -> ProfileScore | None:
    """See `mpmcol.experiments.profile_score`."""
    surface = next((profile for profile in experiment.profiles if "surface" in profile.name), None)
    if surface is None:
        return None
    x, y = np.asarray(profile_x, dtype=float), np.asarray(profile_y, dtype=float)
    return (_score_in_metres if surface.unit == "m" else _score_normalised)(x, y, experiment, surface)


def _values(measured: Any) -> Iterator[tuple[str, str, float]]:
    """(quantity, front definition, value) of a mapping of quantities or of an object with zeta and beta."""
    values = measured if isinstance(measured, Mapping) else {"zeta": measured.zeta, "beta": measured.beta}
    for quantity, value in values.items():
        fronts = value if isinstance(value, Mapping) else {"": value}
        for front, number in fronts.items():
            yield quantity, front, number["mean"] if isinstance(number, Mapping) else number


def _score(
    experiment: Experiment, law: Law, front: str, value: float, a: float, conditions: Conditions | None
) -> Score:
    misfit = experiment.misfit(conditions) if conditions else ""
    expected = None if misfit else law(a)
    return Score(
        experiment=experiment.name,
        quantity=law.quantity,
        front_definition=front,
        value=value,
        expected=expected,
        error=None if expected is None else value / expected - 1.0,
        scatter=law.scatter,
        comment=(misfit or (law.gap(a) if expected is None else experiment.material)) + mark(law.verified),
        verified=law.verified,
    )


def _score_in_metres(x: np.ndarray, y: np.ndarray, experiment: Experiment, surface: Profile) -> ProfileScore:
    tip = surface.x[-1]
    front = _crossing(x, y, surface.y[-1])
    return ProfileScore(
        experiment=surface.experiment,
        profile=surface.name,
        rms_mm=1e3 * rms_difference((x, y), (np.array(surface.x), np.array(surface.y))),
        front=front,
        expected_front=tip,
        error=front / tip - 1.0,
        comment=f"fronts at a height of {1e3 * surface.y[-1]:.1f} mm; {experiment.material}{mark(surface.verified)}",
        verified=surface.verified,
    )


def _score_normalised(x: np.ndarray, y: np.ndarray, experiment: Experiment, surface: Profile) -> ProfileScore:
    length, height = _crossing(x, y, 0.0), float(y[:1].sum())
    return ProfileScore(
        experiment=surface.experiment,
        profile=surface.name,
        rms_mm=1e3 * rms_difference((x, y), (length * np.array(surface.x), height * np.array(surface.y))),
        front=None,
        expected_front=None,
        error=None,
        comment=f"shape only: scaled to the length and height of the deposit{mark(surface.verified)}",
        verified=surface.verified,
    )


def _crossing(x: np.ndarray, y: np.ndarray, level: float) -> float:
    """Farthest x at which the profile falls to the level, linear between points; 0 if it lies below everywhere."""
    above = np.flatnonzero(y > level)
    if not above.size:
        return 0.0
    pair = slice(above[-1], above[-1] + 2)
    return float(np.interp(-level, -y[pair], x[pair]))
