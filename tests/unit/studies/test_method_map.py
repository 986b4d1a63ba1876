"""The map of methods: criteria with constructed runs, definitions, report, and a small map from end to end."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from math import nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mpmcol.case import load_case
from mpmcol.errors import OutputError, UsageError
from mpmcol.measure import FRONTS, Measurement
from mpmcol.studies.method_map.assessment import (
    FLOORS,
    AssessedPoint,
    Assessment,
    MapObservation,
    MapReference,
    Rating,
    assess,
    make_reference,
    metrics_of,
    rate,
    reference_of,
)
from mpmcol.studies.method_map.definition import load_map, shipped_maps
from mpmcol.studies.method_map.points import MapPoint, points_of, reference_runs
from mpmcol.studies.method_map.report import table_rows
from mpmcol.studies.method_map.text import closing_lines, markdown, panels_of, passes_up_to
from mpmcol.studies.runs import EndedRuns, study_run
from mpmcol.sweep.engine import Outcome
from mpmcol.sweep.task import TaskResult
from tests.support.cli import invoke

TINY = """
schema = 1
title = "tiny"

[cases.low]
extends = "lube-channel"
aspect = 1.0
cells = 6
finer = 7
repeats = 3
finer_repeats = 1

[blocks.plain]
case = "low"
down = { "method.transfer" = ["taylor-flip"] }
across = { "time.cfl" = [0.4, 0.5, 2] }

[blocks."a few points"]
case = "low"
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


# ------------------------------------------------------------------------------------------------ criteria


def deposit(zeta: float = 1.0, beta: float = 0.9, detachment: float = 0.05) -> Measurement:
    """A wedge of r_i = 1 m, of the same area for every runout."""
    x = np.linspace(0.0, 4.0, 401)
    reach = 1.0 + zeta
    front = {name: reach * (1.0 + (detachment if name == "front_max" else 0.0)) for name in FRONTS}
    y = np.maximum(2.0 / reach * (1.0 - x / reach), 0.0)
    return Measurement(front, dict.fromkeys(FRONTS, zeta), 0.0, beta, beta, 0.5, None, None, x, y)


def observed(volume: float = 0.004, step_reduction: float = 0.02, **deposit_: float) -> MapObservation:
    return MapObservation(deposit(**deposit_), volume, step_reduction)


# The runout of the own method is 15 % too short with a scatter of 0.01; on the finer grid zeta = 1.2.
OWN = [observed(zeta=zeta) for zeta in (1.01, 1.02, 1.03)]
REFERENCE = reference_of(OWN, [deposit(1.19, 0.92), deposit(1.21, 0.92)])


def assessed(run: MapObservation, reference: MapReference = REFERENCE) -> Assessment:
    return rate(metrics_of(run, reference), reference.limits)


def test_limits_allow_a_further_run_of_the_own_method() -> None:
    assert REFERENCE.zeta == pytest.approx(1.2) and REFERENCE.means["zeta"] == pytest.approx(0.15)
    assert REFERENCE.deviations["zeta"] == pytest.approx(0.01 / 1.2)
    assert REFERENCE.limits["zeta"] == pytest.approx(1.5 * 0.15 + 4.0 * (0.01 / 1.2) * np.sqrt(4.0 / 3.0))
    assert REFERENCE.limits["beta"] == FLOORS["beta"] > 1.5 * 0.02 / 0.92
    assert (REFERENCE.limits["detachment"], REFERENCE.limits["volume"]) == (FLOORS["detachment"], FLOORS["volume"])
    noisy = reference_of([observed(detachment=0.3), observed(detachment=0.5)], [deposit()])
    assert noisy.limits["detachment"] > 0.5  # the floor does not matter if the own method is worse


@pytest.mark.parametrize(
    ("run", "exceeded"),
    [
        (observed(zeta=1.02), []),
        (observed(zeta=0.95), []),  # less than half of the own error in addition
        (observed(zeta=1.2), []),  # better than the own method
        (observed(zeta=0.6), ["profile", "zeta"]),
        (observed(zeta=1.8), ["zeta", "profile"]),
        (observed(zeta=1.02, beta=0.8), ["beta"]),
        (observed(zeta=1.02, detachment=0.24), []),
        (observed(zeta=1.02, detachment=0.3), ["detachment"]),
        (observed(zeta=1.02, volume=0.3), ["volume"]),
        (observed(zeta=1.02, step_reduction=0.4), ["step_reduction"]),
        (observed(zeta=1.02, step_reduction=0.26, volume=0.9), ["volume", "step_reduction"]),  # the worst first
    ],
)
def test_a_run_degrades_if_metrics_exceed_their_limits(run: MapObservation, exceeded: list[str]) -> None:
    result = assessed(run)
    assert (list(result.exceeded), result.rating) == (exceeded, "degrades" if exceeded else "passes")


def test_a_metric_that_is_nan_exceeds_its_limit() -> None:
    assert rate(dict.fromkeys(FLOORS, 0.0) | {"zeta": nan}, REFERENCE.limits).exceeded == ["zeta"]


