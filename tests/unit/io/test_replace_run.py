"""A finished run replaces the run in another folder."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from mpmcol.io.names import RESULT_FILE
from mpmcol.io.results import Results
from mpmcol.io.run_folder import replace_run
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
