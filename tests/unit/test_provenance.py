"""The version of the code covers every source that affects numbers."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

import mpmcol
from mpmcol import provenance

PACKAGE = Path(mpmcol.__file__).parent
# used by a simulation, but not numerical: keys of the case file, whose values every resolved case holds, and texts
NOT_NUMERICAL = {"case", "errors.py", "provenance.py", "units.py", "__init__.py"}


def top_level(module: str) -> str:
    """The file or folder of the package that `mpmcol.x.y` is in."""
    name = module.split(".")[1] if "." in module else "__init__"
    return name if (PACKAGE / name).is_dir() else f"{name}.py"


def imported(path: Path) -> set[str]:
    names = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "mpmcol":
            names |= {f"{node.module}.{alias.name}" if node.module == "mpmcol" else node.module for alias in node.names}
    return {top_level(name) for name in names if top_level(name) != "__version__.py"}


def test_all_that_a_simulation_uses_counts() -> None:
    reached, waiting = set(), {"simulation"}
    while waiting:
        name = waiting.pop()
        reached.add(name)
        path = PACKAGE / name
        files = path.rglob("*.py") if path.is_dir() else [path]
        waiting |= {other for file in files for other in imported(file)} - reached
    assert reached - NOT_NUMERICAL == set(provenance.NUMERICAL)


@pytest.fixture
def copied(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name in provenance.NUMERICAL:
        (tmp_path / name).mkdir()
    (tmp_path / "mpm/own.py").write_text("a = 1")
    monkeypatch.setattr(provenance, "__file__", str(tmp_path / "provenance.py"))
    return tmp_path


def test_an_edit_changes_it(copied: Path) -> None:
    before = provenance.code_version.__wrapped__()
    assert before == provenance.code_version.__wrapped__()
    (copied / "mpm/own.py").write_text("a = 2")
    assert provenance.code_version.__wrapped__() != before


def test_a_new_name_changes_it(copied: Path) -> None:
    before = provenance.code_version.__wrapped__()
    (copied / "mpm/own.py").rename(copied / "mpm/other.py")
    assert provenance.code_version.__wrapped__() != before


def test_it_begins_with_the_version() -> None:
    assert provenance.code_version().startswith(f"{mpmcol.__version__}+")
