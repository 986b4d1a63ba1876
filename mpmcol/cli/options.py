"""Types of options, and the options and the exit code that several commands share."""

from __future__ import annotations

import contextlib
import difflib
import functools
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import click

from mpmcol.errors import OutputError
from mpmcol.sweep.arguments import MOST_CONCURRENT


class _Path(click.Path):
    """A path, not an empty text, which would be the current folder."""

    def convert(self, value: Any, param: click.Parameter | None, context: click.Context | None) -> Any:
        if value == "":
            self.fail("expected a path, not an empty text", param, context)
        return super().convert(value, param, context)


PATH = _Path(path_type=Path)
JOBS = THREADS = click.IntRange(1, MOST_CONCURRENT)
CHECK_FAILED = 4  # exit code if a check or a scenario has an unexpected outcome
ASPECT_KEY = "geometry.aspect"
DEFAULT_FOLDER = Path("runs")  # of the results, if no other is given
SECONDS = {"s": 1.0, "min": 60.0, "h": 3600.0, "d": 86400.0}

Decorator = Callable[[Callable[..., Any]], Callable[..., Any]]


class Duration(click.ParamType):
    """A time in seconds, given as "90", "90s", "5min", "2h", "1.5d", or as for Slurm: "01:30:00" or "1-12:00:00"."""

    name = "time"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Convert to seconds."""
        if isinstance(value, float):
            return value
        if clock := re.fullmatch(r"(?:(\d{1,6})-)?(\d{1,6}):(\d\d):(\d\d)", value.strip(), re.ASCII):
            days, hours, minutes, seconds = (int(part or 0) for part in clock.groups())
            time = float(((24 * days + hours) * 60 + minutes) * 60 + seconds)
        else:
            match = re.fullmatch(r"(\d++\.?\d*+|\.\d++)\s*+(s|min|h|d|)", value.strip(), re.ASCII)
            time = float(match[1]) * SECONDS[match[2] or "s"] if match else 0.0
        if time == 0.0:
            self.fail(f"{value!r}: expected a time > 0, for example 90s, 5min, 2h, 1.5d or 01:30:00", param, ctx)
        return time


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
            meant = f"; did you mean {fraction:g}%?" if 1.0 <= fraction < 100.0 else ""
            self.fail(
                f"{value!r}: expected a relative error between 0 and 1, for example 5% or 0.05{meant}", param, ctx
            )
        return fraction


class Positive(click.ParamType):
    """A number > 0 with an optional unit, for example "1 kPa"; `unit` is that of a number without one."""

    name = "value"
    least = 1e-30

    def __init__(self, unit: str, example: str, most: float = 1e30) -> None:
        self.unit, self.example, self.most = unit, example, most

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Convert to `unit`."""
        from mpmcol.units import to_unit

        if isinstance(value, float):
            return value
        try:
            number = to_unit(value, self.unit)
        except ValueError as reason:
            self.fail(f"{value!r}: {reason}; {self._expected}", param, ctx)
        if not self.least <= number <= self.most:
            self.fail(f"{value!r}: {self._expected}", param, ctx)
        return number

    @property
    def _expected(self) -> str:
        limit = f" and <= {self.most:g}" if self.most < 1e30 else ""
        return f"expected a number > 0{limit}{f' in {self.unit}' if self.unit else ''}, for example {self.example}"


DURATION, ACCURACY = Duration(), Accuracy()


def results_argument(several: bool = False, of: str = "a run, a sweep or a study") -> Decorator:
    """A results folder as an argument of a command, or several of them; `of` names what they may be of.

    The command raises OutputError if there is no such folder.
    """

    def decorate(command: Callable[..., Any]) -> Callable[..., Any]:
        name = "folders" if several else "folder"

        @functools.wraps(command)
        def checked(*arguments: Any, **options: Any) -> Any:
            for folder in options[name] if several else [options[name]]:
                _require_folder(folder, of)
            return command(*arguments, **options)

        if several:
            return click.argument(name, metavar="DIR...", type=PATH, nargs=-1, required=True)(checked)
        return click.argument(name, metavar="DIR", type=PATH)(checked)

    return decorate


def _require_folder(folder: Path, of: str) -> None:
    if not folder.is_dir():
        from mpmcol.io.results import kind_of  # here, since it takes long to import

        raise OutputError(f"{kind_of(folder)}; expected the results folder of {of}{_hint(folder)}")


def _hint(missing: Path) -> str:
    """Names of folders that may be meant: of the same name in the default folder, or of a similar name."""
    found = [DEFAULT_FOLDER / missing] if (DEFAULT_FOLDER / missing).is_dir() else _similar(missing)
    return f". Did you mean {' or '.join(map(str, found))}?" if found else ""


