"""Fixtures for all tests."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.support.cli import invoke, set_options
from tests.support.runs import TINY


@pytest.fixture
def in_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Change to an empty folder, which relative paths then refer to."""
    monkeypatch.chdir(tmp_path)


@pytest.fixture(scope="session")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a finished tiny run; copy it before changing it."""
    folder = tmp_path_factory.mktemp("runs") / "tiny"
    result = invoke("run", "coarse-channel", *set_options(TINY), "--out", folder)
    assert result.exit_code == 0, result.output
    return folder
