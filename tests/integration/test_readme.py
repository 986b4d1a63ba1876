"""The documents: every command and every program in them is executed, every link leads somewhere.

tests/README.md describes how code blocks are marked.
"""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path

import click
import numpy as np
import pytest

from mpmcol.case import load_case
from mpmcol.cli import main
from mpmcol.mpm.particles import Points
from tests.support.cli import invoke
from tests.support.documents import DOCUMENTS, FOLDERS, ROOT, Block, anchors, blocks, links

MARKS = ((), ("slow",), ("not-run",))
COARSE = {"grid.spacing": "0.012", "stages.collapse.max_time_factor": "0.5"}
QUICKER = {  # command of a document -> what is executed instead
    "mpmcol paper all --quick": "mpmcol paper fig9 --quick",
    "mpmcol bench": "mpmcol bench --quick --model plane",
}
SHELL = 'mpmcol() {{ "{python}" -m mpmcol "$@"; }}; python() {{ "{python}" "$@"; }}; set -euo pipefail; {command}'

documents = pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))


@pytest.fixture(scope="module")
def workplace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the repository in which commands run; all documents share it."""
    copy = tmp_path_factory.mktemp("repository")
    for name in FOLDERS:
        shutil.copytree(ROOT / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("README.md", "LICENSE", "Makefile", "pyproject.toml"):
        shutil.copy(ROOT / name, copy)
    return copy


@pytest.fixture(scope="module")
def executed() -> set[str]:
    """Commands that have run: one that is in several documents runs once."""
    return set()


@documents
def test_commands(document: Path, workplace: Path, executed: set[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(workplace)
    execute_all(document, (), executed)


@documents
def test_programs(document: Path, workplace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The Python blocks of a document are parts of one program."""
    monkeypatch.chdir(workplace)
    scope: dict[str, object] = {}
    for block in blocks(document, "python"):
        if not block.marks:
            exec(block.text, scope)


@pytest.mark.slow
@documents
def test_slow_commands(document: Path, workplace: Path, executed: set[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(workplace)
    execute_all(document, (), executed)
    execute_all(document, ("slow",), executed)


def execute_all(document: Path, marks: tuple[str, ...], executed: set[str]) -> None:
    """Execute the commands of the blocks with these marks that have not been executed."""
    for block in blocks(document, "sh"):
        for command in block.commands():
            if block.marks == marks and command not in executed and not command.startswith("make "):
                execute(command)
                executed.add(command)


def execute(command: str) -> None:
    """Execute a command: `mpmcol` in this process, made coarse and short, anything else by a shell."""
    words = shlex.split(QUICKER.get(command, command))
    if words[0] != "mpmcol" or {"|", "&&", ";"} & set(words):
        script = SHELL.format(python=sys.executable, command=command)
        environment = os.environ | {"PYTHONPATH": str(Path.cwd())}
        done = subprocess.run(["bash", "-c", script], env=environment, capture_output=True, text=True)
        assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
        return
    target = words[words.index(">") + 1] if ">" in words else None
    words = words[1 : words.index(">")] if target else words[1:]
    result = invoke(*coarse(words))
    assert result.exit_code == 0, f"{command}\n{result.output}"
    if target:
        Path(target).write_text(result.stdout)


def coarse(words: list[str]) -> list[str]:
    """The arguments of a run or a sweep with a coarse grid, a short collapse and few aspect ratios."""
    if "--dry-run" in words:  # other documents may have filled the default folder
        return [*(word.replace("0.5:7", "0.5:1") for word in words), *(["--fresh"] if words[0] == "run" else [])]
    if words[0] == "run":  # with --set, the name of the default folder would have a hash
        case = Path(words[1])
        name = f"{case.parent.name}-{case.stem}" if case.parent.parent.name == "fits" else case.stem
        return [*replaced(words), *([] if "--out" in words else ["--out", f"runs/{name}"])]
    words = [word.replace("0.5:7", "0.5:1") if words[0] == "sweep" else word for word in words]
    if words[0] == "sweep" and "--engine" not in words:
        return [*replaced(words), *([] if "--out" in words else ["--out", "sweeps/cylinder"])]
    return words


def replaced(words: list[str]) -> list[str]:
    """The arguments with the values of COARSE instead of their own; an accuracy chooses the spacing itself."""
    values = {key: text for key, text in COARSE.items() if key != "grid.spacing" or "--accuracy" not in words}
    pairs = pairwise(words)
    own = {k for k, pair in enumerate(pairs) if pair[0] == "--set" and pair[1].partition("=")[0] in values}
    kept = [word for k, word in enumerate(words) if k not in own and k - 1 not in own]
    return [*kept, *(word for key, text in values.items() for word in ("--set", f"{key}={text}"))]


@documents
def test_marks_are_known(document: Path) -> None:
    assert all(block.marks in MARKS for name in ("sh", "python") for block in blocks(document, name))


@documents
def test_every_command_is_accepted(document: Path) -> None:
    """Those that are not executed as well: commands, options, modules and targets of make exist."""
    for block in blocks(document, "sh"):
        for command in block.commands():
            check(shlex.split(command.partition(" | ")[0].partition(" > ")[0]), block)


def check(words: list[str], block: Block) -> None:
    """Check a command without executing it."""
    if words[0] == "mpmcol":
        context = main.make_context("mpmcol", words[1:])
        command = main.get_command(context, words[1])
        assert isinstance(command, click.Command), words
        command.make_context(words[1], words[2:], parent=context)
    elif words[0] == "make":
        targets = re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), flags=re.MULTILINE)
        assert {word for word in words[1:] if "=" not in word} <= set(targets), words
    elif words[:2] == ["python", "-m"]:
        assert words[2].partition(".")[0] not in FOLDERS or find_spec(words[2]), words
    else:
        assert block.marks == ("not-run",) or shutil.which(words[0]), words


@documents
def test_case_files(document: Path, tmp_path: Path) -> None:
    """A whole case is loaded; a part of one is TOML."""
    for block in blocks(document, "toml"):
        path = tmp_path / "case.toml"
        path.write_text(block.text)
        assert load_case(path) if "schema = 1" in block.text else tomllib.loads(block.text)


@documents
def test_links(document: Path) -> None:
    for link in links(document):
        name, _, anchor = link.partition("#")
        target = (document.parent / name).resolve() if name else document
        assert target.exists(), f"{document}: {link}: no such file"
        assert not anchor or anchor in anchors(target), f"{document}: {link}: no such heading"


@documents
def test_names_of_the_notation(document: Path) -> None:
    points = Points(1)
    for name in re.findall(r"`points\.(\w+)`", document.read_text()):
        assert isinstance(getattr(points, name), np.ndarray), name
