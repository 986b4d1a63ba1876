"""`measure` and `plot` on results of stopped, failed, unfinished and damaged runs."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from mpmcol.case import Case, load_case, resolved_toml
from mpmcol.io.results import HISTORY
from mpmcol.io.run_folder import write_history, write_result
from mpmcol.io.snapshot import Snapshot, write_snapshot
from mpmcol.plotting import run_charts
from tests.support.cli import csv_row, invoke

TIMES = (0.0, 0.1, 0.2, 0.3)
SIZE = 0.0025

Profiles = list[tuple[float, bool]]


def column(case: Case) -> np.ndarray:
    sides = (np.arange(SIZE / 2, side, SIZE) for side in (case.geometry.r_i, case.geometry.h_i))
    x, y = np.meshgrid(*sides)
    return np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Results of a finished run, at rest, in which the column becomes 2.5 times as long."""
    case = load_case("coarse-channel", [f"grid.spacing={2 * SIZE}"])
    released = column(case)
    for i, time in enumerate(TIMES):
        spread = 1 + 5 * time
        moved = released * (spread, 1 / spread, 1)
        arrays = {
            "position": moved,
            "displacement": moved - released,
            "mass": np.full(len(moved), case.material.density * SIZE**2),
            "material": np.zeros(len(moved), np.uint8),
            "id": np.arange(len(moved), dtype=np.int32),
        }
        write_snapshot(tmp_path, i, Snapshot(time, i, "rest" if time == TIMES[-1] else "collapse", arrays), {})
    (tmp_path / "case.resolved.toml").write_text(resolved_toml(case))
    ends = np.minimum(np.linspace(0.0, 0.4, 41), 0.3)
    rows = [{"stage": "collapse", "time": 0.01 * i, "front_height": 0.1 * (1 + 5 * t)} for i, t in enumerate(ends)]
    write_history(tmp_path, [dict.fromkeys(HISTORY, 0.0) | row for row in rows])
    write_result(tmp_path, {"schema": 1, "status": "done", "at_rest": True})
    return tmp_path


@pytest.fixture
def profiles(monkeypatch: pytest.MonkeyPatch) -> Profiles:
    """Arguments of the chart of profiles: the time of the last one, and whether it is at rest."""
    drawn: Profiles = []
    draw: Callable[..., list[Path]] = run_charts.profile_chart

    def spy(
        path: Path, shape: object, deposits: list, experiment: object, *, at_rest: bool, **options: object
    ) -> list[Path]:
        drawn.append((deposits[-1][0], at_rest))
        return draw(path, shape, deposits, experiment, at_rest=at_rest, **options)

    monkeypatch.setattr(run_charts, "profile_chart", spy)
    return drawn


ENDINGS = [
    ({"status": "done", "at_rest": True}, "done, at rest"),
    ({"status": "done", "at_rest": False}, "done, not at rest"),
    ({"status": "stopped", "at_rest": False}, "stopped"),
    ({"status": "failed", "at_rest": False}, "failed"),
    (None, "unfinished (no result.json)"),
]


def end(folder: Path, result: dict | None) -> None:
    (folder / "result.json").unlink()
    if result:
        write_result(folder, {"schema": 1, **result})


@pytest.mark.parametrize(("result", "text"), ENDINGS)
def test_measure_begins_with_the_status_of_the_run(folder: Path, result: dict | None, text: str):
    end(folder, result)
    measured = invoke("measure", folder)
    assert measured.exit_code == 0
    assert measured.stdout.splitlines()[0] == f"status: {text}"
    is_at_rest = text == "done, at rest"
    assert ("front stops at" in measured.stdout) == is_at_rest
    assert ("not the final deposit" in measured.stdout) == (not is_at_rest)
    assert ("\nnot a deposit at rest" in measured.stdout) == (not is_at_rest)


@pytest.mark.parametrize(("result", "text"), ENDINGS)
def test_json_and_csv_contain_the_status_of_the_run(folder: Path, result: dict | None, text: str):
    end(folder, result)
    record = json.loads(invoke("measure", folder, "--json").stdout)
    row = csv_row(invoke("measure", folder, "--csv").stdout)
    status, is_at_rest = text.split()[0].strip(","), text == "done, at rest"
    assert [record[name] for name in ("status", "at_rest", "stage", "time")] == [status, is_at_rest, "rest", 0.3]
    assert [row[name] for name in ("status", "at_rest", "stage", "time")] == [
        status,
        str(is_at_rest).lower(),
        "rest",
        "0.3",
    ]
    assert (record["stop_time"] is not None) == bool(row["stop_time"]) == is_at_rest


