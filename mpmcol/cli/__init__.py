"""The command line. A command is a file here and a line in COMMANDS; it is imported when it is used."""

from __future__ import annotations

import difflib
import errno
import importlib
import io
import os
import platform
import sys
import tempfile
import traceback
from importlib import metadata
from pathlib import Path
from typing import Any

import click

from mpmcol import __version__
from mpmcol.errors import MpmcolError, OutputError

LONGEST_NAME = 200  # of a path in a message
DISK = (errno.ENOSPC, errno.EDQUOT, errno.EIO)  # what writing to stdout may meet

COMMANDS = {
    "run": "mpmcol.cli.run:run",
    "sweep": "mpmcol.cli.sweep:sweep",
    "status": "mpmcol.cli.status:status",
    "verify": "mpmcol.cli.verify:verify",
    "paper": "mpmcol.cli.paper:paper",
    "validate": "mpmcol.cli.validate:validate",
    "stability": "mpmcol.cli.stability:stability",
    "pareto": "mpmcol.cli.pareto:pareto",
    "plan": "mpmcol.cli.plan:plan",
    "measure": "mpmcol.cli.measure:measure",
    "plot": "mpmcol.cli.plot:plot",
    "render": "mpmcol.cli.render:render",
    "check": "mpmcol.cli.check:check",
    "explain": "mpmcol.cli.explain:explain",
    "schema": "mpmcol.cli.schema:schema",
    "cases": "mpmcol.cli.cases:cases",
    "init": "mpmcol.cli.cases:init",
    "bench": "mpmcol.cli.bench:bench",
}


def _version(package: str) -> str:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "not installed"


class Commands(click.Group):
    """Imports a command when it is asked for, and turns exceptions into messages and exit codes."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Names in the order in which a user meets them."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import one command."""
        if cmd_name not in COMMANDS:
            return None
        module, _, name = COMMANDS[cmd_name].partition(":")
        command: click.Command = getattr(importlib.import_module(module), name)
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Name the nearest command if there is none of this name; click only knows those already imported."""
        near = difflib.get_close_matches(args[0], COMMANDS, 1)
        if near and args[0] not in COMMANDS and not ctx.resilient_parsing:
            ctx.fail(f'No such command "{args[0]}". Did you mean "{near[0]}"?')
        return super().resolve_command(ctx, args)

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command; the only place where errors become exit codes."""
        if isinstance(sys.stdout, io.TextIOWrapper):
            sys.stdout.reconfigure(errors="backslashreplace")  # as stderr: names of files may be in any encoding
        try:
            return super().invoke(ctx)
        except MpmcolError as failure:
            click.echo(str(failure), err=True)
            ctx.exit(failure.exit_code)
        except (click.ClickException, click.exceptions.Exit, click.Abort):
            raise
        except KeyboardInterrupt:
            click.echo("stopped; what was written up to here is readable", err=True)
            ctx.exit(130)
        except Exception as bug:
            if getattr(bug, "errno", None) == errno.EPIPE:
                raise  # the reader of our output has gone; click ends quietly
            if isinstance(bug, OSError) and bug.filename:
                click.echo(_file_error(bug), err=True)
                ctx.exit(OutputError.exit_code)
            if isinstance(bug, OSError) and bug.errno in DISK:
                click.echo(f"the output cannot be written: {bug.strerror}; make room, or send it elsewhere", err=True)
                ctx.exit(OutputError.exit_code)
            _report_bug(bug)
            ctx.exit(1)


def _file_error(failure: OSError) -> str:
    """What the system has against a path that was given, such as a name that is too long."""
    name = str(failure.filename)
    shown = name if len(name) < LONGEST_NAME else f"{name[:LONGEST_NAME]}..."
    return f"{shown}: cannot be used: {failure.strerror}; choose another path, or mend its permissions"


def _report_bug(bug: Exception) -> None:
    packages = ("numba", "llvmlite", "numpy", "pydantic", "h5py", "pyvista", "click")
    versions = "\n".join(f"{package} {_version(package)}" for package in packages)
    system = f"Python {platform.python_version()} on {platform.platform()}"
    trace = "".join(traceback.format_exception(bug))
    report = f"mpmcol {__version__}\ncommand: {' '.join(sys.argv)}\n{system}\n{versions}\n\n{trace}"
    click.echo(f"mpmcol ended on an error of its own: {type(bug).__name__}: {bug}", err=True)
    click.echo(f"Please report it together with {_write_report(report)}", err=True)


def _write_report(report: str) -> str:
    for folder in (Path.cwd(), Path(tempfile.gettempdir())):
        path = folder / "crash-report.txt"
        try:
            path.write_text(report, encoding="utf-8", errors="replace")
            return str(path)
        except OSError:
            continue
    return "this text:\n" + report


@click.group(cls=Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="mpmcol")
@click.pass_context
def main(ctx: click.Context) -> None:
    """Collapse of granular columns by the material point method.

    First steps: mpmcol cases, mpmcol run quickstart, mpmcol init quickstart > my.toml
    """
    if os.environ.get("NO_COLOR"):
        ctx.color = False
