"""`mpmcol explain` and `mpmcol schema`: documentation of the keys of a case file and of the names in results."""

from __future__ import annotations

import json

import click


@click.command()
@click.argument("key", default="")
@click.option("--markdown", is_flag=True, help="Print the reference of all shipped cases and keys in Markdown.")
def explain(key: str, markdown: bool) -> None:
    """Explain keys of a case file and names in results.

    KEY is a key such as grid.spacing, a table such as grid, or a name in the results such as zeta or front_height.
    Prints meaning and unit, and bounds and default of keys; without KEY, of all keys. mpmcol explain results lists the
    names in result.json, in the output of mpmcol measure, and in CSV files.
    """
    from mpmcol.case import markdown_reference

    if markdown and key:
        raise click.UsageError("--markdown prints all keys: remove KEY")
    click.echo(markdown_reference() if markdown else _explanation(key), nl=not markdown)


def _explanation(key: str) -> str:
    """Explanations of a key of a case, of a name in results, or of both.

    Raises UsageError if there is neither.
    """
    from mpmcol.case import explain as explain_key
    from mpmcol.case import hint_for, key_names, shipped_cases
    from mpmcol.case.not_modelled import answer_to
    from mpmcol.case.reference import without_index
    from mpmcol.io.columns import explain_name, explain_names, explain_word

    key = without_index(key)
    if key == "results":
        return explain_names()
    found = [explain_key(key)] if not key or key in key_names() else []
    found += [text for text in [explain_name(key)] if key and text]
    if found and (answer := answer_to(tuple(key.split(".")))) and key not in key_names():
        found.append(f"In a case file, {answer}.")
    if not found and key in shipped_cases():
        raise click.UsageError(f"{key} is a shipped case, not a key; mpmcol init {key} prints it")
    if not found and not hint_for(key):
        found = [explain_word(key) or _places_of(key)]
    return "\n\n".join(found) or explain_key(key)  # which raises


def _places_of(text: str) -> str:
    """The keys and the names in results that contain a text, or whose explanations do. Raises UsageError."""
    from mpmcol.case import keys_with
    from mpmcol.case.fields import nearest, shown
    from mpmcol.errors import UsageError
    from mpmcol.io.columns import names_with

    if not (places := keys_with(text) | names_with(text)):
        name = nearest(text, (full.rpartition(".")[2] for full in names_with("")))
        near = f' Did you mean "{name}"?' if name else ""
        raise UsageError(
            f"there is no key or name {shown(text)}.{near} (mpmcol explain lists all keys, mpmcol explain results all "
            "names in results)"
        )
    listed = "\n".join(f"  {name}\n      {meaning}" for name, meaning in places.items())
    return f"there is no key or name {shown(text)}; it occurs in:\n{listed}"


@click.command()
def schema() -> None:
    """Print the JSON schema of case files, for editors.

    Save it beside a case file, and begin that file with this line:

    \b
        #:schema ./mpmcol.schema.json
    """
    from mpmcol.case import json_schema

    click.echo(json.dumps(json_schema(), indent=2))
