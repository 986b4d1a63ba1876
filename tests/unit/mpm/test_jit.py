"""Rules for compiled code that the compiler does not check, and the disk cache."""

from __future__ import annotations

import ast
import compileall
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from mpmcol.mpm import jit

PACKAGE = Path(jit.__file__).parents[1]
KERNELS = sorted((PACKAGE / "mpm/kernels").glob("*.py"))
DECORATORS = {"device", "phase", "kernel", "driver"}


# -------------------------------------------------------------------------------------------- cache folder


@pytest.fixture
def copied_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    package = tmp_path / "mpmcol"
    shutil.copytree(PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(jit, "__file__", str(package / "mpm/jit.py"))
    return package


@pytest.mark.parametrize(
    "name",
    [
        "shape_functions/quadratic.py",
        "simd/access.py",
        "constitutive/mohr_coulomb.py",
        "kernels/stress_2d.py",
        "jit.py",
    ],
)
def test_editing_a_helper_changes_the_cache_folder(copied_package: Path, name: str) -> None:
    before = jit.source_digest()
    assert before == jit.source_digest()
    with (copied_package / "mpm" / name).open("a") as source:
        source.write("\n# edited\n")
    assert jit.source_digest() != before


def test_a_new_law_changes_the_cache_folder(copied_package: Path) -> None:
    before = jit.source_digest()
    (copied_package / "mpm/constitutive/another.py").write_text("STATE = ()\n")
    assert jit.source_digest() != before


def test_editing_other_files_keeps_the_cache_folder(copied_package: Path) -> None:
    before = jit.source_digest()
    (copied_package / "plotting/charts.py").write_text("")
    assert jit.source_digest() == before


def test_every_file_with_compiled_code_is_hashed() -> None:
    for path, tree in parsed(PACKAGE.rglob("*.py")):
        if path.name != "jit.py" and decorated(tree, DECORATORS):
            assert path.relative_to(PACKAGE).parts[0] in jit.COMPILED_SOURCES, path


# ------------------------------------------------------------------------------------------ disk cache

FACTORY = """
import sys
from mpmcol.mpm.jit import driver, phase, prange, variant

def make(number):
    @phase
    @variant(number)
    def fill(out):
        for k in prange(len(out)):
            out[k] = number

    @driver
    @variant(number)
    def run(out):
        fill(out)
        return out.sum()

    return run

import numpy as np
print([make(int(number))(np.zeros(10)) for number in sys.argv[1:]])
"""


@pytest.fixture
def factory(tmp_path: Path) -> Callable[..., str]:
    """Print the sums of functions of the factory for these numbers, in a new process."""
    (tmp_path / "factory.py").write_text(FACTORY)
    environment = os.environ | {"MPMCOL_CACHE_DIR": str(tmp_path), "PYTHONPATH": str(PACKAGE.parent)}

    def printed(*numbers: str) -> str:
        command = [sys.executable, "-B", "-c", "import factory", *numbers]
        child = subprocess.run(command, env=environment, cwd=tmp_path, capture_output=True, text=True, check=True)
        return child.stdout.strip()

    return printed


def test_functions_of_one_factory_are_not_confused(factory: Callable[..., str]) -> None:
    """Each is the first function compiled in its process; a third process then loads both."""
    assert [factory("1"), factory("2"), factory("1", "2")] == ["[10.0]", "[20.0]", "[10.0, 20.0]"]


def test_machine_code_of_a_process_that_read_source_serves_one_that_reads_bytecode(
    factory: Callable[..., str], tmp_path: Path
) -> None:
    factory("1")
    assert compileall.compile_file(tmp_path / "factory.py", quiet=1)
    factory("1")
    assert len(list(tmp_path.rglob("*.nbc"))) == 2  # the phase and the driver


LINKED = """
from mpmcol.mpm.jit import driver, phase, prange, subroutine

@subroutine
def twice(x):
    return 2.0 * x

@phase
def fill(out):
    for k in prange(len(out)):
        out[k] = twice(k)

@driver
def run(out):
    fill(out)

import numpy as np
by_python, compiled = np.zeros(4), np.zeros(4)
fill(by_python)
run(compiled)
print(by_python.sum(), compiled.sum(), twice.__name__, twice(1.5))
"""


def test_functions_that_kernels_call_run_as_python_code_if_called_from_python(tmp_path: Path) -> None:
    (tmp_path / "linked.py").write_text(LINKED)
    environment = os.environ | {"MPMCOL_CACHE_DIR": str(tmp_path), "PYTHONPATH": str(PACKAGE.parent)}
    child = subprocess.run([sys.executable, tmp_path / "linked.py"], env=environment, capture_output=True, text=True)
    assert child.stdout.split() == ["12.0", "12.0", "twice", "3.0"], child.stderr


APART = """
import sys
import numpy as np
from mpmcol.mpm.jit import argument_types, compile_for, driver, phase, prange

@phase
def fill(out):
    for k in prange(len(out)):
        out[k] = 1.0

@driver
def run(out):
    fill(out)

out = np.zeros(4)
compile_for({"fill": fill, "run": run}[sys.argv[1]], argument_types(out))
if sys.argv[2:]:
    run(out)
    print(out.sum())
"""


def test_a_loop_linked_with_a_phase_from_the_cache_starts_threads_when_it_is_loaded(tmp_path: Path) -> None:
    """Each step in a process of its own; without threads the last one would end without a message."""
    (tmp_path / "apart.py").write_text(APART)
    environment = os.environ | {"MPMCOL_CACHE_DIR": str(tmp_path), "PYTHONPATH": str(PACKAGE.parent)}
    for arguments, printed in ((("fill",), ""), (("run",), ""), (("run", "call"), "4.0")):
        command = [sys.executable, str(tmp_path / "apart.py"), *arguments]
        child = subprocess.run(command, env=environment, capture_output=True, text=True)
        assert (child.returncode, child.stdout.strip()) == (0, printed), child.stderr


HELPED = """
import sys
from mpmcol.mpm.jit import CACHE_FOLDER, driver
from mpmcol.mpm.constitutive.elementary import decay

def run(x):
    return 100.0 * decay(x)

for line in sys.argv[1:]:
    exec(line)
    print(round(driver(run)(0.0)), len(list(CACHE_FOLDER.rglob("*.nbc"))))
"""
DAMAGE = "(file,) = CACHE_FOLDER.rglob({!r}); file.write_bytes(file.read_bytes()[:{}])"


@pytest.fixture
def helped(tmp_path: Path) -> Callable[..., list[str]]:
    """Compile or load a kernel with a helper of a copy of the package in a new process, once after each of `lines`.

    Returns the value of the kernel and the number of files in the cache of each.
    """
    shutil.copytree(PACKAGE, tmp_path / "mpmcol", ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "helped.py").write_text(HELPED)

    def printed(*lines: str, cache: Path = tmp_path / "cache") -> list[str]:
        folders = {"MPMCOL_CACHE_DIR": cache, "TMPDIR": tmp_path, "PYTHONPATH": tmp_path}
        environment = os.environ | {name: str(folder) for name, folder in folders.items()}
        command = [sys.executable, str(tmp_path / "helped.py"), *lines]
        child = subprocess.run(command, env=environment, capture_output=True, text=True)
        assert child.returncode == 0, child.stderr
        return child.stdout.splitlines()

    return printed


def test_a_kernel_is_compiled_again_when_its_helper_in_another_file_is_edited(
    helped: Callable[..., list[str]], tmp_path: Path
) -> None:
    assert helped("") == helped("") == ["100 1"]
    source = tmp_path / "mpmcol/mpm/constitutive/elementary.py"
    source.write_text(
        source.read_text().replace("        value = value * value", "        value = value * value * 2.0 ** 0.0625")
    )
    assert helped("") == ["1532 1"]  # in another folder


def test_a_damaged_cache_is_compiled_again(helped: Callable[..., list[str]]) -> None:
    damages = [DAMAGE.format(kind, left) for kind, left in (("*.nbc", -100), ("*.nbi", 0), ("*.nbi", -10))]
    assert helped("", *damages) == ["100 1"] * 4


FULL = """
import os, errno, numba.core.caching as caching
save = caching.IndexDataCacheFile.save
def full(*arguments):
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
caching.IndexDataCacheFile.save = full
"""
GONE = "caching.IndexDataCacheFile.save = save; import shutil; shutil.rmtree(CACHE_FOLDER.parent)"


def test_kernels_are_compiled_without_a_writable_cache(helped: Callable[..., list[str]], tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    assert helped(FULL, GONE) == ["100 0", "100 1"]
    assert helped("", cache=tmp_path / "file") == ["100 1"]  # elsewhere
    assert not list(tmp_path.glob("mpmcol/**/*.nbi"))


def test_all_functions_compiled_by_factories_have_unique_names() -> None:
    found = 0
    for path, tree in parsed([*KERNELS, *(PACKAGE / "bench").rglob("*.py")]):
        inner = {
            function
            for outer in ast.walk(tree)
            if isinstance(outer, ast.FunctionDef)
            for function in decorated(ast.Module(outer.body, []), DECORATORS)
        }
        for function in inner:
            names = {decorator.func.id for decorator in function.decorator_list if isinstance(decorator, ast.Call)}
            assert "variant" in names, f"{path.name}: {function.name} needs @variant(...)"
        found += len(inner)
    assert found >= 12


# ------------------------------------------------------------------------------------------------- sources


def parsed(paths: Iterator[Path] | list[Path]) -> Iterator[tuple[Path, ast.Module]]:
    for path in paths:
        yield path, ast.parse(path.read_text(), str(path))


def decorated(tree: ast.AST, names: set[str]) -> list[ast.FunctionDef]:
    """Functions with one of these decorators, also nested ones."""
    return [
        node
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef)
        and any(isinstance(d, ast.Name) and d.id in names for d in node.decorator_list)
    ]


def attribute_stores(tree: ast.AST) -> list[str]:
    """Stores through an attribute, `name.attr[...] = value` or `name.attr = value`, as text.

    A store through a NamedTuple inside a parallel loop is silently lost; assign the array to a name first.
    """
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Assign):
            targets = node.targets
        elif isinstance(node, ast.AugAssign | ast.AnnAssign):
            targets = [node.target]
        else:
            continue
        for target in (part for each in targets for part in ast.walk(each)):
            stored = target.value if isinstance(target, ast.Subscript) else target
            writes = isinstance(target, ast.Subscript | ast.Attribute) and isinstance(target.ctx, ast.Store)
            if writes and isinstance(stored, ast.Attribute):
                found.append(ast.unparse(target))
    return found


