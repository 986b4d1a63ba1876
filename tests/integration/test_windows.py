"""Commands in an environment that lacks what Windows lacks; `tests/support/windows_like.py` describes it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path, PureWindowsPath
from typing import Any

import pytest

from tests.support.runs import TINY, assert_equal_runs

ROOT = Path(__file__).parents[2]
# Read at the start of every process, also of the runs of a sweep.
SITE = "from tests.support.windows_like import install\ninstall()\n"
COMMANDS = f"""
import json, sys
from tests.support.cli import invoke, set_options

tiny = set_options({TINY})
done = {{}}
for name, *arguments in [
    ("run", "coarse-channel", *tiny, "--out", "run"),
    ("plot", "run"), ("measure", "run", "--json"), ("verify", "run"), ("status", "run"), ("check", "."),
    ("report", "run"),
    ("sweep", "coarse-channel", "--aspect", "0.8,1.2", *tiny, "--jobs", "1", "--out", "sweep"),
    ("verify", "sweep"), ("report", "sweep"),
]:
    result = invoke(name, *arguments)
    done[f"{{name}} {{arguments[0]}}"] = result.exit_code, result.output + str(result.exception or "")
json.dump(done, open("done.json", "w", encoding="utf-8"))
"""


@pytest.fixture(scope="module")
def environment(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Variables of an environment that resembles Windows."""
    site = tmp_path_factory.mktemp("site")
    (site / "sitecustomize.py").write_text(SITE)
    return {
        **os.environ,
        "PYTHONPATH": f"{site}{os.pathsep}{ROOT}",
        "PYTHONIOENCODING": "cp1252",
        "PYTHONWARNDEFAULTENCODING": "1",
    }


def executed(program: str, folder: Path, environment: dict[str, str]) -> str:
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=folder, env=environment, capture_output=True, encoding="cp1252"
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def done(environment: dict[str, str], tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    """The folder in which the commands were given, and the exit code and the output of each."""
    folder = tmp_path_factory.mktemp("windows")
    executed(COMMANDS, folder, environment)
    return folder, json.loads((folder / "done.json").read_text("utf-8"))


def test_all_commands_work(done: tuple[Path, dict[str, Any]]) -> None:
    folder, commands = done
    check = commands.pop("check .")
    assert {name: output for name, (code, output) in commands.items() if code} == {}
    assert check[0] == 2 and "is a folder; expected a case file" in check[1]
    assert (folder / "run/front.png").is_file() and (folder / "sweep/zeta.png").is_file()
    for name in ("run", "sweep"):
        assert "</html>" in (folder / name / "report.html").read_text("utf-8")
    assert "\x1b" not in "".join(output for _, output in commands.values())


def test_all_files_have_names_that_windows_allows(done: tuple[Path, dict[str, Any]]) -> None:
    folder, _ = done
    names = {path.name for path in folder.rglob("*")}
    refused = {name for name in names if set(name) & set('<>:"|?*\\') or name.endswith((".", " "))}
    reserved = {name for name in names if PureWindowsPath(name).is_reserved()}
    assert len(names) > 20 and not refused | reserved


def test_a_run_has_the_bits_of_one_in_any_other_system(done: tuple[Path, dict[str, Any]], finished: Path) -> None:
    """No line end is changed in any file, for example."""
    folder, _ = done
    assert_equal_runs(finished, folder / "run")
    for name in ("run.vtkhdf.series", "snapshots/000001.vtkhdf"):
        assert (folder / "run" / name).read_bytes() == (finished / name).read_bytes()


@pytest.mark.slow
def test_a_rendering_works(finished: Path, tmp_path: Path, environment: dict[str, str]) -> None:
    program = f"""
from tests.support.cli import invoke
result = invoke("render", {str(finished)!r}, "--size", "640x360", "--out", "image.png")
print(result.exit_code, result.output)
"""
    assert executed(program, tmp_path, environment).startswith("0 ")
    assert (tmp_path / "image.png").is_file()


@pytest.mark.parametrize(
    ("line", "error"),
    [
        ("import fcntl", "ModuleNotFoundError"),
        ("import os; os.getuid", "AttributeError"),
        ("import signal; signal.SIGHUP", "AttributeError"),
        ("import os; os.open('.', os.O_RDONLY)", "PermissionError"),
        ("import os; file = open('a', 'wb'); os.replace('b', 'a')", "PermissionError"),
        ("from pathlib import Path; Path('b').read_text()", "EncodingWarning"),
    ],
)
def test_the_environment_lacks_what_windows_lacks(
    line: str, error: str, tmp_path: Path, environment: dict[str, str]
) -> None:
    """Otherwise the tests above could not fail."""
    (tmp_path / "b").touch()
    program = f"""
try:
    exec({line!r}, {{"__name__": "mpmcol.module"}})
except (ImportError, AttributeError, PermissionError, EncodingWarning) as found:
    print(type(found).__name__)
"""
    assert executed(program, tmp_path, environment).strip() == error
