"""A scene of failure: what goes wrong, the methods that fail and stand, and what they were found to do."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from math import inf
from typing import Literal, NamedTuple

import numpy as np

from mpmcol.errors import NumericalFailure

Verdict = Literal["as expected", "did not fail", "did not stand", "off theory"]
Curve = tuple[np.ndarray, np.ndarray]
STOPPED = inf  # the sign of a method under which the solver itself gives up


class Reading(NamedTuple):
    """What a method did: its sign, what else is worth telling, and a line for the chart."""

    sign: float
    note: str = ""
    curve: Curve | None = None


@dataclass(frozen=True)
class Trial:
    """One method in a scene, and whether it must stand there."""

    method: str
    stands: bool
    measure: Callable[[], float | Reading]
    default: bool = False  # what a case has that names no method, whatever its material and place


@dataclass(frozen=True)
class Theory:
    """A number that is known beforehand, and how it is measured."""

    number: str
    value: float
    measure: Callable[[], float]
    source: str
    tolerance: float = 0.05  # relative


@dataclass(frozen=True)
class Scene:
    """One mechanism of failure. The larger the sign the worse; a method fails whose sign is above the bound."""

    name: str
    mechanism: str
    sign: str  # what is measured, in words
    unit: str
    bound: float
    source: str  # of the bound
    remedy: str
    trials: tuple[Trial, ...]
    theory: tuple[Theory, ...] = ()
    slow: bool = False  # takes more than some seconds
    axes: tuple[str, str] | None = None  # of the chart, where the trials give curves

    @property
    def is_gap(self) -> bool:
        """Whether what a case does by default is known to fail here."""
        return any(trial.default and not trial.stands for trial in self.trials)


@dataclass(frozen=True)
class TrialOutcome:
    """A trial and what it read."""

    trial: Trial
    reading: Reading
    stood: bool

    @property
    def verdict(self) -> Verdict:
        """Whether it did as it must."""
        if self.stood == self.trial.stands:
            return "as expected"
        return "did not fail" if self.stood else "did not stand"


@dataclass(frozen=True)
class TheoryOutcome:
    """A number that was known beforehand, and what was measured."""

    theory: Theory
    value: float

    @property
    def error(self) -> float:
        """Relative to the theory."""
        return self.value / self.theory.value - 1.0

    @property
    def verdict(self) -> Verdict:
        """Whether they agree; a value that is no number does not."""
        return "as expected" if abs(self.error) <= self.theory.tolerance else "off theory"


@dataclass(frozen=True)
class SceneOutcome:
    """All that a scene showed."""

    scene: Scene
    trials: tuple[TrialOutcome, ...]
    theory: tuple[TheoryOutcome, ...]
    seconds: float

    @property
    def verdict(self) -> Verdict:
        """The first that is not as it should be."""
        verdicts = [trial.verdict for trial in self.trials] + [known.verdict for known in self.theory]
        return next((verdict for verdict in verdicts if verdict != "as expected"), "as expected")


def play(scene: Scene) -> SceneOutcome:
    """Try every method of a scene on the kernels."""
    started = time.perf_counter()
    trials = tuple(_try(scene, trial) for trial in scene.trials)
    theory = tuple(TheoryOutcome(each, each.measure()) for each in scene.theory)
    return SceneOutcome(scene, trials, theory, time.perf_counter() - started)


def _try(scene: Scene, trial: Trial) -> TrialOutcome:
    try:
        found = trial.measure()
        reading = found if isinstance(found, Reading) else Reading(float(found))
    except NumericalFailure as failure:
        reading = Reading(STOPPED, f"stopped: {failure.failure['cause']}, t = {failure.failure['time']:.3g} s")
    return TrialOutcome(trial, reading, reading.sign <= scene.bound)  # what is no number has not stood
