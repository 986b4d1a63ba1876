"""The README's commands and its Python, run as they stand; runs are only made coarse and short."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from mpmcol.case import load_case
from mpmcol.cli import main
from mpmcol.mpm.particles import Points

README = (Path(__file__).parents[2] / "README.md").read_text()
SHORTER = ["--set", "grid.spacing=0.012", "--set", "stages.collapse.max_time_factor=0.5"]


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", README, flags=re.DOTALL)


def test_commands(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    lines = [line for block in blocks("sh") for line in block.splitlines() if line.startswith("mpmcol ")]
    assert len(lines) >= 10
    for line in lines:
        words = shlex.split(line, comments=True)[1:]
        target = words[words.index(">") + 1] if ">" in words else None
        words = words[: words.index(">")] if target else words
        if words[0] == "run":
            words += SHORTER  # with --set, the folder's name would carry a hash
            words += [] if "--out" in words else ["--out", f"runs/{Path(words[1]).stem}"]
        if words[0] == "sweep" and not {"--dry-run", "--engine"} & set(words):
            words = [word.replace("0.5:7", "0.5:1") for word in words] + SHORTER
            words += [] if "--out" in words else ["--out", "sweeps/lube-cylinder"]
        if words[0] == "paper":
            words = ["paper", "fig9", "--quick"]
        if words[0] == "bench":
            words += ["--quick", "--model", "plane"]
        result = CliRunner().invoke(main, words)
        assert result.exit_code == 0, f"{line}\n{result.output}"
        if target:
            Path(target).write_text(result.stdout)


def test_python(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    (code,) = blocks("python")
    scope: dict = {}
    exec(code.replace('"grid.spacing=0.01"', '"grid.spacing=0.015", "stages.collapse.max_time_factor=0.5"'), scope)
    assert "front_max" in capsys.readouterr().out
    assert scope["positions"].shape == (scope["results"].summary["column_points"], 2)


def test_case_file(tmp_path: Path) -> None:
    (text,) = blocks("toml")
    (tmp_path / "case.toml").write_text(text)
    assert load_case(tmp_path / "case.toml").grid.spacing == 0.002


def test_notation_names_exist() -> None:
    points = Points(1)
    for name in re.findall(r"`points\.(\w+)`", README):
        assert isinstance(getattr(points, name), np.ndarray), name