def test_an_earlier_snapshot_is_not_a_deposit(folder: Path):
    text = invoke("measure", folder, "--snapshot", 1).stdout
    assert "t = 0.1 s, not the final deposit" in text and "not a deposit at rest" in text
    assert "front stops at" not in text
    assert "t = 0.3 s, the final deposit" in invoke("measure", folder, "--snapshot", 3).stdout


@pytest.mark.parametrize(
    ("content", "wrong"),
    [(None, "is missing"), ("", "is damaged"), ("stage,time\n", "is damaged"), ("cut", "is damaged")],
)
def test_measure_works_without_a_history(folder: Path, content: str | None, wrong: str):
    history = folder / "history.csv"
    whole = history.read_text()
    history.unlink()
    if content is not None:
        history.write_text(whole[:-40] if content == "cut" else content)
    measured = invoke("measure", folder)
    assert measured.exit_code == 0 and "front stops at" not in measured.stdout
    assert measured.stderr.startswith(f"note: {history} {wrong}") and measured.stderr.count("\n") == 1


def damage(folder: Path, *numbers: int) -> None:
    for number in numbers:
        (folder / f"snapshots/{number:06d}.vtkhdf").write_bytes(b"damaged")


def test_plot_skips_a_damaged_snapshot(folder: Path, profiles: Profiles):
    damage(folder, 1)
    plotted = invoke("plot", folder)
    assert plotted.exit_code == 0 and len(plotted.stdout.split()) == 3
    assert "000001.vtkhdf is damaged" in plotted.stderr and plotted.stderr.count("note:") == 1
    assert profiles == [(0.3, True)]


def test_without_the_last_snapshot_no_profile_is_the_deposit(folder: Path, profiles: Profiles):
    damage(folder, 3)
    assert invoke("plot", folder).exit_code == 0
    assert profiles == [(0.2, False)]


def test_plot_requires_a_valid_snapshot(folder: Path):
    damage(folder, 0, 1, 2, 3)
    plotted = invoke("plot", folder)
    assert plotted.exit_code == 5 and "all 4 snapshots are damaged" in plotted.stderr


@pytest.mark.parametrize(
    ("result", "text"), [*ENDINGS[:2], *(pytest.param(*ending, marks=pytest.mark.slow) for ending in ENDINGS[2:])]
)
def test_only_a_column_at_rest_is_called_the_deposit(folder: Path, profiles: Profiles, result: dict | None, text: str):
    end(folder, result)
    assert invoke("plot", folder, "--times", "0.1").exit_code == 0
    assert profiles == [(0.3, text == "done, at rest")]  # the last state is always included


@pytest.mark.parametrize("time", ["0.45", "-0.2", "nan", "inf"])
def test_plot_refuses_times_outside_the_run(folder: Path, time: str):
    plotted = invoke("plot", folder, "--times", f"0.1,{time}")
    assert plotted.exit_code == 2
    assert "from 0 s to 0.3 s" in plotted.stderr


def test_plot_writes_into_another_folder(folder: Path, tmp_path_factory: pytest.TempPathFactory):
    out = tmp_path_factory.mktemp("charts") / "new"
    before = set(folder.iterdir())
    assert invoke("plot", folder, "--out", out).exit_code == 0
    assert {path.name for path in out.iterdir()} == {"profile.png", "front.png", "energy.png"}
    assert set(folder.iterdir()) == before


READERS = ["measure", "plot", "render", "report", "status", "verify"]


@pytest.mark.parametrize("command", READERS)
def test_a_case_file_is_not_a_results_folder(tmp_path: Path, command: str) -> None:
    case = tmp_path / "my.toml"
    case.write_text(invoke("init", "quickstart").stdout)
    refused = invoke(command, case)
    assert refused.exit_code == 5 and "my.toml is a file; expected the results folder of a run" in refused.stderr
    missing = invoke(command, tmp_path / "run")
    assert missing.exit_code == 5 and "run: no such folder; expected the results folder of a run" in missing.stderr


@pytest.mark.parametrize("command", READERS)
def test_the_folder_that_may_be_meant_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: str) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "runs/quickstart").mkdir(parents=True)
    for given in ("quickstart", "runs/quikstart"):
        refused = invoke(command, given)
        assert refused.exit_code == 5 and f"Did you mean {Path('runs/quickstart')}?" in refused.stderr
    assert "Did you mean" not in invoke(command, "elsewhere/other").stderr
