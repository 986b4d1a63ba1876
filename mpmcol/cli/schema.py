"""`mpmcol explain` and `mpmcol schema`: documentation of the keys of a case file."""

from __future__ import annotations

import json

import click


@click.command()
@click.argument("key", default="")
@click.option("--markdown", is_flag=True, help="Print the reference of all shipped cases and keys in Markdown.")
def explain(key: str, markdown: bool) -> None:
    """Explain the keys of a case file.

    KEY is a key such as grid.spacing, or a table such as grid. Prints meaning, unit, bounds and default; without KEY,
    of all keys.
    """
    from mpmcol.case import explain as explain_key
    from mpmcol.case import markdown_reference

    if markdown and key:
        raise click.UsageError("--markdown prints all keys: remove KEY")
    click.echo(markdown_reference() if markdown else explain_key(key), nl=not markdown)


@click.command()
def schema() -> None:
    """Print the JSON schema of case files, for editors.

    Save it beside a case file, and begin that file with this line:

    \b
        #:schema ./mpmcol.schema.json
    """
    from mpmcol.case import json_schema

    click.echo(json.dumps(json_schema(), indent=2))