def imports_numba(tree: ast.Module) -> bool:
    """Whether a module imports Numba at the top level; functions may import it to read its version."""
    names = [alias.name for node in tree.body if isinstance(node, ast.Import) for alias in node.names]
    names += [node.module or "" for node in tree.body if isinstance(node, ast.ImportFrom)]
    return any(name.split(".")[0] == "numba" for name in names)


def test_kernels_never_store_through_an_attribute() -> None:
    assert len(KERNELS) > 4
    for path, tree in parsed(KERNELS):
        assert attribute_stores(tree) == [], path


@pytest.mark.parametrize(
    "line",
    [
        "grid.nodes[o] = 1.0",
        "grid.nodes[o : o + 8] += 1.0",
        "a, grid.nodes[o] = 1.0, 2.0",
        "tiles.start[0]: int = 3",
    ],
)
def test_a_planted_store_is_found(line: str) -> None:
    assert attribute_stores(ast.parse(f"def f(grid, tiles, o):\n    {line}\n")) != []


def test_a_store_to_a_plain_name_is_allowed() -> None:
    source = "def f(grid, o):\n    nodes = grid.nodes\n    nodes[o + grid.n_x] = grid.h\n    nodes[o] += 1.0\n"
    assert attribute_stores(ast.parse(source)) == []


