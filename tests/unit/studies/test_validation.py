"""Checks against experiments: what they measure on deposits that are known, how they judge, and one from the command
line, which rejects the wrong angle of friction."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

from mpmcol.cli import main as cli
from mpmcol.experiments import profile_score
from mpmcol.measure import ColumnShape, Measurement, failure_line
from mpmcol.studies.runs import Finished
from mpmcol.studies.validation import CHECKS, choose, measures
from mpmcol.studies.validation.check import TIME_STEPS, Band, Check, Column, judge

COLUMN = Column("bui-rods", 0.5, 0.0025, 0.005)
WRONG = {"wrong": COLUMN.but(material__friction_deg="30")}


def deposit(x: Any, y: Any, front: float = 1.0, height: float = 1.0) -> Measurement:
    """A measured deposit with this profile."""
    fronts = dict.fromkeys(("front_max", "front_connected", "front_height"), front)
    return Measurement(fronts, fronts, 0.0, height, 1.0, 0.4, None, np.asarray(x), np.asarray(y))


def finished(value: float | None, at_rest: bool = True) -> Finished:
    return Finished({"number": value, "at_rest": at_rest}, Path("nowhere"))


def check(band: Band, controls: dict[str, Column] | None = None) -> Check:
    measure = measures.column_of("number")
    return Check("name", "bui-2008", "a number", "mm", COLUMN, measure, band, WRONG if controls is None else controls)


def judged(own: list[float | None], wrong: float | None, controls: dict[str, Column] | None = None) -> Any:
    """The judgement of full runs with these numbers, in the band 1 to 2."""
    one = check(Band(1.0, 2.0, "a source"), controls)
    found = {member: finished(value) for member, value in zip(COLUMN.members(False), own, strict=True)}
    (control,) = WRONG["wrong"].members(False, repeated=False)
    return judge(one, found | ({control: finished(wrong)} if wrong != 0.0 else {}), False)


def test_the_failure_line_lies_between_what_stays_and_what_moves() -> None:
    """A lattice of 1 mm in a block of 40 x 20 mm, of which all beyond x = 10.6 mm + y has slid away."""
    size = 1e-3
    grid = size * (np.stack(np.meshgrid(np.arange(40), np.arange(20)), axis=-1).reshape(-1, 2) + 0.5)
    slid = grid[:, 0] > 0.0106 + grid[:, 1]  # the first at 11 mm + y
    moved = np.where(slid[:, None], (0.05, -0.004), (1e-4, -1e-4))
    shape = ColumnShape("plane", "one-sided", 0.04, 0.02, 2 * size, 2650.0, size)
    x, y = failure_line(grid + moved, moved, shape, 1.6e-3)
    assert y == pytest.approx(size * (np.arange(20) + 0.5))
    assert x == pytest.approx(0.0105 + y)
    still, _ = failure_line(grid + moved, moved, shape, 0.1)
    assert still == pytest.approx(np.full(20, 0.04))  # a row of which nothing has moved ends at the column's edge


def test_distances_to_a_line_are_the_shortest() -> None:
    line = np.array([0.0, 0.1]), np.array([0.0, 0.1])
    points = np.array([0.05, 0.06, 0.0]), np.array([0.05, 0.04, 0.02])
    assert measures.distance_to_line(*points, *line) == pytest.approx(
        np.array([0.0, 0.02, 0.02]) / np.sqrt(2), abs=1e-4
    )


def test_the_surface_is_compared_over_its_length() -> None:
    """A deposit 2 mm too high everywhere, and one that is right."""
    x, y = measures.metres(measures.SURFACE)
    fine = np.linspace(0.0, 0.46, 2000)
    exact, high = (deposit(fine, np.interp(fine, x, y, right=0.0) + shift) for shift in (0.0, 0.002))
    assert measures.rms_mm(exact, x, y) < 0.01
    assert measures.rms_mm(high, x, y) == pytest.approx(2.0, abs=0.01)
    score = profile_score(high.profile_x, high.profile_y, measures.RODS)
    assert score is not None and measures.rms_mm(high, x, y) == pytest.approx(score.rms_mm)


def test_a_deposit_that_ends_early_is_not_excused() -> None:
    x, y = np.array([0.0, 1.0]), np.array([1.0, 1.0])
    short = deposit([0.0, 0.5, 0.5001], [1.0, 1.0, 0.0])
    assert measures.rms_mm(short, x, y) == pytest.approx(1000.0 * np.sqrt(0.5), rel=0.01)


def test_the_universal_shape_is_scaled_to_the_deposit() -> None:
    like = deposit([0.0, 0.4], [0.2, 0.0], front=0.4, height=0.2)
    x, y = measures.scaled_shape(like)
    assert (x[0], y[0], x[-1], y[-1]) == (0.0, 0.2, 0.4, 0.0)
    wedge = measures.rms_mm(like, x, y) / (1e3 * like.height)
    assert 0.1 < wedge < 0.2  # a wedge is no such shape: more than the 5 % that pass


def test_a_number_is_the_mean_of_its_runs() -> None:
    result = judged([1.2, 1.4, 1.6, 1.8], 3.0)
    assert result.verdict == "passed" and result.value == pytest.approx(1.5)
    assert result.error == pytest.approx(np.std([1.2, 1.4, 1.6, 1.8], ddof=1) / 2.0)
    assert judged([2.2, 2.4, 2.6, 2.8], 3.0).verdict == "failed"


def test_a_band_holds_its_ends() -> None:
    assert judged([1.0] * 4, 3.0).verdict == "passed" and judged([2.0] * 4, 3.0).verdict == "passed"


def test_a_check_whose_control_passes_has_proved_nothing() -> None:
    assert judged([1.5] * 4, 1.9).verdict == "proves nothing"
    assert judged([1.5] * 4, 3.0, controls={}).verdict == "proves nothing"  # one without any, too
    assert judged([2.5] * 4, 1.9).verdict == "failed"


def test_a_check_with_an_unverified_band_neither_passes_nor_fails() -> None:
    band = Band(1.0, 2.0, "a source", verified=False)
    (control,) = WRONG["wrong"].members(False, repeated=False)
    for value in (1.5, 2.5):
        found = {member: finished(value) for member in COLUMN.members(False)} | {control: finished(3.0)}
        assert judge(check(band), found, False).verdict == "unverified"


def test_stop_times_are_not_judged_since_their_source_is_unverified() -> None:
    unverified = {one.name for one in CHECKS if not one.band.verified}
    assert unverified == {"channel-stop", "cylinder-stop", "channel-height-short"}


def test_what_did_not_run_has_not_passed() -> None:
    assert judged([1.5] * 4, 0.0).verdict == "not run"
    assert judge(check(Band(1.0, 2.0, "")), {}, False).verdict == "not run"


def test_a_number_that_is_missing_fails_and_is_outside() -> None:
    assert judged([1.5, 1.5, None, 1.5], 3.0).verdict == "failed"  # the front of one run never stopped
    assert judged([1.5] * 4, None).verdict == "passed"


def test_quick_runs_once_and_coarse() -> None:
    quick, full = COLUMN.members(True), COLUMN.members(False)
    assert len(quick) == 1 and quick[0].h == 0.005
    assert len(full) == len(TIME_STEPS) and {member.h for member in full} == {0.0025}


@pytest.mark.parametrize("quick", [True, False])
def test_every_check_can_be_planned_and_says_where_it_is_from(quick: bool, tmp_path: Path) -> None:
    assert len({one.name for one in CHECKS}) == len(CHECKS)
    for one in CHECKS:
        assert one.controls and one.band.lo < one.band.hi and "doi:10." in one.band.source, one.name
        members = one.members(quick)
        assert len({member.plan(tmp_path).folder for member in members}) == len(set(members)) == len(members)


def test_groups_and_names() -> None:
    assert {one.name for one in choose(["rods"])} == {"rods-surface", "rods-front", "rods-failure"}
    assert [one.name for one in choose(["channel-stop"])] == ["channel-stop"]
    assert len(choose([])) == len(CHECKS)


def test_an_unknown_check_is_refused() -> None:
    result = CliRunner().invoke(cli, ["validate", "rods-surfce"])
    assert result.exit_code == 2 and "did you mean 'rods-surface'" in result.output


def test_the_rods_from_the_command_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """On a coarse grid the front passes, and the angles of friction that are not the rods' are rejected; where the
    band asks for more than there is, the command fails; the second time nothing is run."""
    out = tmp_path / "validation"
    result = CliRunner().invoke(cli, ["validate", "rods-front", "--quick", "--out", str(out)])
    assert result.exit_code == 0, result.output
    assert "1 of 1 checks passed" in result.output and "friction 25 deg: " in result.output
    with (out / "validation.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["inside"] for row in rows] == ["true", "false", "false"]

    again = CliRunner().invoke(cli, ["validate", "rods", "--quick", "--out", str(out), "--json"])
    record = json.loads(again.stdout)
    assert "nothing to run" in again.stderr
    numbers = {row["check"]: row["value"] for row in record["checks"] if not row["control"]}
    assert numbers["rods-surface"] < 3.5  # mm: what there is on this grid, of a column 100 mm high
    assert not any(row["inside"] for row in record["checks"] if row["control"])
    verdicts = {row["check"]: row["verdict"] for row in record["checks"] if not row["control"]}
    assert verdicts["rods-front"] == "passed" and set(verdicts) == {"rods-surface", "rods-front", "rods-failure"}
    assert again.exit_code == (0 if record["passed"] else 4)
    assert (out / "rods-surface.png").stat().st_size > 10_000

    strict = [replace(one, band=Band(0.0, 1.0, "nothing runs so short")) for one in CHECKS if one.name == "rods-front"]
    monkeypatch.setattr("mpmcol.studies.validation.CHECKS", tuple(strict))
    failed = CliRunner().invoke(cli, ["validate", "--quick", "--out", str(out), "--quiet"])
    assert failed.exit_code == 4 and "0 of 1 checks passed" in failed.output