def test_every_run_of_the_own_method_passes() -> None:
    rng = np.random.default_rng(3)
    for _ in range(200):
        runs = [observed(zeta=1.02 + 0.01 * rng.standard_normal()) for _ in range(9)]
        reference = reference_of(runs[:8], [deposit(1.2, 0.92)])
        assert all(assessed(run, reference).rating == "passes" for run in runs[:8])


def test_a_point_whose_run_was_not_successful_fails_with_its_cause(tmp_path: Path) -> None:
    point = constructed("passes").point
    run = point.run.plan(tmp_path)
    run.folder.mkdir()

    def assessment(result: TaskResult | None) -> Assessment:
        ended = EndedRuns(tmp_path, {point.run: Outcome(run, result)} if result else {})
        return assess(point, ended, REFERENCE).assessment

    diverged = TaskResult("failed", 1, 3, "a cause; a fix")
    assert assessment(diverged) == Assessment("fails", {}, (), "a cause; a fix")
    failed = {"schema": 1, "status": "failed", "failure": {"cause": "a cause"}}
    (run.folder / "result.json").write_text(json.dumps(failed))
    assert assessment(diverged).cause == "a cause"
    (run.folder / "result.json").unlink()
    assert assessment(TaskResult("error", 3, 1, "killed by SIGKILL, 3 times")).cause == "killed by SIGKILL, 3 times"
    assert assessment(None).rating == "not run"


def test_a_case_without_reference_runs_is_refused() -> None:
    with pytest.raises(OutputError, match="case low: 0 runs of its own method and 0 on the finer grid"):
        make_reference("low", [], [], Path("runs"))


# ------------------------------------------------------------------------------------------------ definitions


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("finer = 7", "finer = 6", "cases.low: finer is 6, expected more than cells, 6"),
        ('case = "low"\ndown', 'case = "high"\ndown', "blocks.plain: there is no case 'high'"),
        ("title =", "titel =", "titel: Extra inputs are not permitted"),
        ("{ \"time.cfl\" = [0.4, 0.5, 2] }", "{}", "blocks.plain.across: Dictionary should have at least 1 item"),
        ("repeats = 3", "repeats = 50", "cases.low.repeats: Input should be less than or equal to 20"),
        ("[0.4, 0.5, 2]", "[]", "blocks.plain.across.time.cfl: Tuple should have at least 1 item"),
        ("{ \"method.opening_strain\" = [true] }", "{ \"time.cfl\" = [1] }", "time.cfl is given twice"),
        ("[blocks.plain]", "[cases.idle]\nextends='a'\naspect=1\ncells=2\nfiner=3\n[blocks.plain]", "no block uses"),
    ],
)  # fmt: skip
def test_an_invalid_map_is_refused_with_its_key(old: str, new: str, message: str, tmp_path: Path) -> None:
    path = write(tmp_path, old, new)
    with pytest.raises(UsageError) as error:
        load_map(str(path))
    assert message in str(error.value) and str(path) in str(error.value)


def test_an_invalid_combination_is_refused_with_its_choices(tmp_path: Path) -> None:
    path = write(tmp_path, '["taylor-flip"]', '["taylor-flip", "pik"]')
    with pytest.raises(UsageError, match="(?s)blocks.plain, method.transfer = pik, time.cfl = 0.4:.*pik"):
        list(points_of(load_map(str(path))))


def test_a_key_of_another_law_is_empty_in_the_table() -> None:
    one = constructed("not run")
    softening = replace(one, point=replace(one.point, choices={"material.strain_factor": "1"}))
    assert [row["material.strain_factor"] for row in table_rows([one, softening])] == [None, None]


def test_blocks_share_equal_runs(tmp_path: Path) -> None:
    """Values that the case has already are not part of a run."""
    definition = load_map(str(write(tmp_path)))
    own, finer = reference_runs(definition.cases["low"])
    points = list(points_of(definition))
    assert len(own) == 3 and len(finer) == 1 and own[0] == points[1].run
    assert points[3].choices["method.opening_strain"] == "true"
    assert dict(points[3].run.overrides).keys() == {"output.snapshots", "grid.points_per_cell"}


def test_the_default_is_a_method_not_a_material(tmp_path: Path) -> None:
    path = write(tmp_path, '"grid.points_per_cell" = 1', '"material.youngs_modulus" = "1 MPa"')
    assert [point.is_default for point in points_of(load_map(str(path)))] == [True, True, False, True, False]


def test_the_shipped_map_covers_the_choices() -> None:
    assert set(shipped_maps()) == {"default", "quick"}
    points = list(points_of(load_map("default")))
    assert len({point.run for point in points}) >= 300
    keys = {key for point in points for key in point.choices}
    assert keys >= {
        "time.cfl", "method.basis", "method.transfer", "grid.points_per_cell", "method.opening_strain",
        "stages.collapse.damping", "material.youngs_modulus",
    }  # fmt: skip


# ------------------------------------------------------------------------------------------------ reports


