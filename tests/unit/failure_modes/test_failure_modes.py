"""The catalogue of failures: its scenes go as they must, and a scene that does not is told."""

from __future__ import annotations

import csv
import json
from math import inf, nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

from mpmcol.cli import main as cli
from mpmcol.errors import NumericalFailure, UsageError
from mpmcol.failure_modes import scenarios
from mpmcol.failure_modes.report import markdown, table_rows, write_report
from mpmcol.failure_modes.scenario import Reading, Scene, Theory, Trial, play
from mpmcol.selection import matches

SCENES = list(scenarios.SCENES.values())
QUICK = [scene for scene in SCENES if not scene.slow]
SLOW = [scene for scene in SCENES if scene.slow]


def stopped() -> float:
    raise NumericalFailure("the run stopped", {"cause": "a cause", "time": 0.25})


def scene(*trials: Trial, **change: Any) -> Scene:
    """A scene whose bound is 1."""
    words: dict[str, Any] = {
        "name": "group-one", "mechanism": "Something breaks.", "sign": "a number", "unit": "m", "bound": 1.0,
        "source": "a source", "remedy": "a remedy", "trials": trials,
    }  # fmt: skip
    return Scene(**(words | change))


def failing(sign: float = 2.0, **more: Any) -> Trial:
    return Trial("bad", False, lambda: sign, **more)


def standing(sign: float = 0.5, **more: Any) -> Trial:
    return Trial("good", True, lambda: sign, **more)


def theory(value: float) -> Theory:
    """Known to be 4, within 5 %."""
    return Theory("a known number", 4.0, lambda: value, "a book")


# ------------------------------------------------------------------------------------------------ the scenes


@pytest.mark.parametrize("one", QUICK, ids=lambda one: one.name)
def test_what_must_fail_fails_and_what_must_stand_stands(one: Scene) -> None:
    outcome = play(one)
    told = [(trial.trial.method, trial.reading.sign, trial.verdict) for trial in outcome.trials]
    assert outcome.verdict == "as expected", (told, [(known.value, known.error) for known in outcome.theory])


@pytest.mark.slow
@pytest.mark.parametrize("one", SLOW, ids=lambda one: one.name)
def test_what_must_fail_fails_in_slow_scenes_too(one: Scene) -> None:
    test_what_must_fail_fails_and_what_must_stand_stands(one)


def test_the_catalogue_is_complete() -> None:
    """Each scene has a method that fails and one that stands, and says what it shows, by what, and what helps."""
    assert len(SCENES) >= 24
    for one in SCENES:
        assert {trial.stands for trial in one.trials} == {True, False}, one.name
        assert all((one.mechanism.endswith("."), one.sign, one.source, one.remedy)), one.name
        assert len({trial.method for trial in one.trials}) == len(one.trials), one.name
        assert all(0.0 < known.tolerance <= 0.05 for known in one.theory), one.name


def test_the_bound_of_time_steps_is_met_in_all_four_geometries() -> None:
    names = {one.name for one in SCENES if one.theory and matches(one, "time-step")}
    assert names >= {"time-step-1d", "time-step-plane", "time-step-axisymmetric", "time-step-3d"}


# ------------------------------------------------------------------------------------------------ verdicts


@pytest.mark.parametrize(
    ("trials", "known", "verdict"),
    [
        ([failing(), standing()], [], "as expected"),
        ([failing(), standing()], [4.1], "as expected"),
        ([failing(inf), standing(-inf)], [], "as expected"),
        ([failing(nan), standing(1.0)], [], "as expected"),
        ([failing(1.0), standing()], [], "did not fail"),
        ([failing(), standing(1.1)], [], "did not stand"),
        ([failing(), standing(nan)], [], "did not stand"),
        ([failing(), Trial("good", True, stopped)], [], "did not stand"),
        ([Trial("bad", False, stopped), standing()], [], "as expected"),
        ([failing(), standing()], [4.3], "off theory"),
        ([failing(), standing()], [4.0, nan], "off theory"),
    ],
)
def test_verdicts(trials: list[Trial], known: list[float], verdict: str) -> None:
    assert play(scene(*trials, theory=tuple(map(theory, known)))).verdict == verdict


