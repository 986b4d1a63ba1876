"""Types of options, and the options and the exit code that several commands share."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

PATH = click.Path(path_type=Path)
JOBS = THREADS = click.IntRange(1, 1024)  # far more than the cores of a machine; the system could not start them
CHECK_FAILED = 4  # exit code if a check or a scenario has an unexpected outcome
SECONDS = {"s": 1.0, "min": 60.0, "h": 3600.0, "d": 86400.0}

Decorator = Callable[[Callable[..., Any]], Callable[..., Any]]


class Duration(click.ParamType):
    """A time in seconds, given as "90", "90s", "5min", "2h" or "1.5d"."""

    name = "time"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Convert to seconds."""
        if isinstance(value, float):
            return value
        match = re.fullmatch(r"(\d++\.?\d*+|\.\d++)\s*+(s|min|h|d|)", value.strip(), re.ASCII)
        if not match or float(match[1]) == 0.0:
            self.fail(f"{value!r}: expected a time > 0, for example 90s, 5min, 2h or 1.5d", param, ctx)
        return float(match[1]) * SECONDS[match[2] or "s"]


class Accuracy(click.ParamType):
    """A relative error, given as "5%" or 0.05."""

    name = "error"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Convert to a fraction."""
        from mpmcol.units import to_unit

        if isinstance(value, float):
            return value
        try:
            fraction = to_unit(value, "")
        except ValueError:
            fraction = float("nan")
        if not 0.0 < fraction < 1.0:
            self.fail(f"{value!r}: expected an error between 0 and 100%, for example 5% or 0.05", param, ctx)
        return fraction


DURATION, ACCURACY = Duration(), Accuracy()


def positive_integer(text: str) -> int:
    """An integer of at most twelve digits, 0 for any other text: Python refuses to read thousands of digits."""
    return int(text) if text.isdecimal() and len(text) <= 12 else 0


def format_duration(seconds: float) -> str:
    """A time in the unit that gives a readable number."""
    if seconds < 120.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 7200.0 else f"{seconds / 3600.0:.1f} h"


def out_option(default: str) -> Decorator:
    """`--out`: the folder of the results."""
    return click.option("--out", metavar="DIR", type=PATH, help=f"Folder of the results  [default: {default}]")


def json_option(content: str) -> Decorator:
    """`--json`: print a result as one line of JSON."""
    return click.option("--json", "to_json", is_flag=True, help=f"Print {content} as one line of JSON on stdout.")


overrides_option = click.option(
    "--set", "overrides", multiple=True, metavar="KEY=VALUE",
    help="Replace a value of the case, for example geometry.aspect=5. May be repeated.",
)  # fmt: skip
jobs_option = click.option(
    "--jobs", metavar="N", type=JOBS, help="Number of concurrent runs  [default: chosen from their sizes]"
)
threads_option = click.option(
    "--threads", metavar="N", type=THREADS, help="Threads per run  [default: chosen from their sizes]"
)
report_option = click.option("--report", is_flag=True, help="Also write report.html in the folder of the results.")
quiet_option = click.option("--quiet", is_flag=True, help="Print errors only.")
