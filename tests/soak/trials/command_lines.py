"""Command lines of all commands and options end with a documented exit code and a message.

Commands end where they would begin to compute: computing takes seconds, and does not depend on odd arguments.
"""

from __future__ import annotations

import contextlib
import os
import random
import time
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NoReturn
from unittest import mock

import click
from click.testing import CliRunner, Result

from mpmcol.case import key_names, load_case, resolved_toml, shipped_cases
from mpmcol.cli import COMMANDS, main
from tests.support.bad_input import LONGEST, find_failure

COUNT = 5_000
LONGEST_PLAN = 10.0  # s of CPU time: an accepted command may read the cases of hundreds of runs
CODES = (0, 2, 5)  # done, wrong command or case, unreadable or unwritable file
COMPUTATIONS = (
    "mpmcol.setup.model.allocate_grid", "mpmcol.sweep.runner.execute_runs", "mpmcol.studies.runs.execute_runs",
    "mpmcol.failure_modes.run_catalogue", "mpmcol.studies.frame.carry_out", "mpmcol.bench.measure.measure_case",
    "mpmcol.bench.scaling.measure_scaling", "mpmcol.studies.fit.forward.run_sweep",
)  # fmt: skip
NUMBERS = (
    "0", "-1", "1", "3", "2.5", "1e400", "nan", "-inf", "9" * 30, "9" * 5000, "1," + "9" * 5000, "1,,2", "1,x", "٣",
    "5%", "-5%", "120%", "1e-400%", "5min", "0s", "1.5 fortnights", "9" * 400 + "d", "1280x720", "0x0",
    "9" * 5000 + "x300", "0.5:7", "0.5:7/14", "7:0.5", "1:2:0", "0:1e-300:1e-308", "0.5:7/" + "9" * 5000,
    "1" * 60_000 + "z", ".3", "0,5", "0,5:7", "33°", "4.0", "2.5mm", "1" + " " * 60_000 + "z z",
)  # fmt: skip
TEXTS = (
    "", " ", "all", "é\u202e", "\udcff", "\x1b[31m", "x" * 5000, "geometry", "=", "a=b", "geometry.aspect",
    "geometry.aspect=", ".=1", "geometry.aspect=3", "grid.spacing=2 mm", "grid.spacing=1e-9", "geometry.aspect=1:3",
    "grid.spacing=[1", "q.q.q=1", "a" + ".a" * 2000 + "=1", "geometry" + ".a" * 40_000 + "=1", "material.law=elastic",
    "time.cfl=1,2,3", "title=" + "[" * 9000, "plane,axisymmetric", "tcp://0.0.0.0:1", "--", "-", "--help",
    "--no-such-option", "fig7", "grid-crossing", "rods",
)  # fmt: skip
PATHS = (
    "good.toml", "bad.toml", "binary.toml", "empty.toml", "folder", "run", "sweep", "nowhere", "nowhere/deep",
    "good.toml/x", "folder/new", "/dev", "/dev/null", "/dev/zero", "/proc/self/mem", "picture.png", "new.toml", ".",
    "..", "~", "good", "\udcff.toml", "points.csv", "link", "C:\\cases\\good.toml", "cases\\good.toml", "good.yaml",
)  # fmt: skip
FITTING: dict[str, tuple[str, ...]] = {
    "case": ("good.toml", "\udcff.toml", "coarse-channel", "lube-quarter"),
    "overrides": ("geometry.aspect=3", "grid.spacing=5 mm", "grid.spacing=0.01", "stages.gate_speed=1"),
    "settings": ("geometry.aspect=1:3", "material.friction_deg=30,33", "time.cfl=0.4", "geometry.base=elastic,rigid"),
    "aspect": ("1:2", "0.5:7/14", "3"),
    "measured": ("zeta=1.3", "zeta=1.3+-0.1,beta=0.5", "repose=20deg"),
    "vary": ("material.friction_deg=20:45", "material.cohesion=0:1 kPa", "friction.floor=0.1:0.5"),
    "profile": ("points.csv",),
    "slope": ("0:20:5", "10"),
    "folder": ("run", "sweep", "folder"),
    "study": ("quick", "default"),
    "figures": ("fig5", "all"),
    "key": key_names(),
    "name": tuple(shipped_cases()),
}  # by the parameter's name


def trial(seed: int, folder: Path) -> str | None:
    """Give one command line."""
    draw = random.Random(seed)
    arguments = _arguments(draw)
    with _folder_of_files(folder), _without_computations():
        _warm_up()
        return find_failure(lambda: _failure_of(arguments), LONGEST_PLAN)


