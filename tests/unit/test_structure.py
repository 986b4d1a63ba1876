"""The structure of the repository: imports between modules and tests, and a README in every package."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "mpmcol"
LOOSE_MODULES = {"__init__", "__main__", "errors", "provenance", "units"}


def module_name(path: Path) -> str:
    """The dotted name of a module."""
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def nodes(tree: ast.AST) -> Iterator[ast.AST]:
    """The nodes of a syntax tree except those under `if TYPE_CHECKING`."""
    for node in ast.iter_child_nodes(tree):
        if not (isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test)):
            yield node
            yield from nodes(node)


def imported_names(path: Path) -> Iterator[str]:
    """Dotted names that a module imports, also in functions; not those for type checking only."""
    for node in nodes(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def imports(folder: Path) -> dict[str, set[str]]:
    """The modules in a folder, and those of them that each one imports."""
    modules = {module_name(path): path for path in folder.rglob("*.py")}
    found = {}
    for module, path in modules.items():
        names = {name if name in modules else name.rpartition(".")[0] for name in imported_names(path)}
        found[module] = names & set(modules) - {module}
    return found


def test_modules_import_each_other_in_no_cycle() -> None:
    found = imports(PACKAGE)
    assert "mpmcol.mpm.solver" in found["mpmcol.setup.model"]
    try:
        TopologicalSorter(found).prepare()
    except CycleError as cycle:
        pytest.fail(" -> ".join(cycle.args[1]))


def test_no_test_imports_another_test() -> None:
    found = imports(ROOT / "tests")
    assert "tests.support.cli" in found["tests.integration.test_readme"]
    tests = {module for module in found if module.rpartition(".")[2].startswith("test_")}
    assert {module: names & tests for module, names in found.items() if names & tests} == {}


def test_few_modules_are_in_no_package() -> None:
    assert {path.stem for path in PACKAGE.glob("*.py")} == LOOSE_MODULES


def test_every_package_has_a_readme() -> None:
    packages = {path.parent for path in PACKAGE.glob("*/__init__.py")} | {PACKAGE, ROOT / "cases", ROOT / "tests"}
    missing = {path.relative_to(ROOT).as_posix() for path in packages if not (path / "README.md").is_file()}
    assert not missing
