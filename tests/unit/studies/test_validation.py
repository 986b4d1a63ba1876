"""Checks against experiments: measures on known deposits, verdicts, and a check from the command line, which rejects a
wrong friction angle."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mpmcol.experiments import profile_score
from mpmcol.measure import ColumnShape, Measurement, failure_line
from mpmcol.studies.runs import REPEATED_CFL, CompletedRun
from mpmcol.studies.validation import CHECKS, Validation, measures, select_checks
from mpmcol.studies.validation.check import Band, Check, CheckResult, Column, evaluate_check
from mpmcol.studies.validation.report import markdown, summary
from tests.support.cli import invoke

COLUMN = Column("bui-rods", 0.5, 0.0025, 0.005)
WRONG = {"wrong": COLUMN.with_values(material__friction_deg="30")}


def deposit(x: Any, y: Any, front: float = 1.0, height: float = 1.0) -> Measurement:
    """A measured deposit with this profile."""
    fronts = dict.fromkeys(("front_max", "front_connected", "front_height"), front)
    return Measurement(fronts, fronts, 0.0, height, 1.0, 0.4, None, None, np.asarray(x), np.asarray(y))


def completed(value: float | None, at_rest: bool = True) -> CompletedRun:
    return CompletedRun({"number": value, "at_rest": at_rest}, Path("nowhere"))


def check(band: Band, controls: dict[str, Column] | None = None) -> Check:
    measure = measures.column_of("number")
    return Check("name", "bui-2008", "a number", "mm", COLUMN, measure, band, WRONG if controls is None else controls)


def evaluated(
    own: list[float | None], control: float | None, controls: dict[str, Column] | None = None, verified: bool = True
) -> CheckResult:
    """The result of full runs with these numbers, for the band 1 to 2; a control of 0 is not run."""
    one = check(Band(1.0, 2.0, "a source", verified), controls)
    runs = {run: completed(value) for run, value in zip(COLUMN.runs(False), own, strict=True)}
    (wrong,) = WRONG["wrong"].runs(False, repeated=False)
    return evaluate_check(one, runs | ({wrong: completed(control)} if control != 0.0 else {}), False)


def test_the_failure_line_separates_points_at_rest_from_moving_ones() -> None:
    """A lattice of 1 mm in a block of 40 x 20 mm, of which all points beyond x = 10.6 mm + y have slid."""
    size = 1e-3
    grid = size * (np.stack(np.meshgrid(np.arange(40), np.arange(20)), axis=-1).reshape(-1, 2) + 0.5)
    slid = grid[:, 0] > 0.0106 + grid[:, 1]  # the first at 11 mm + y
    moved = np.where(slid[:, None], (0.05, -0.004), (1e-4, -1e-4))
    shape = ColumnShape("plane", "one-sided", 0.04, 0.02, 2 * size, 2650.0, size)
    x, y = failure_line(grid + moved, moved, shape, 1.6e-3)
    assert y == pytest.approx(size * (np.arange(20) + 0.5))
    assert x == pytest.approx(0.0105 + y)
    still, _ = failure_line(grid + moved, moved, shape, 0.1)
    assert still == pytest.approx(np.full(20, 0.04))  # a row without moving points ends at the edge of the column


def test_distances_to_a_line_are_the_shortest() -> None:
    line = np.array([0.0, 0.1]), np.array([0.0, 0.1])
    points = np.array([0.05, 0.06, 0.0]), np.array([0.05, 0.04, 0.02])
    assert measures.distance_to_line(*points, *line) == pytest.approx(
        np.array([0.0, 0.02, 0.02]) / np.sqrt(2), abs=1e-4
    )


def test_the_surface_is_compared_over_its_length() -> None:
    """An exact deposit, and one that is 2 mm too high everywhere."""
    x, y = measures.points_of(measures.SURFACE)
    fine = np.linspace(0.0, 0.46, 2000)
    exact, high = (deposit(fine, np.interp(fine, x, y, right=0.0) + shift) for shift in (0.0, 0.002))
    assert measures.rms_mm(exact, x, y) < 0.01
    assert measures.rms_mm(high, x, y) == pytest.approx(2.0, abs=0.01)
    score = profile_score(high.profile_x, high.profile_y, measures.RODS)
    assert score is not None and measures.rms_mm(high, x, y) == pytest.approx(score.rms_mm)


def test_a_deposit_that_is_too_short_is_compared_over_the_full_length() -> None:
    x, y = np.array([0.0, 1.0]), np.array([1.0, 1.0])
    short = deposit([0.0, 0.5, 0.5001], [1.0, 1.0, 0.0])
    assert measures.rms_mm(short, x, y) == pytest.approx(1000.0 * np.sqrt(0.5), rel=0.01)


def test_the_universal_shape_is_scaled_to_the_deposit() -> None:
    like = deposit([0.0, 0.4], [0.2, 0.0], front=0.4, height=0.2)
    x, y = measures.scaled_shape(like)
    assert (x[0], y[0], x[-1], y[-1]) == (0.0, 0.2, 0.4, 0.0)
    wedge = measures.rms_mm(like, x, y) / (1e3 * like.height)
    assert 0.1 < wedge < 0.2  # a wedge differs by more than the 5 % of the band


def test_a_value_is_the_mean_of_the_runs() -> None:
    result = evaluated([1.2, 1.4, 1.6, 1.8], 3.0)
    assert result.verdict == "passed" and result.value == pytest.approx(1.5)
    assert result.error == pytest.approx(np.std([1.2, 1.4, 1.6, 1.8], ddof=1) / 2.0)
    assert evaluated([2.2, 2.4, 2.6, 2.8], 3.0).verdict == "failed"


def test_a_band_includes_its_ends() -> None:
    assert evaluated([1.0] * 4, 3.0).verdict == "passed" and evaluated([2.0] * 4, 3.0).verdict == "passed"


def test_a_check_whose_control_is_inside_the_band_is_inconclusive() -> None:
    assert evaluated([1.5] * 4, 1.9).verdict == "inconclusive"
    assert evaluated([1.5] * 4, 3.0, controls={}).verdict == "inconclusive"  # a check needs a control
    assert evaluated([2.5] * 4, 1.9).verdict == "failed"


def test_unverified_bands_are_shown_but_do_not_count() -> None:
    unverified, passed = evaluated([2.5] * 4, 3.0, verified=False), evaluated([1.5] * 4, 3.0)
    assert unverified.verdict == "unverified" and unverified.value == 2.5
    assert Validation([unverified, passed], []).passed
    assert not Validation([unverified, evaluated([2.5] * 4, 3.0)], []).passed
    assert summary([unverified, passed]) == "1 of 1 checks passed; 1 with unverified bands"
    assert "| unverified |" in markdown([unverified], [], [], "heading")


def test_bands_without_a_verified_source_are_marked() -> None:
    """Stop times, one law of the height and the diameter of the rods were not read in the publications."""
    unverified = {one.name for one in CHECKS if not one.band.verified}
    assert unverified == {"rods-surface", "channel-height-short", "channel-stop", "cylinder-stop"}


def test_a_check_without_all_runs_has_not_passed() -> None:
    assert evaluated([1.5] * 4, 0.0).verdict == "not run"
    planned, (wrong,) = COLUMN.runs(False), WRONG["wrong"].runs(False, repeated=False)
    some = {run: completed(1.5) for run in planned[1:]} | {wrong: completed(3.0)}
    assert evaluate_check(check(Band(1.0, 2.0, "")), some, False).verdict == "not run"
    assert evaluate_check(check(Band(1.0, 2.0, "")), {}, False).verdict == "not run"


def test_a_missing_value_fails_and_is_outside() -> None:
    assert evaluated([1.5, 1.5, None, 1.5], 3.0).verdict == "failed"  # the front of one run did not stop
    assert evaluated([1.5] * 4, None).verdict == "passed"


def test_quick_runs_are_single_and_coarse() -> None:
    quick, full = COLUMN.runs(True), COLUMN.runs(False)
    assert len(quick) == 1 and quick[0].h == 0.005
    assert len(full) == len(REPEATED_CFL) and {run.h for run in full} == {0.0025}


@pytest.mark.parametrize("quick", [True, False])
def test_every_check_has_valid_cases_controls_and_a_source(quick: bool, tmp_path: Path) -> None:
    assert len({one.name for one in CHECKS}) == len(CHECKS)
    for one in CHECKS:
        assert one.controls and one.band.lo < one.band.hi and "doi:10." in one.band.source, one.name
        runs = one.runs(quick)
        assert len({run.plan(tmp_path).folder for run in runs}) == len(set(runs)) == len(runs)


def test_checks_are_selected_by_group_or_name() -> None:
    assert {one.name for one in select_checks(["rods"])} == {"rods-surface", "rods-front", "rods-failure"}
    assert [one.name for one in select_checks(["channel-stop"])] == ["channel-stop"]
    assert len(select_checks([])) == len(CHECKS)


def test_an_unknown_check_is_refused() -> None:
    result = invoke("validate", "rods-surfce")
    assert result.exit_code == 2 and "did you mean 'rods-surface'" in result.output


@pytest.mark.slow
def test_the_rods_from_the_command_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """On a coarse grid the front passes, and wrong friction angles are rejected. The second time nothing is run. With a
    band that excludes the value the command fails."""
    out = tmp_path / "validation"
    result = invoke("validate", "rods-front", "--quick", "--out", out)
    assert result.exit_code == 0, result.output
    assert "1 of 1 checks passed" in result.output and "friction 25 deg: " in result.output
    with (out / "validation.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["inside"] for row in rows] == ["true", "false", "false"]

    again = invoke("validate", "rods", "--quick", "--out", out, "--json")
    record = json.loads(again.stdout)
    assert "nothing to run" in again.stderr
    numbers = {row["check"]: row["value"] for row in record["checks"] if not row["control"]}
    assert numbers["rods-surface"] < 3.5  # mm, on this grid, for a column of 100 mm
    assert not any(row["inside"] for row in record["checks"] if row["control"])
    verdicts = {row["check"]: row["verdict"] for row in record["checks"] if not row["control"]}
    assert verdicts["rods-front"] == "passed" and set(verdicts) == {"rods-surface", "rods-front", "rods-failure"}
    assert again.exit_code == (0 if record["passed"] else 4)
    assert (out / "rods-surface.png").stat().st_size > 10_000

    strict = [
        replace(one, band=Band(0.0, 1.0, "shorter than any runout")) for one in CHECKS if one.name == "rods-front"
    ]
    monkeypatch.setattr("mpmcol.studies.validation.CHECKS", tuple(strict))
    failed = invoke("validate", "--quick", "--out", out, "--quiet")
    assert failed.exit_code == 4 and "0 of 1 checks passed" in failed.output
