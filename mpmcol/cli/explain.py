"""mpmcol explain: reference of the keys of a case file."""

from __future__ import annotations

import click


@click.command()
@click.argument("key", default="")
@click.option("--markdown", is_flag=True, help="Print the reference of all shipped cases and keys in Markdown.")
def explain(key: str, markdown: bool) -> None:
    """Explain KEY of a case file, such as grid.spacing, or a table, such as grid; all keys by default."""
    from mpmcol.case import explain as explain_key
    from mpmcol.case import markdown_reference

    if markdown and key:
        raise click.UsageError("--markdown prints all keys: remove KEY")
    click.echo(markdown_reference() if markdown else explain_key(key), nl=not markdown)
