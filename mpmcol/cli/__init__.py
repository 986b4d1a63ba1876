"""The command line. Each command has a module here and an entry in GROUPS; it is imported when it is used."""

from __future__ import annotations

import difflib
import importlib
import os
import sys
from pathlib import Path
from typing import Any

import click

from mpmcol import __version__
from mpmcol.cli import streams
from mpmcol.errors import MpmcolError, OutputError

LONGEST_PATH = 200  # characters of a path in a message

GROUPS = {  # heading in the help -> command -> where it is defined
    "Simulate": {
        "run": "mpmcol.cli.run:run",
        "sweep": "mpmcol.cli.sweep:sweep",
        "fit": "mpmcol.cli.fit:fit",
        "status": "mpmcol.cli.status:status",
    },
    "Inspect results": {
        "measure": "mpmcol.cli.measure:measure",
        "plot": "mpmcol.cli.plot:plot",
        "render": "mpmcol.cli.render:render",
        "report": "mpmcol.cli.report:report",
        "verify": "mpmcol.cli.verify:verify",
    },
    "Case files": {
        "cases": "mpmcol.cli.cases:cases",
        "init": "mpmcol.cli.cases:init",
        "check": "mpmcol.cli.check:check",
        "explain": "mpmcol.cli.schema:explain",
        "schema": "mpmcol.cli.schema:schema",
    },
    "Studies": {
        "paper": "mpmcol.cli.paper:paper",
        "validate": "mpmcol.cli.validate:validate",
        "stability": "mpmcol.cli.stability:stability",
        "pareto": "mpmcol.cli.pareto:pareto",
        "plan": "mpmcol.cli.plan:plan",
    },
    "Tools": {
        "element": "mpmcol.cli.element:element",
        "bench": "mpmcol.cli.bench:bench",
    },
}
COMMANDS = {name: place for group in GROUPS.values() for name, place in group.items()}


def _version(package: str) -> str:
    from importlib import metadata

    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "not installed"


class Commands(click.Group):
    """Imports commands when they are used, and converts exceptions to messages and exit codes."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Names of the commands, in the order of the groups."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import one command."""
        if cmd_name not in COMMANDS:
            return None
        module, _, name = COMMANDS[cmd_name].partition(":")
        command: click.Command = getattr(importlib.import_module(module), name)
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List the commands in groups, each with its summary."""
        width = max(map(len, COMMANDS))
        for heading, names in GROUPS.items():
            with formatter.section(heading):
                formatter.write_dl([(f"{name:{width}}", self._summary(ctx, name)) for name in names])

    def _summary(self, ctx: click.Context, name: str) -> str:
        """The first line of a command's help."""
        command = self.get_command(ctx, name)
        return (command.help or "").partition("\n")[0] if command else ""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Suggest the nearest command for an unknown name; click knows only those already imported."""
        near = difflib.get_close_matches(args[0], COMMANDS, 1)
        if near and args[0] not in COMMANDS and not ctx.resilient_parsing:
            ctx.fail(f'No such command "{args[0]}". Did you mean "{near[0]}"?')
        return super().resolve_command(ctx, args)

    def main(self, *arguments: Any, **options: Any) -> Any:
        """Run the command line."""
        streams.accept_any_text()
        return super().main(*arguments, **options)

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command; the only place where errors are converted to exit codes."""
        try:
            return super().invoke(ctx)
        except MpmcolError as failure:
            streams.report(str(failure))
            ctx.exit(failure.exit_code)
        except (click.ClickException, click.exceptions.Exit, click.Abort):
            raise
        except KeyboardInterrupt:
            streams.report("aborted; files written so far are readable")
            ctx.exit(130)
        except OSError as failure:
            ctx.exit(_exit_code(failure))
        except Exception as bug:
            _report_bug(bug)
            ctx.exit(1)
        finally:
            streams.discard_unwritten()


def _exit_code(failure: OSError) -> int:
    """Report an error of the operating system; returns the exit code."""
    if streams.has_no_reader(failure):
        return streams.READER_GONE
    if failure.filename:
        streams.report(_file_error(failure))
        return OutputError.exit_code
    if failure.errno in streams.FAILURES:
        streams.report(f"stdout cannot be written: {failure.strerror}; free space, or redirect the output")
        return OutputError.exit_code
    _report_bug(failure)
    return 1


def _file_error(failure: OSError) -> str:
    """Message for a path that the operating system rejects, for example because it is too long."""
    name = str(failure.filename)
    shown = name if len(name) < LONGEST_PATH else f"{name[:LONGEST_PATH]}..."
    return f"{shown}: the path cannot be used: {failure.strerror}; give another path, or correct its permissions"


def _report_bug(bug: Exception) -> None:
    import platform
    import traceback

    packages = ("numba", "llvmlite", "numpy", "pydantic", "h5py", "pyvista", "click")
    versions = "\n".join(f"{package} {_version(package)}" for package in packages)
    system = f"Python {platform.python_version()} on {platform.platform()}"
    trace = "".join(traceback.format_exception(bug))
    report = f"mpmcol {__version__}\ncommand: {' '.join(sys.argv)}\n{system}\n{versions}\n\n{trace}"
    streams.report(f"internal error: {type(bug).__name__}: {bug}")
    streams.report(f"Please report this error with {_write_report(report)}")


def _write_report(report: str) -> str:
    import tempfile

    for folder in (Path.cwd(), Path(tempfile.gettempdir())):
        path = folder / "crash-report.txt"
        try:
            path.write_text(report, encoding="utf-8", errors="replace")
            return str(path)
        except OSError:
            continue
    return "the following text:\n" + report


@click.group(cls=Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="mpmcol")
@click.pass_context
def main(ctx: click.Context) -> None:
    """Simulate the collapse of granular columns with the material point method.

    First steps: mpmcol run quickstart; mpmcol plot runs/quickstart; mpmcol cases; mpmcol init quickstart > my.toml.
    For the options of a command: mpmcol COMMAND --help.
    """
    os.environ["MPLBACKEND"] = "agg"  # charts are files; a notebook's or a window's backend may not exist here
    if os.environ.get("NO_COLOR"):
        ctx.color = False
