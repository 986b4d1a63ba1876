"""The command line in tests: called in this process, or started as a process of its own."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterable

from click.testing import CliRunner, Result

from mpmcol.cli import main


def invoke(*arguments: object) -> Result:
    """Call `mpmcol` with these arguments in this process."""
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def set_options(overrides: Iterable[str]) -> list[str]:
    """Return `--set KEY=VALUE` for each override."""
    return [argument for override in overrides for argument in ("--set", override)]


def start(*arguments: object) -> subprocess.Popen[str]:
    """Start `mpmcol` with these arguments in a process of its own, with pipes for its output."""
    command = [sys.executable, "-m", "mpmcol", *(str(argument) for argument in arguments)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
