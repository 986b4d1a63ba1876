"""The map of where methods stand: its rule with planted runs, its definitions, its report, and a small one whole."""

from __future__ import annotations

import csv
import json
from math import nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

from mpmcol.case import load_case
from mpmcol.cli import main
from mpmcol.errors import OutputError, UsageError
from mpmcol.measure import FRONTS, Measurement
from mpmcol.studies.method_map.definition import load_map, shipped_maps
from mpmcol.studies.method_map.grid_points import Place, places_of, repeats_of
from mpmcol.studies.method_map.rows import panels_of, stands_up_to
from mpmcol.studies.method_map.text import closing_lines, markdown
from mpmcol.studies.method_map.verdict import (
    FLOORS,
    Judged,
    Name,
    Reference,
    Seen,
    Verdict,
    judge,
    make_reference,
    reference_of,
    signs_of,
    weigh,
)
from mpmcol.studies.runs import with_settings
from mpmcol.sweep.engine import Outcome
from mpmcol.sweep.task import TaskResult

TINY = """
schema = 1
title = "tiny"

[scenes.low]
case = "lube-channel"
aspect = 1.0
cells = 6
finer = 7
repeats = 3
finer_repeats = 1

[blocks.plain]
scene = "low"
down = { "method.transfer" = ["taylor-flip"] }
across = { "time.cfl" = [0.4, 0.5, 2] }

[blocks."a few points"]
scene = "low"
set = { "grid.points_per_cell" = 1 }
panels = { "method.opening_strain" = [true] }
down = { "method.transfer" = ["taylor-flip", "pic"] }
across = { "time.cfl" = [0.5] }
"""


def write(folder: Path, old: str = "", new: str = "") -> Path:
    path = folder / "tiny.toml"
    assert not old or old in TINY
    path.write_text(TINY.replace(old, new) if old else TINY)
    return path


# ------------------------------------------------------------------------------------------------ the rule


def deposit(zeta: float = 1.0, beta: float = 0.9, ahead: float = 0.05) -> Measurement:
    """A wedge of r_i = 1 m, its area the same for every runout."""
    x = np.linspace(0.0, 4.0, 401)
    reach = 1.0 + zeta
    front = {name: reach * (1.0 + (ahead if name == "front_max" else 0.0)) for name in FRONTS}
    y = np.maximum(2.0 / reach * (1.0 - x / reach), 0.0)
    return Measurement(front, dict.fromkeys(FRONTS, zeta), 0.0, beta, beta, 0.5, None, x, y)


def seen(volume: float = 0.004, slowing: float = 0.02, **deposit_: float) -> Seen:
    return Seen(deposit(**deposit_), volume, slowing)


# The own method runs 15 % short with a scatter of a hundredth, on a finer grid zeta = 1.2.
OWN = [seen(zeta=zeta) for zeta in (1.01, 1.02, 1.03)]
REFERENCE = reference_of(OWN, [deposit(1.19, 0.92), deposit(1.21, 0.92)])


def verdict_on(run: Seen, reference: Reference = REFERENCE) -> Verdict:
    return weigh(signs_of(run, reference), reference.limits)


def test_limits_are_those_of_a_further_run_of_the_own_method() -> None:
    assert REFERENCE.zeta == pytest.approx(1.2) and REFERENCE.means["zeta"] == pytest.approx(0.15)
    assert REFERENCE.deviations["zeta"] == pytest.approx(0.01 / 1.2)
    assert REFERENCE.limits["zeta"] == pytest.approx(1.5 * 0.15 + 4.0 * (0.01 / 1.2) * np.sqrt(4.0 / 3.0))
    assert REFERENCE.limits["beta"] == FLOORS["beta"] > 1.5 * 0.02 / 0.92
    assert (REFERENCE.limits["ahead"], REFERENCE.limits["volume"]) == (FLOORS["ahead"], FLOORS["volume"])
    noisy = reference_of([seen(ahead=0.3), seen(ahead=0.5)], [deposit()])
    assert noisy.limits["ahead"] > 0.5  # no floor where the own method is worse


@pytest.mark.parametrize(
    ("run", "beyond"),
    [
        (seen(zeta=1.02), []),
        (seen(zeta=0.95), []),  # less than half as far again
        (seen(zeta=1.2), []),  # better than the own method
        (seen(zeta=0.6), ["profile", "zeta"]),
        (seen(zeta=1.8), ["zeta", "profile"]),
        (seen(zeta=1.02, beta=0.8), ["beta"]),
        (seen(zeta=1.02, ahead=0.24), []),
        (seen(zeta=1.02, ahead=0.3), ["ahead"]),
        (seen(zeta=1.02, volume=0.3), ["volume"]),
        (seen(zeta=1.02, slowing=0.4), ["slowing"]),
        (seen(zeta=1.02, slowing=0.26, volume=0.9), ["volume", "slowing"]),  # the worst first
    ],
)
def test_a_run_degrades_by_the_signs_beyond_their_limits(run: Seen, beyond: list[str]) -> None:
    verdict = verdict_on(run)
    assert (list(verdict.beyond), verdict.name) == (beyond, "degrades" if beyond else "stands")


