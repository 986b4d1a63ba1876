"""`mpmcol cases` and `mpmcol init`: the shipped cases."""

from __future__ import annotations

from pathlib import Path

import click


@click.command()
def cases() -> None:
    """List the shipped cases.

    Each can be run by its name: mpmcol run NAME.
    """
    from mpmcol.case import load_case, shipped_cases

    names = list(shipped_cases())
    width = max(map(len, names), default=0)
    for name in names:
        click.echo(f"{name:{width}}  {load_case(name).title}")


@click.command()
@click.argument("name")
def init(name: str) -> None:
    """Print a shipped case as a template for your own case.

    NAME is a shipped case (mpmcol cases). Example:

    \b
        mpmcol init quickstart > my.toml
    """
    from mpmcol.case import flattened_text, shipped_cases
    from mpmcol.case.fields import nearest
    from mpmcol.errors import UsageError

    names = shipped_cases()
    if name not in names and Path(name).is_file():
        raise UsageError(f"{name} is a file already; mpmcol init prints shipped cases (mpmcol cases)")
    if name not in names:
        near = nearest(name, names)
        hint = f' Did you mean "{near}"?' if near else ""
        raise UsageError(f'no shipped case "{name}".{hint} Expected one of: {", ".join(names)}')
    click.echo(flattened_text(name), nl=False)
