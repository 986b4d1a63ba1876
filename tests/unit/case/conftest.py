"""Fixtures for tests of case files."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.support.case_files import Write


@pytest.fixture
def write(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Write:
    monkeypatch.chdir(tmp_path)

    def write_case(text: str | bytes, name: str = "my.toml") -> Path:
        content = text if isinstance(text, bytes) else text.encode()
        Path(name).write_bytes(content)
        return Path(name)

    return write_case