def test_a_sign_that_is_no_number_is_beyond_every_limit() -> None:
    assert weigh(dict.fromkeys(FLOORS, 0.0) | {"zeta": nan}, REFERENCE.limits).beyond == ["zeta"]


def test_every_run_of_the_own_method_stands() -> None:
    rng = np.random.default_rng(3)
    for _ in range(200):
        runs = [seen(zeta=1.02 + 0.01 * rng.standard_normal()) for _ in range(9)]
        reference = reference_of(runs[:8], [deposit(1.2, 0.92)])
        assert all(verdict_on(run, reference).name == "stands" for run in runs[:8])


def test_a_place_whose_run_did_not_end_well_fails_with_its_cause(tmp_path: Path) -> None:
    place = planted("stands").place
    point = place.member.plan(tmp_path)
    point.folder.mkdir()
    diverged = Outcome(point, TaskResult("failed", 1, 3, "a cause; a remedy"))
    assert judge(place, diverged, None, REFERENCE).verdict == Verdict("fails", {}, (), "a cause; a remedy")
    (point.folder / "result.json").write_text(json.dumps({"status": "failed", "failure": {"cause": "a cause"}}))
    assert judge(place, diverged, None, REFERENCE).verdict.cause == "a cause"
    broken = Outcome(point, TaskResult("error", 3, 1, "killed by SIGKILL, 3 times"))
    (point.folder / "result.json").unlink()
    assert judge(place, broken, None, REFERENCE).verdict.cause == "killed by SIGKILL, 3 times"
    assert judge(place, None, None, REFERENCE).verdict.name == "open"


def test_a_scene_without_runs_to_judge_by_is_told() -> None:
    with pytest.raises(OutputError, match="scene low: 0 runs of its own method and 0 finer"):
        make_reference("low", [], [], Path("runs"))


# ------------------------------------------------------------------------------------------------ definitions


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("finer = 7", "finer = 6", "scenes.low: finer is 6, expected more than cells, 6"),
        ('scene = "low"\ndown', 'scene = "high"\ndown', "blocks.plain: no scene is called 'high'"),
        ("title =", "titel =", "titel: Extra inputs are not permitted"),
        ("{ \"time.cfl\" = [0.4, 0.5, 2] }", "{}", "blocks.plain.across: Dictionary should have at least 1 item"),
        ("[0.4, 0.5, 2]", "[]", "blocks.plain.across.time.cfl: Tuple should have at least 1 item"),
        ("{ \"method.opening_strain\" = [true] }", "{ \"time.cfl\" = [1] }", "time.cfl is given twice"),
        ("[blocks.plain]", "[scenes.idle]\ncase='a'\naspect=1\ncells=2\nfiner=3\n[blocks.plain]", "no block uses"),
    ],
)  # fmt: skip
def test_a_map_that_is_wrong_is_told_with_its_key(old: str, new: str, told: str, tmp_path: Path) -> None:
    path = write(tmp_path, old, new)
    with pytest.raises(UsageError) as error:
        load_map(str(path))
    assert told in str(error.value) and str(path) in str(error.value)


def test_a_place_whose_case_is_wrong_is_told_with_its_choices(tmp_path: Path) -> None:
    path = write(tmp_path, '["taylor-flip"]', '["taylor-flip", "pik"]')
    with pytest.raises(UsageError, match="(?s)blocks.plain, method.transfer = pik, time.cfl = 0.4:.*pik"):
        list(places_of(load_map(str(path))))


def test_equal_runs_of_several_blocks_are_one(tmp_path: Path) -> None:
    """What a case has anyway makes no other run, nor a second folder."""
    map_ = load_map(str(write(tmp_path)))
    own, finer = repeats_of(map_.scenes["low"])
    places = list(places_of(map_))
    assert len(own) == 3 and len(finer) == 1 and own[0] == places[1].member
    assert places[3].choices["method.opening_strain"] == "true"
    assert dict(places[3].member.settings).keys() == {"output.snapshots", "grid.points_per_cell"}


def test_the_default_is_a_method_not_a_material(tmp_path: Path) -> None:
    path = write(tmp_path, '"grid.points_per_cell" = 1', '"material.youngs_modulus" = "1 MPa"')
    assert [place.is_default for place in places_of(load_map(str(path)))] == [True, True, False, True, False]


def test_the_shipped_map_covers_the_choices() -> None:
    assert set(shipped_maps()) == {"default", "quick"}
    places = list(places_of(load_map("default")))
    assert len({place.member for place in places}) >= 300
    keys = {key for place in places for key in place.choices}
    assert keys >= {
        "time.cfl", "method.basis", "method.transfer", "grid.points_per_cell", "method.opening_strain",
        "stages.collapse.damping", "material.youngs_modulus",
    }  # fmt: skip


# ------------------------------------------------------------------------------------------------ reports


