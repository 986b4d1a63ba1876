"""Catalogue of failure modes: scenarios have the expected outcomes, and unexpected ones are reported."""

from __future__ import annotations

import csv
import json
from math import inf, nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mpmcol.errors import NumericalFailure, UsageError, matches
from mpmcol.failure_modes import scenarios
from mpmcol.failure_modes.report import markdown, table_rows, write_report
from mpmcol.failure_modes.scenario import (
    Observation,
    Scenario,
    Theory,
    Trial,
    failing,
    passing,
    run_scenario,
)
from tests.support.cli import invoke

SCENARIOS = list(scenarios.SCENARIOS.values())
QUICK = [scenario for scenario in SCENARIOS if not scenario.slow]
SLOW = [scenario for scenario in SCENARIOS if scenario.slow]


def stopped() -> float:
    raise NumericalFailure("the run stopped", {"cause": "a cause", "time": 0.25})


def scenario(*trials: Trial, **change: Any) -> Scenario:
    """A scenario whose bound is 1."""
    fields: dict[str, Any] = {
        "name": "group-one", "mechanism": "Something breaks.", "metric": "a metric", "unit": "m", "bound": 1.0,
        "source": "a source", "remedy": "a remedy", "trials": trials,
    }  # fmt: skip
    return Scenario(**(fields | change))


def bad(metric: float = 2.0, default: bool = False) -> Trial:
    return failing("bad", lambda: metric, default)


def good(metric: float = 0.5, default: bool = False) -> Trial:
    return passing("good", lambda: metric, default)


def theory(value: float) -> Theory:
    """Known to be 4, within 5 %."""
    return Theory("a known quantity", 4.0, lambda: value, "a book")


# ------------------------------------------------------------------------------------------------ the scenarios


@pytest.mark.parametrize("one", QUICK, ids=lambda one: one.name)
def test_scenario_has_the_expected_outcomes(one: Scenario) -> None:
    outcome = run_scenario(one)
    trials = [(trial.trial.method, trial.observation.metric, trial.verdict) for trial in outcome.trials]
    assert outcome.verdict == "as expected", (trials, [(known.value, known.error) for known in outcome.theory])


@pytest.mark.slow
@pytest.mark.parametrize("one", SLOW, ids=lambda one: one.name)
def test_slow_scenario_has_the_expected_outcomes(one: Scenario) -> None:
    test_scenario_has_the_expected_outcomes(one)


def test_the_catalogue_is_complete() -> None:
    """Each scenario has a failing and a passing method, a mechanism, a metric, a source and a remedy."""
    assert len(SCENARIOS) >= 24
    for one in SCENARIOS:
        assert {trial.should_pass for trial in one.trials} == {True, False}, one.name
        assert all((one.mechanism.endswith("."), one.metric, one.source, one.remedy)), one.name
        assert len({trial.method for trial in one.trials}) == len(one.trials), one.name
        assert all(0.0 < known.tolerance <= 0.05 for known in one.theory), one.name


def test_the_stability_limit_is_measured_in_all_four_geometries() -> None:
    names = {one.name for one in SCENARIOS if one.theory and matches(one, "time-step")}
    assert names >= {"time-step-1d", "time-step-plane", "time-step-axisymmetric", "time-step-3d"}


# ------------------------------------------------------------------------------------------------ verdicts


@pytest.mark.parametrize(
    ("trials", "known", "verdict"),
    [
        ([bad(), good()], [], "as expected"),
        ([bad(), good()], [4.1], "as expected"),
        ([bad(inf), good(-inf)], [], "as expected"),
        ([bad(nan), good(1.0)], [], "as expected"),
        ([bad(1.0), good()], [], "unexpected pass"),
        ([bad(), good(1.1)], [], "unexpected failure"),
        ([bad(), good(nan)], [], "unexpected failure"),
        ([bad(), passing("good", stopped)], [], "unexpected failure"),
        ([failing("bad", stopped), good()], [], "as expected"),
        ([bad(), good()], [4.3], "deviates from theory"),
        ([bad(), good()], [4.0, nan], "deviates from theory"),
    ],
)
def test_verdicts(trials: list[Trial], known: list[float], verdict: str) -> None:
    assert run_scenario(scenario(*trials, theory=tuple(map(theory, known)))).verdict == verdict


