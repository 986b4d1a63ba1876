"""mpmcol cases and mpmcol init: the cases that come with mpmcol."""

from __future__ import annotations

import click


@click.command()
def cases() -> None:
    """List the cases that come with mpmcol."""
    from mpmcol.case import load_case, shipped_cases

    names = list(shipped_cases())
    width = max(map(len, names), default=0)
    for name in names:
        click.echo(f"{name:{width}}  {load_case(name).title}")


@click.command()
@click.argument("name")
def init(name: str) -> None:
    """Print the file of the shipped case NAME, to start an own one from: mpmcol init quickstart > my.toml"""
    from mpmcol.case import flattened_text, shipped_cases
    from mpmcol.case.fields import nearest
    from mpmcol.errors import UsageError

    names = shipped_cases()
    if name not in names:
        near = nearest(name, names)
        meant = f' Did you mean "{near}"?' if near else ""
        raise UsageError(f'there is no shipped case "{name}".{meant} They are: {", ".join(names)}')
    click.echo(flattened_text(name), nl=False)
