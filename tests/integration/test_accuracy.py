"""`mpmcol run --accuracy` ends with a statement, in the same words and numbers in text, JSON, file and report."""

from __future__ import annotations

import html
import json
from pathlib import Path
from typing import Any

import pytest

import mpmcol
from mpmcol.studies.pareto.recommend import recommend
from tests.support.cli import invoke

COMMAND = ("run", "cylinder", "--accuracy", "20%", "--set", "stages.collapse.max_time_factor=4", "--threads", 1)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A finished run with its statement."""
    folder = tmp_path_factory.mktemp("accuracy") / "run"
    assert invoke(*COMMAND, "--out", folder, "--quiet").exit_code == 0
    return folder


def test_the_statement_is_the_same_in_all_places(folder: Path) -> None:
    """The command is repeated on the finished run."""
    stored = json.loads((folder / "accuracy.json").read_text())
    printed = [invoke(*COMMAND, "--out", folder) for _ in range(2)]
    assert printed[0].exit_code == 0 and printed[0].stdout == printed[1].stdout
    assert json.loads(invoke(*COMMAND, "--out", folder, "--json").stdout)["accuracy"] == stored
    lines = printed[0].stdout.splitlines()
    first = next(number for number, line in enumerate(lines) if "; finer grids: " in line)
    report = invoke("report", folder)
    assert report.exit_code == 0, report.output
    page = html.unescape(Path(report.stdout.strip()).read_text())
    for line in lines[first : first + 5]:
        assert line.strip()[1:] in page
    assert lines[first + 4].startswith("confidence 90%; grid: errors of")
    assert "error of the grid: " not in printed[0].stdout + page
    assert invoke("verify", folder).exit_code == 0


def test_corrected_values_need_a_coarser_grid(tmp_path: Path) -> None:
    """Its error, which the study knows, is larger than the accuracy, and what finer grids would give is as narrow."""
    command = (*COMMAND[:3], "10%", *COMMAND[4:], "--corrected", "--out", tmp_path / "run")
    done = invoke(*command)
    assert done.exit_code == 0 and "cheapest within 10%, corrected for the error of the grid: " in done.stderr
    record = json.loads((tmp_path / "run" / "accuracy.json").read_text())
    assert record["corrected"] and record["cells"] < recommend("cylinder", [], 0.1).cells
    for name in ("zeta", "beta"):
        low, high = (record[name]["finer_grids"][end] for end in ("low", "high"))
        assert (high - low) / (high + low) <= 0.1
        assert f", corrected {0.5 * (low + high):.3f}, error of this one " in done.stdout
    assert record["zeta"]["value"] < record["zeta"]["finer_grids"]["low"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("run", "cylinder", "--corrected"), "--corrected requires --accuracy"),
        (("sweep", "cylinder", "--aspect", "1,2", "--corrected"), "--corrected requires --accuracy"),
        (("run", "cylinder", "--accuracy", "10%", "--corrected", "--certify"), "--certify that of several runs"),
    ],
)
def test_correction_and_other_options(options: tuple[str, ...], message: str) -> None:
    refused = invoke(*options)
    assert refused.exit_code == 2 and message in refused.stderr


def test_a_sweep_has_the_intervals_of_finer_grids(tmp_path: Path) -> None:
    """In its table, chart and fitted exponents; they are those of the statements of its runs."""
    notes: list[str] = []
    given: dict[str, Any] = {"aspect": "2.9,5", "accuracy": 0.2, "corrected": True, "out": tmp_path / "sweep"}
    found = mpmcol.sweep("channel", **given, notify=notes.append)
    assert "within 20%, corrected for the error of the grid" in notes[0]
    for row in found.rows:
        statement = json.loads((found.folder / row["folder"] / "accuracy.json").read_text())
        for name in ("zeta", "beta"):
            low, high = (statement[name]["finer_grids"][end] for end in ("low", "high"))
            assert row[f"{name}.finer_grids.low"] == low < row[f"{name}.finer_grids"] < high
    assert {"zeta.finer_grids", "beta.finer_grids"} <= {slope.quantity for slope in found.slopes}
    assert mpmcol.sweep("channel", **given, notify=notes.append).rows == found.rows
    page = Path(invoke("report", found.folder).stdout.strip()).read_text()
    assert "Runout on finer grids: mean difference" in page and page.count("on finer grids</th>") == 2


def test_finer_grids_stand_in_the_table_that_is_printed(tmp_path: Path) -> None:
    command = ("sweep", "channel", "--aspect", "3", "--out", tmp_path / "sweep")
    printed = invoke(*command, "--accuracy", "20%", "--corrected").stdout.splitlines()
    heading, row = (line.split() for line in printed[:2])
    assert " ".join(heading) == "zeta: max connected height finer grid law beta finer grid law time"
    height, finer, law, beta, finer_beta = (float(text) for text in row[3:8])
    assert height < finer < 1.3 * height and law == 4.576 and beta < finer_beta


def test_a_damaged_statement_is_reported_and_written_again(folder: Path) -> None:
    (folder / "accuracy.json").write_text("{")
    refused = invoke("report", folder, folder.parent)
    alone = invoke("report", folder)
    assert refused.exit_code != 0 and alone.exit_code != 0 and "accuracy.json is damaged" in alone.stderr
    assert invoke(*COMMAND, "--out", folder, "--quiet").exit_code == 0
    assert json.loads((folder / "accuracy.json").read_text())["requested"] == 0.2


def test_a_run_without_an_accuracy_has_the_line_on_the_grid(finished: Path) -> None:
    again = invoke("run", finished / "case.resolved.toml", "--out", finished)
    assert again.exit_code == 0 and "error of the grid: " in again.stdout and "confidence" not in again.stdout
    assert not (finished / "accuracy.json").exists()
