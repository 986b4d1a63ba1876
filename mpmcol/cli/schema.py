"""mpmcol schema: the JSON schema of case files, for editors."""

from __future__ import annotations

import json

import click


@click.command()
def schema() -> None:
    """Print the JSON schema of case files.

    Write it beside a case file, and begin that file with the line: #:schema ./mpmcol.schema.json
    """
    from mpmcol.case import json_schema

    click.echo(json.dumps(json_schema(), indent=2))