def test_only_jit_threads_simd_and_clock_import_numba() -> None:
    assert imports_numba(ast.parse("from numba.core import types")) and imports_numba(ast.parse("import numba"))
    users = {path.relative_to(PACKAGE) for path, tree in parsed(PACKAGE.rglob("*.py")) if imports_numba(tree)}
    simd = {f"mpm/simd/{name}.py" for name in ("access", "compiled", "registers", "vec8")}
    assert {user.as_posix() for user in users} == {"bench/clock.py", "mpm/jit.py", "mpm/threads.py"} | simd


def test_docstrings_of_kernels_state_what_they_read_and_write_and_their_equations() -> None:
    functions = [
        (path, function) for path, tree in parsed(KERNELS) for function in decorated(tree, DECORATORS - {"device"})
    ]
    assert len(functions) >= 5
    for path, function in functions:
        doc = ast.get_docstring(function) or ""
        for word in ("Reads:", "Writes:", "Eq."):
            assert word in doc, f"{path.name}: {function.name} lacks {word}"


def test_only_cache_folders_that_are_old_are_removed(tmp_path: Path) -> None:
    """The folder may hold other things of the user, such as a clone of this repository."""
    names = ("0" * 16, "a1" * 8, "f" * 16, ".git", "tests", "A" * 16, "1" * 15)
    for name in names:
        (tmp_path / name / "content").mkdir(parents=True)
        os.utime(tmp_path / name, (0.0, 0.0))
    (tmp_path / ("2" * 16)).mkdir()
    jit._remove_stale(tmp_path, tmp_path / ("f" * 16))
    assert {path.name for path in tmp_path.iterdir()} == {*names[2:], "2" * 16}
    jit._remove_stale(tmp_path / "missing", tmp_path)
