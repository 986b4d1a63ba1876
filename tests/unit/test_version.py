"""The version of the code knows every source that decides a number."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

import mpmcol
from mpmcol import version

PACKAGE = Path(mpmcol.__file__).parent
# used by a simulation, but without a say in its numbers: words of the case file, whose values stand in every resolved
# case, messages, and files
HARMLESS = {
    "case", "units.py", "errors.py", "faults.py", "files.py", "version.py", "__init__.py", "memory.py", "stop.py",
    "checkpoint.py", "course.py", "digests.py", "restart.py",
}  # fmt: skip


def entry(module: str) -> str:
    """The file or folder of the package that `mpmcol.x.y` is in."""
    name = module.split(".")[1] if "." in module else "__init__"
    return name if (PACKAGE / name).is_dir() else f"{name}.py"


def imported(path: Path) -> set[str]:
    names = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "mpmcol":
            names |= {f"{node.module}.{alias.name}" if node.module == "mpmcol" else node.module for alias in node.names}
    return {entry(name) for name in names if entry(name) != "__version__.py"}


def test_all_that_a_simulation_uses_counts() -> None:
    reached, waiting = set(), {"simulation.py"}
    while waiting:
        name = waiting.pop()
        reached.add(name)
        path = PACKAGE / name
        files = path.rglob("*.py") if path.is_dir() else [path]
        waiting |= {other for file in files for other in imported(file)} - reached
    assert reached - HARMLESS == set(version.DECIDING)


@pytest.fixture
def copied(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name in version.DECIDING:
        (tmp_path / name).mkdir() if (PACKAGE / name).is_dir() else (tmp_path / name).touch()
    (tmp_path / "laws" / "own.py").write_text("a = 1")
    monkeypatch.setattr(version, "__file__", str(tmp_path / "version.py"))
    return tmp_path


def test_an_edit_changes_it(copied: Path) -> None:
    before = version.code_version.__wrapped__()
    assert before == version.code_version.__wrapped__()
    (copied / "laws" / "own.py").write_text("a = 2")
    assert version.code_version.__wrapped__() != before


def test_a_new_name_changes_it(copied: Path) -> None:
    before = version.code_version.__wrapped__()
    (copied / "laws" / "own.py").rename(copied / "laws" / "other.py")
    assert version.code_version.__wrapped__() != before


def test_it_begins_with_the_version() -> None:
    assert version.code_version().startswith(f"{mpmcol.__version__}+")
