"""A process that executes runs one after another: `python -m mpmcol.cli.worker`, started by `mpmcol.sweep.worker`.

Imports and compiled kernels stay in memory from run to run. Each line of stdin is a JSON list of arguments of `mpmcol`,
or COMPILE and cases; the answer on stdout is a line with the exit code and the resident memory in bytes. What the
commands print goes to stderr. The process ends with stdin.
"""

from __future__ import annotations

import gc
import json
import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import IO, Any, TextIO

import psutil

import mpmcol.cli.run
import mpmcol.simulation.run  # noqa: F401  # before the first request, while other processes start
from mpmcol.cli import main
from mpmcol.errors import MpmcolError
from mpmcol.sweep.compile_cache import compile_kernels
from mpmcol.sweep.worker import COMPILE

RESET_PEAK_MEMORY = "5"  # Linux, proc_pid_clear_refs(5): the peak of the resident memory becomes its present value


def serve() -> None:
    """Execute commands until stdin ends."""
    requests, answers = _take_over(sys.stdin), _take_over(sys.stdout, "w")
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, sys.stdin.fileno())
    os.close(nothing)
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    for line in requests:
        code = execute(json.loads(line))
        gc.collect()
        answers.write(f"{code} {psutil.Process().memory_info().rss}\n")
        answers.flush()


def execute(arguments: Sequence[str]) -> int:
    """Execute one command and return its exit code."""
    with suppress(OSError):  # elsewhere the peak is that of all runs so far
        Path("/proc/self/clear_refs").write_text(RESET_PEAK_MEMORY, "utf-8")
    try:
        if arguments[0] == COMPILE:
            for case in arguments[1:]:
                compile_kernels(case)
        else:
            main(list(arguments), prog_name="mpmcol")
    except MpmcolError as refused:
        return refused.exit_code
    except SystemExit as ended:
        return ended.code if isinstance(ended.code, int) else int(ended.code is not None)
    return 0


def _take_over(stream: TextIO, mode: str = "r") -> IO[Any]:
    """Another object for the file of a stream, which child processes do not inherit."""
    return os.fdopen(os.dup(stream.fileno()), mode, encoding="utf-8")


if __name__ == "__main__":
    serve()
