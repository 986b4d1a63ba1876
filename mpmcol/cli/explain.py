"""mpmcol explain: what the keys of a case file mean."""

from __future__ import annotations

import click


@click.command()
@click.argument("key", default="")
def explain(key: str) -> None:
    """Explain KEY of a case file, such as grid.spacing, or a table, such as grid; or all of them."""
    from mpmcol.case import explain as explain_key

    click.echo(explain_key(key))
