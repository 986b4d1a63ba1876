"""A finished run replaces the run in another folder."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from mpmcol.case import load_case
from mpmcol.errors import OutputError, UsageError
from mpmcol.io.names import RESULT_FILE
from mpmcol.io.results import Results, read_history
from mpmcol.io.run_folder import prepare_folder, replace_run
from tests.support.cli import invoke


@pytest.mark.parametrize("can_link", [True, False])
def test_the_folder_holds_the_run(
    finished: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, can_link: bool
) -> None:
    folder = tmp_path / "run"
    (folder / "snapshots").mkdir(parents=True)
    (folder / "snapshots" / "999999.vtkhdf").write_text("of an earlier run")
    if not can_link:
        monkeypatch.setattr(os, "link", refuse)
    replace_run(finished, folder)
    assert invoke("verify", str(folder)).exit_code == 0
    assert Results(folder).summary == Results(finished).summary
    names = [[path.name for path in Results(one).snapshots] for one in (folder, finished)]
    assert names[0] == names[1]
    assert (folder / RESULT_FILE).samefile(finished / RESULT_FILE) == can_link


def refuse(source: Path, target: Path) -> None:
    raise OSError("no links on this disk")


def test_a_temporary_file_of_a_killed_command_does_not_count_as_a_foreign_file(tmp_path: Path) -> None:
    (tmp_path / ".case.toml.77-1.tmp").touch()
    prepare_folder(tmp_path, load_case("coarse-channel"), fresh=False, notify=print)
    (tmp_path / "notes.txt").touch()
    with pytest.raises(UsageError, match="is not empty and holds no run"):
        prepare_folder(tmp_path, load_case("coarse-channel"), fresh=True, notify=print)


def test_an_empty_history_is_damaged(tmp_path: Path) -> None:
    (tmp_path / "history.csv").touch()
    with pytest.raises(OutputError, match="missing or damaged"):
        read_history(tmp_path / "history.csv")