def constructed(rating: Rating, cfl: str = "0.5", default: bool = False, **more: Any) -> AssessedPoint:
    choices = {"method.transfer": "pic", "time.cfl": cfl}
    run = study_run("lube-channel", 1.0, 0.015, **choices)
    point = MapPoint("plain", "plain", "low", choices, "time.cfl", "method.transfer", default, run)
    return AssessedPoint(point, None, None, Assessment(rating, **({"metrics": {}} | more)))


def test_a_row_passes_up_to_its_first_point_that_does_not() -> None:
    ratings: tuple[Rating, ...] = ("passes", "passes", "degrades", "passes")
    row = [constructed(rating, cfl) for rating, cfl in zip(ratings, ("0.3", "0.5", "0.7", "0.9"), strict=True)]
    (panel,) = panels_of(row)
    assert (panel.values_down, panel.values_across) == (["pic"], ["0.3", "0.5", "0.7", "0.9"])
    assert passes_up_to(panel.rows[0]) is row[1] and passes_up_to(row[2:]) is None


def test_the_report_lists_gaps_causes_and_metrics(tmp_path: Path) -> None:
    metrics = dict.fromkeys(FLOORS, 0.0) | {"beta": 0.3}
    points = [
        constructed("passes", "0.3", default=True),
        constructed("degrades", "0.5", default=True, metrics=metrics, exceeded=("beta",)),
        constructed("fails", "0.9", cause="it diverged (value 3)"),
        constructed("fails", "1.1", cause="it diverged (value 4)"),
        constructed("not run", "1.3"),
    ]
    text = markdown(load_map(str(write(tmp_path))), {"low": REFERENCE}, points, [], "mpmcol 1; a cpu")
    for part in (
        "5 grid points: 1 pass, 1 degrade, 2 fail, 1 not run.",
        "The default method passes at 1 of 2 grid points. It does not pass at:",
        "* plain, transfer pic, cfl 0.5: height 0.3",
        "| pic | passes | β 0.3 | fails | fails | not run | 0.3 |",
        "| it diverged | 2 | plain: 2 | plain, transfer pic, cfl 0.9; plain, transfer pic, cfl 1.1 |",
        "| height | 1 | plain: 1 |",
        "| ζ runout (front_height) | 0.1 | 0.263 (0.15 +- 0.008) |",
    ):
        assert part in text
    assert "plain  5 grid points" in next(closing_lines(points))
    assert "passes at 1 of 1 grid points." in "\n".join(closing_lines(points[:1]))


@pytest.mark.slow
def test_a_small_map_from_end_to_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    path, out = write(tmp_path), tmp_path / "stability" / "map-tiny"

    done = invoke("stability", "--map", path, "--jobs", "1")
    assert done.exit_code == 0, done.output
    assert "5 grid points: 2 pass, 2 degrade, 1 fail" in done.output
    assert "The default method passes at 2 of 2 grid points." in done.output
    rows = list(csv.DictReader((out / "map.csv").read_text().splitlines()))
    assert [row["rating"] for row in rows] == ["passes", "passes", "fails", "degrades", "degrades"]
    assert rows[2]["cause"] and rows[2]["zeta.metric"] == "" and float(rows[4]["zeta.metric"]) > 0.5
    assert (rows[4]["grid.points_per_cell"], rows[0]["grid.points_per_cell"]) == ("1", "4")
    assert load_case(out / "runs" / rows[4]["folder"] / "case.toml").grid.points_per_cell == 1
    assert json.loads((out / "environment.json").read_text())["numba"]
    assert (out / "map.png").stat().st_size > 10_000
    before = {file: file.stat().st_mtime_ns for file in (out / "runs").rglob("*") if file.is_file()}
    again = invoke("stability", "--map", path, "--report-only", "--quiet")
    assert (again.exit_code, again.output) == (0, "")
    assert {file: file.stat().st_mtime_ns for file in (out / "runs").rglob("*") if file.is_file()} == before
    write(tmp_path, "[0.4, 0.5, 2]", "[0.4, 0.45, 2]")
    record = json.loads(invoke("stability", "--map", path, "--report-only", "--json").stdout)
    assert [row["rating"] for row in record["rows"]].count("not run") == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--map", "one", "two"], "--map requires at most one MAP and excludes --list"),
        (["--map", "--list"], "--map requires at most one MAP and excludes --list"),
        (["--jobs", "2"], "--jobs and --report-only require --map"),
        (["--report-only"], "--jobs and --report-only require --map"),
        (["--map", "--fresh", "--report-only"], "--report-only runs nothing, and --fresh repeats all runs"),
        (["--map", "defualt"], "defualt: no such map; did you mean 'default'"),
    ],
)
def test_arguments_that_do_not_fit_are_refused(
    arguments: list[str], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = invoke("stability", *arguments)
    assert result.exit_code == 2 and message in result.output
    assert list(tmp_path.iterdir()) == []


def test_a_report_without_any_run_is_refused(tmp_path: Path) -> None:
    arguments = ["stability", "--map", str(write(tmp_path)), "--report-only", "--out", str(tmp_path / "out")]
    result = invoke(*arguments)
    assert result.exit_code == 2 and "no run of the study has ended" in result.output
    assert not (tmp_path / "out").exists()