def test_a_run_that_stops_has_failed_and_the_note_states_the_cause() -> None:
    outcome = run_scenario(scenario(failing("bad", stopped), good()))
    assert outcome.trials[0].observation.metric == inf
    assert "a cause" in outcome.trials[0].observation.note


def test_a_failing_default_is_marked() -> None:
    assert scenario(bad(default=True), good()).default_fails
    assert not scenario(bad(), good(default=True)).default_fails


# ------------------------------------------------------------------------------------------------ names, reports


def test_names_and_groups(monkeypatch: pytest.MonkeyPatch) -> None:
    fakes = {name: scenario(bad(), good(), name=name) for name in ("group-one", "group-two", "groups")}
    monkeypatch.setattr(scenarios, "SCENARIOS", fakes)
    assert [one.name for one in scenarios.select_scenarios(["group"])] == ["group-one", "group-two"]
    assert [one.name for one in scenarios.select_scenarios(["groups", "group-two"])] == ["group-two", "groups"]
    assert len(scenarios.select_scenarios([])) == 3
    with pytest.raises(UsageError, match="did you mean 'group-one'"):
        scenarios.select_scenarios(["group-on"])


def test_the_report_has_every_number_and_a_chart(tmp_path: Path) -> None:
    line = np.linspace(0.0, 1.0, 5)
    drawn = failing("bad", lambda: Observation(2.0, "a note", (line, line**2)), default=True)
    outcome = run_scenario(scenario(drawn, good(), theory=(theory(4.1),), axes=("time (s)", "metric (m)")))
    files = write_report([outcome], tmp_path)
    assert [path.name for path in files] == ["stability.csv", "stability.md", "group-one.png"]
    with (tmp_path / "stability.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [(row["method"], row["value"], row["verdict"]) for row in rows] == [
        ("bad", "2.0", "as expected"), ("good", "0.5", "as expected"), ("", "4.1", "as expected"),
    ]  # fmt: skip
    text = (tmp_path / "stability.md").read_text()
    values = ("2 m", "+2.5 % from theory (4)")
    for part in ("Something breaks.", "bad (default)", *values, "a note", "a remedy", "a source", "a book", ".png"):
        assert part in text
    assert "Scenarios in which a default fails" in text


def test_a_scenario_without_curves_has_no_chart(tmp_path: Path) -> None:
    outcome = run_scenario(scenario(bad(), good()))
    assert len(write_report([outcome], tmp_path)) == 2
    assert "a default fails" not in markdown([outcome], {})
    assert [row["outcome"] for row in table_rows(outcome)] == ["failed", "passed"]


@pytest.mark.parametrize(("metric", "code"), [(2.0, 0), (0.5, 4)])
def test_the_command_exits_with_4_if_an_outcome_is_unexpected(
    metric: float, code: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(scenarios, "SCENARIOS", {"group-one": scenario(bad(metric, default=True), good())})
    result = invoke("stability", "--out", tmp_path)
    assert result.exit_code == code
    assert ("UNEXPECTED PASS" in result.output) == (code == 4)
    assert "a default fails in: group-one" in result.output
    record = json.loads(invoke("stability", "group", "--json", "--out", tmp_path).stdout)
    assert record["passed"] == (code == 0)
    assert len(record["rows"]) == 2
    quiet = invoke("stability", "--quiet", "--out", tmp_path)
    assert len(quiet.output.splitlines()) == 1


def test_the_list_shows_every_scenario_and_runs_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    lines = invoke("stability", "--list").output.splitlines()
    assert [line.split()[0] for line in lines] == [one.name for one in SCENARIOS]
    assert list(tmp_path.iterdir()) == []


def test_an_unknown_name_is_rejected_before_anything_is_written(tmp_path: Path) -> None:
    result = invoke("stability", "tension", "tensoin", "--out", tmp_path / "new")
    assert result.exit_code == 2
    assert "did you mean 'tension'" in result.output
    assert not (tmp_path / "new").exists()
