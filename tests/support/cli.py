"""The command line in tests: called in this process, or started as a process of its own."""

from __future__ import annotations

import csv
import io
import json
import subprocess
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress

from click.testing import CliRunner, Result

from mpmcol.cli import main
from mpmcol.io.columns import without_unit
from tests.support.json_keys import unexplained_keys


def invoke(*arguments: object) -> Result:
    """Call `mpmcol` with these arguments in this process; keys of JSON that it prints must be in the glossary."""
    words = [str(argument) for argument in arguments]
    result = CliRunner().invoke(main, words)
    if "--json" in words and result.stdout.startswith("{"):
        unexplained = unexplained_keys(words, json.loads(result.stdout))
        assert not unexplained, f"mpmcol {' '.join(words)}: not in mpmcol/io/json_glossary.py: {unexplained}"
    return result


def csv_row(text: str) -> dict[str, str]:
    """The only row of a CSV text, by names without units."""
    (row,) = csv.DictReader(io.StringIO(text))
    return {without_unit(column): value for column, value in row.items()}


def set_options(overrides: Iterable[str]) -> list[str]:
    """Return `--set KEY=VALUE` for each override, of a repeated key the last one."""
    by_key = {override.partition("=")[0]: override for override in overrides}
    return [argument for override in by_key.values() for argument in ("--set", override)]


@contextmanager
def started(*arguments: object) -> Iterator[subprocess.Popen[str]]:
    """Start `mpmcol` with these arguments in a process of its own, with pipes for its output; stop it at the end.

    At first by SIGTERM, at which a sweep ends its runs.
    """
    command = [sys.executable, "-m", "mpmcol", *(str(argument) for argument in arguments)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        try:
            yield process
        finally:
            process.terminate()
            with suppress(subprocess.TimeoutExpired):
                process.communicate(timeout=30.0)
            process.kill()