def planted(name: Name, cfl: str = "0.5", default: bool = False, **more: Any) -> Judged:
    choices = {"method.transfer": "pic", "time.cfl": cfl}
    member = with_settings("lube-channel", 1.0, 0.015, **choices)
    place = Place("plain", "plain", "low", choices, "time.cfl", "method.transfer", default, member)
    return Judged(place, None, None, Verdict(name, **({"signs": {}} | more)))


def test_a_row_stands_up_to_its_first_place_that_does_not() -> None:
    names: tuple[Name, ...] = ("stands", "stands", "degrades", "stands")
    row = [planted(name, cfl) for name, cfl in zip(names, ("0.3", "0.5", "0.7", "0.9"), strict=True)]
    (panel,) = panels_of(row)
    assert (panel.values_down, panel.values_across) == (["pic"], ["0.3", "0.5", "0.7", "0.9"])
    assert stands_up_to(panel.rows[0]) is row[1] and stands_up_to(row[2:]) is None


def test_the_report_names_gaps_causes_and_signs(tmp_path: Path) -> None:
    judged = [
        planted("stands", "0.3", default=True),
        planted("degrades", "0.5", default=True, signs=dict.fromkeys(FLOORS, 0.0) | {"beta": 0.3}, beyond=("beta",)),
        planted("fails", "0.9", cause="it burst (value 3)"),
        planted("fails", "1.1", cause="it burst (value 4)"),
        planted("open", "1.3"),
    ]
    map_ = load_map(str(write(tmp_path)))
    text = markdown(map_, {"low": REFERENCE}, judged, [], {"mpmcol": "1", "cpu": "a cpu"})
    for part in (
        "5 places: 1 stand, 1 degrade, 2 fail, 1 have not been run.",
        "The default method stands at 1 of 2 places; where it does not:",
        "* plain, transfer pic, cfl 0.5: height 0.3",
        "| pic | stands | β 0.3 | fails | fails | not run | 0.3 |",
        "| it burst | 2 | plain: 2 | plain, transfer pic, cfl 0.9; plain, transfer pic, cfl 1.1 |",
        "| height | 1 | plain: 1 |",
        "| ζ runout (front_height) | 0.1 | 0.263 (0.15 +- 0.008) |",
    ):
        assert part in text
    assert "plain  5 places" in next(closing_lines(judged))
    assert "stands at 1 of 1 places." in "\n".join(closing_lines(judged[:1]))


def test_a_small_map_from_end_to_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    path, out = write(tmp_path), tmp_path / "stability" / "map-tiny"

    def invoke(*words: str) -> Any:
        return CliRunner().invoke(main, ["stability", "--map", str(path), *words])

    done = invoke("--jobs", "1")
    assert done.exit_code == 0, done.output
    assert "5 places: 2 stand, 2 degrade, 1 fail" in done.output
    assert "The default method stands at 2 of 2 places." in done.output
    rows = list(csv.DictReader((out / "map.csv").read_text().splitlines()))
    assert [row["verdict"] for row in rows] == ["stands", "stands", "fails", "degrades", "degrades"]
    assert rows[2]["cause"] and rows[2]["zeta.sign"] == "" and float(rows[4]["zeta.sign"]) > 0.5
    assert (rows[4]["grid.points_per_cell"], rows[0]["grid.points_per_cell"]) == ("1", "4")
    assert load_case(out / "runs" / rows[4]["folder"] / "case.toml").grid.points_per_cell == 1
    assert json.loads((out / "environment.json").read_text())["numba"]
    assert (out / "map.png").stat().st_size > 10_000
    before = {file: file.stat().st_mtime_ns for file in (out / "runs").rglob("*") if file.is_file()}
    again = invoke("--report-only", "--quiet")
    assert (again.exit_code, again.output) == (0, "")
    assert {file: file.stat().st_mtime_ns for file in (out / "runs").rglob("*") if file.is_file()} == before
    write(tmp_path, "[0.4, 0.5, 2]", "[0.4, 0.45, 2]")
    record = json.loads(invoke("--report-only", "--json").stdout)
    assert [row["verdict"] for row in record["rows"]].count("open") == 1


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--map", "one", "two"], "--map takes one map and no --list"),
        (["--map", "--list"], "--map takes one map and no --list"),
        (["--jobs", "2"], "--jobs and --report-only go with --map"),
        (["--report-only"], "--jobs and --report-only go with --map"),
        (["--map", "defualt"], "defualt: no such map; did you mean 'default'"),
    ],
)
def test_words_that_do_not_fit_are_refused(
    words: list[str], told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(main, ["stability", *words])
    assert result.exit_code == 2 and told in result.output
    assert list(tmp_path.iterdir()) == []


def test_a_report_without_any_run_is_refused(tmp_path: Path) -> None:
    words = ["stability", "--map", str(write(tmp_path)), "--report-only", "--out", str(tmp_path / "out")]
    result = CliRunner().invoke(main, words)
    assert result.exit_code == 5 and "expected at least 2 and 1" in result.output
