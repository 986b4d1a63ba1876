"""`mpmcol run --accuracy` ends with a statement, in the same words and numbers in text, JSON, file and report."""

from __future__ import annotations

import html
import json
from pathlib import Path

import pytest

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
    assert lines[first + 4].startswith("confidence 90%; grid: error bound of")
    assert "error of the grid: " not in printed[0].stdout + page
    assert invoke("verify", folder).exit_code == 0


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