def test_a_run_that_stops_has_failed_and_says_why() -> None:
    outcome = play(scene(Trial("bad", False, stopped), standing()))
    assert outcome.trials[0].reading.sign == inf
    assert "a cause" in outcome.trials[0].reading.note


def test_a_default_that_fails_is_a_gap() -> None:
    assert scene(failing(default=True), standing()).is_gap
    assert not scene(failing(), standing(default=True)).is_gap


# ------------------------------------------------------------------------------------------------ names, reports


def test_names_and_groups(monkeypatch: pytest.MonkeyPatch) -> None:
    fakes = {name: scene(failing(), standing(), name=name) for name in ("group-one", "group-two", "groups")}
    monkeypatch.setattr(scenarios, "SCENES", fakes)
    assert [one.name for one in scenarios.choose(["group"])] == ["group-one", "group-two"]
    assert [one.name for one in scenarios.choose(["groups", "group-two"])] == ["group-two", "groups"]
    assert len(scenarios.choose([])) == 3
    with pytest.raises(UsageError, match="did you mean 'group-one'"):
        scenarios.choose(["group-on"])


def test_the_report_has_every_number_and_a_chart(tmp_path: Path) -> None:
    line = np.linspace(0.0, 1.0, 5)
    drawn = Trial("bad", False, lambda: Reading(2.0, "a note", (line, line**2)), default=True)
    outcome = play(scene(drawn, standing(), theory=(theory(4.1),), axes=("time (s)", "number (m)")))
    files = write_report([outcome], tmp_path)
    assert [path.name for path in files] == ["stability.csv", "stability.md", "group-one.png"]
    with (tmp_path / "stability.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [(row["method"], row["value"], row["verdict"]) for row in rows] == [
        ("bad", "2.0", "as expected"), ("good", "0.5", "as expected"), ("", "4.1", "as expected"),
    ]  # fmt: skip
    text = (tmp_path / "stability.md").read_text()
    for part in ("Something breaks.", "bad (default)", "2 m", "+2.5 % off 4", "a note", "a remedy", "a source", ".png"):
        assert part in text
    assert "Scenes in which the default fails" in text


def test_a_scene_without_curves_has_no_chart(tmp_path: Path) -> None:
    outcome = play(scene(failing(), standing()))
    assert len(write_report([outcome], tmp_path)) == 2
    assert "the default fails" not in markdown([outcome], {})
    assert [row["outcome"] for row in table_rows(outcome)] == ["failed", "stood"]


@pytest.mark.parametrize(("sign", "code"), [(2.0, 0), (0.5, 4)])
def test_the_command_exits_with_4_if_a_verdict_is_wrong(
    sign: float, code: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(scenarios, "SCENES", {"group-one": scene(failing(sign, default=True), standing())})
    result = CliRunner().invoke(cli, ["stability", "--out", str(tmp_path)])
    assert result.exit_code == code
    assert ("DID NOT FAIL" in result.output) == (code == 4)
    assert "the default fails in: group-one" in result.output
    record = json.loads(CliRunner().invoke(cli, ["stability", "group", "--json", "--out", str(tmp_path)]).stdout)
    assert record["passed"] == (code == 0)
    assert len(record["rows"]) == 2
    quiet = CliRunner().invoke(cli, ["stability", "--quiet", "--out", str(tmp_path)])
    assert len(quiet.output.splitlines()) == 1


def test_the_list_names_every_scene_and_plays_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    lines = CliRunner().invoke(cli, ["stability", "--list"]).output.splitlines()
    assert [line.split()[0] for line in lines] == [one.name for one in SCENES]
    assert list(tmp_path.iterdir()) == []


def test_a_name_that_means_nothing_is_refused_before_anything_is_written(tmp_path: Path) -> None:
    result = CliRunner().invoke(cli, ["stability", "tension", "tensoin", "--out", str(tmp_path / "new")])
    assert result.exit_code == 2
    assert "did you mean 'tension'" in result.output
    assert not (tmp_path / "new").exists()