def _similar(missing: Path) -> list[Path]:
    with contextlib.suppress(OSError):
        beside = {path.name: path for path in missing.parent.iterdir() if path.is_dir()}
        return [beside[name] for name in difflib.get_close_matches(missing.name, beside, 2)]
    return []


def positive_integer(text: str) -> int:
    """An integer of at most twelve digits, 0 for any other text: Python refuses to read thousands of digits."""
    return int(text) if text.isdecimal() and len(text) <= 12 else 0


def out_option(default: str) -> Decorator:
    """`--out`: the folder of the results."""
    return click.option("--out", metavar="DIR", type=PATH, help=f"Folder of the results  [default: {default}]")


def json_option(content: str) -> Decorator:
    """`--json`: print a result as one line of JSON."""
    return click.option("--json", "to_json", is_flag=True, help=f"Print {content} as one line of JSON on stdout.")


def accuracy_option(default: str | None = None) -> Decorator:
    """`--accuracy`: the error for which the cheapest configuration of the shipped study is chosen."""
    return click.option(
        "--accuracy", type=ACCURACY, default=default, show_default=True,
        help="Choose model and grid for this error of runout and height, for example 5%.",
    )  # fmt: skip


def corrected_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """`--corrected`: the accuracy is that of values corrected for the error of the grid."""
    return click.option(
        "--corrected", is_flag=True,
        help="With --accuracy: that of runout and height corrected for the known error of the grid, which may be "
        "coarser.",
    )(command)  # fmt: skip


def require_accuracy(corrected: bool, accuracy: float | None) -> None:
    """Refuse `--corrected` without `--accuracy`."""
    if corrected and accuracy is None:
        raise click.UsageError("--corrected requires --accuracy, which chooses the grid")


def with_aspect(overrides: Sequence[str], aspect: str | None) -> tuple[str, ...]:
    """The overrides of a single case with that of `--aspect`.

    Raises click.UsageError for several values, and for a second value of the same key.
    """
    if aspect is None:
        return tuple(overrides)
    if "," in aspect or ":" in aspect:
        raise click.UsageError(f"--aspect {aspect}: one case has one aspect ratio; mpmcol sweep runs several")
    if any(text.partition("=")[0].strip() == ASPECT_KEY for text in overrides):
        raise click.UsageError(f"--aspect and --set {ASPECT_KEY} are the same value; give one of them")
    return (f"{ASPECT_KEY}={aspect}", *overrides)


def _one_aspect(context: click.Context, parameter: click.Parameter, values: tuple[str, ...]) -> str | None:
    """The single value of `--aspect`, of which click would take the last one, as text."""
    if len(values) > 1:
        raise click.BadParameter(f"is given {len(values)} times: {', '.join(values)}; give one value")
    if values and not {",", ":"} & set(values[0]):  # several values have their own message
        Positive("", "3").convert(values[0], parameter, context)
    return values[0] if values else None


def _not_repeated(context: click.Context, parameter: click.Parameter, values: tuple[str, ...]) -> tuple[str, ...]:
    """The values of `--set`; CaseError if a key has two."""
    if len(values) > 1:
        from mpmcol.case.overrides import refuse_repeated

        refuse_repeated(values)
    return values


overrides_option = click.option(
    "--set", "overrides", multiple=True, metavar="KEY=VALUE", callback=_not_repeated,
    help="Replace a value of the case, for example grid.spacing=0.005. May be repeated.",
)  # fmt: skip
aspect_option = click.option(
    "--aspect",
    metavar="VALUE",
    multiple=True,
    callback=_one_aspect,
    help=f"Aspect ratio h_i/r_i, the same as --set {ASPECT_KEY}=VALUE.",
)
fresh_option = click.option(
    "--fresh", is_flag=True, help="Run again from scratch: discard finished and unfinished runs."
)
jobs_option = click.option(
    "--jobs", metavar="N", type=JOBS, help="Concurrent runs  [default: chosen from cores, memory and sizes]"
)
threads_option = click.option(
    "--threads", metavar="N", type=THREADS, help="Threads per run  [default: chosen from cores and sizes]"
)
dry_run_option = click.option(
    "--dry-run", is_flag=True, help="Check everything and estimate the cost; run and write nothing."
)
report_option = click.option("--report", is_flag=True, help="Also write report.html in the folder of the results.")
quiet_option = click.option("--quiet", is_flag=True, help="Print errors only.")