def _failure_of(arguments: list[str]) -> str | None:
    started = time.process_time()
    result = _invoke(arguments)
    took = time.process_time() - started
    if result.exception and not isinstance(result.exception, SystemExit):
        raise result.exception
    text = f"mpmcol {arguments} ends with {result.exit_code}:\n{result.output[:300]}"
    if result.exit_code not in CODES:
        report = Path("crash-report.txt")
        return f"{text}\n{report.read_text()[-1500:] if report.exists() else ''}"
    if result.exit_code and not result.output.strip():
        return f"{text} without a message"
    return f"{text} after {took:.1f} s" if result.exit_code and took > LONGEST else None


def _invoke(arguments: list[str]) -> Result:
    return CliRunner().invoke(main, arguments, prog_name="mpmcol")


@cache
def _warm_up() -> None:
    """Import the modules that commands import when they are first used, which takes seconds."""
    for line in ("plan coarse-channel", "measure run", "plot run", "render run", "pareto quick", "run coarse-channel"):
        _invoke(line.split())
    for name in ("paper", "validate", "stability", "bench"):
        _invoke([name])


def _arguments(draw: random.Random) -> list[str]:
    """A command with its options in any order, each with some value, and arguments."""
    name = draw.choice([*COMMANDS, "chek", ""]) if draw.random() < 0.1 else draw.choice(list(COMMANDS))
    command = main.get_command(click.Context(main), name)
    parts: list[list[str]] = []
    for parameter in command.params if command else ():
        chance = 0.8 if isinstance(parameter, click.Argument) else 0.25
        while draw.random() < chance:
            parts.append(_part(draw, parameter))
            chance = 0.4 if parameter.multiple or parameter.nargs != 1 else 0.05
    if draw.random() < 0.1:
        parts.append([_value(draw)])
    draw.shuffle(parts)
    return [name, *(word for part in parts for word in part)]


def _part(draw: random.Random, parameter: click.Parameter) -> list[str]:
    fitting = FITTING.get(parameter.name or "", ())
    if isinstance(parameter.type, click.Choice):
        fitting = tuple(parameter.type.choices)
    value = draw.choice(fitting) if fitting and draw.random() < 0.8 else _value(draw)
    if isinstance(parameter, click.Argument):
        return [value]
    option = draw.choice(parameter.opts)
    if isinstance(parameter, click.Option) and parameter.is_flag:
        return [option]
    return draw.choice(([option, value], [f"{option}={value}"], [option, value]))


def _value(draw: random.Random) -> str:
    setting = f"{draw.choice(key_names())}={draw.choice(draw.choice((NUMBERS, TEXTS)))}"
    kinds = (NUMBERS, TEXTS, PATHS, tuple(shipped_cases()), (setting,))
    return draw.choice(draw.choice(kinds))


@contextlib.contextmanager
def _folder_of_files(folder: Path) -> Iterator[None]:
    """Change to a folder with cases, a run and a sweep, some of them damaged."""
    (folder / "good.toml").write_text('extends = "coarse-channel"\n')
    (folder / "bad.toml").write_text("[grid]\nspacng = 1\n")
    (folder / "binary.toml").write_bytes(bytes(range(256)) * 20)
    (folder / "empty.toml").touch()
    (folder / "points.csv").write_text("x;y\n0,1;0,2\n")
    (folder / "good.yaml").write_text("extends: coarse-channel\n")
    (folder / "link").symlink_to("target/that/does/not/exist")
    (folder / "\udcff.toml").write_text('extends = "coarse-channel"\n')
    for name in ("folder", "run/snapshots", "sweep"):
        (folder / name).mkdir(parents=True)
    (folder / "run/case.resolved.toml").write_text(resolved_toml(load_case("coarse-channel")))
    (folder / "run/snapshots/000000.vtkhdf").write_bytes(b"damaged")
    (folder / "run/history.csv").write_text("stage,time\ncollapse,1\n")
    (folder / "run/result.json").write_text('{"schema": 1, "status": "done"}')
    (folder / "sweep/sweep.json").write_text('{"schema": 2, "runs": [1]}')
    with contextlib.chdir(folder):
        yield


@contextlib.contextmanager
def _without_computations() -> Iterator[None]:
    """End every command successfully where it would begin to compute."""

    def end_command(*_: object, **__: object) -> NoReturn:
        raise click.exceptions.Exit(0)

    with contextlib.ExitStack() as stack:
        for computation in COMPUTATIONS:
            stack.enter_context(mock.patch(computation, end_command))
        stack.enter_context(mock.patch.dict(os.environ))
        yield
