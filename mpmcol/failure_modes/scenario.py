"""A scenario: a failure mechanism, its metric and bound, and the methods expected to fail and to pass."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from math import inf
from typing import Literal, NamedTuple

import numpy as np

from mpmcol.errors import NumericalFailure

Verdict = Literal["as expected", "unexpected pass", "unexpected failure", "deviates from theory"]
Curve = tuple[np.ndarray, np.ndarray]
STOPPED = inf  # metric of a method with which the solver stops


class Observation(NamedTuple):
    """Result of one method: its metric, a remark, and a curve for the chart."""

    metric: float
    note: str = ""
    curve: Curve | None = None


Measure = Callable[[], float | Observation]


@dataclass(frozen=True)
class Trial:
    """One method in a scenario and the expected outcome; see `passing` and `failing`."""

    method: str
    should_pass: bool
    measure: Measure
    default: bool = False  # the default of a case, whatever its material and geometry


def passing(method: str, measure: Measure, default: bool = False) -> Trial:
    """A method whose metric must stay within the bound."""
    return Trial(method, True, measure, default)


def failing(method: str, measure: Measure, default: bool = False) -> Trial:
    """A method whose metric must exceed the bound, or with which the solver must stop."""
    return Trial(method, False, measure, default)


@dataclass(frozen=True)
class Theory:
    """A quantity with a known value, and how it is measured."""

    quantity: str
    value: float
    measure: Callable[[], float]
    source: str
    tolerance: float = 0.05  # relative


@dataclass(frozen=True)
class Scenario:
    """One failure mechanism. The larger the metric, the worse; a method fails if its metric exceeds the bound."""

    name: str
    mechanism: str
    metric: str  # what is measured
    bound: float
    source: str  # of the bound
    remedy: str
    trials: tuple[Trial, ...]
    theory: tuple[Theory, ...] = ()
    unit: str = ""  # of the metric and its bound
    slow: bool = False  # takes more than a few seconds
    axes: tuple[str, str] | None = None  # axis labels of the chart, if the trials give curves

    @property
    def default_fails(self) -> bool:
        """Whether a default of a case is expected to fail."""
        return any(trial.default and not trial.should_pass for trial in self.trials)


@dataclass(frozen=True)
class TrialOutcome:
    """A trial and its observation."""

    trial: Trial
    observation: Observation
    passed: bool

    @property
    def verdict(self) -> Verdict:
        """Whether the outcome is the expected one."""
        if self.passed == self.trial.should_pass:
            return "as expected"
        return "unexpected pass" if self.passed else "unexpected failure"


@dataclass(frozen=True)
class TheoryOutcome:
    """A known value and the measured one."""

    theory: Theory
    value: float

    @property
    def error(self) -> float:
        """Relative error of the measured value."""
        return self.value / self.theory.value - 1.0

    @property
    def verdict(self) -> Verdict:
        """Whether the values agree within the tolerance; NaN does not."""
        return "as expected" if abs(self.error) <= self.theory.tolerance else "deviates from theory"


@dataclass(frozen=True)
class ScenarioOutcome:
    """All observations of a scenario."""

    scenario: Scenario
    trials: tuple[TrialOutcome, ...]
    theory: tuple[TheoryOutcome, ...]
    seconds: float

    @property
    def verdict(self) -> Verdict:
        """The first verdict that is not "as expected"."""
        verdicts = [trial.verdict for trial in self.trials] + [known.verdict for known in self.theory]
        return next((verdict for verdict in verdicts if verdict != "as expected"), "as expected")


def run_scenario(scenario: Scenario) -> ScenarioOutcome:
    """Run every method of a scenario."""
    started = time.perf_counter()
    trials = tuple(_run_trial(trial, scenario.bound) for trial in scenario.trials)
    theory = tuple(TheoryOutcome(known, known.measure()) for known in scenario.theory)
    return ScenarioOutcome(scenario, trials, theory, time.perf_counter() - started)


def _run_trial(trial: Trial, bound: float) -> TrialOutcome:
    try:
        found = trial.measure()
        observation = found if isinstance(found, Observation) else Observation(float(found))
    except NumericalFailure as failure:
        note = f"stopped: {failure.failure['cause']}, t = {failure.failure['time']:.3g} s"
        observation = Observation(STOPPED, note)
    return TrialOutcome(trial, observation, observation.metric <= bound)  # NaN has not passed
