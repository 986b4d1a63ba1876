"""From a case file to a checked Case, and back to a file with all defaults filled in."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import tomli_w
from pydantic import ValidationError

from mpmcol.case.problems import Problem, bad_override, find_problems, report
from mpmcol.case.schema import Case
from mpmcol.case.source import KeyPath, parse_override, read_case, read_chain
from mpmcol.errors import CaseError


def load_case(source: str | Path, overrides: Sequence[str] = ()) -> Case:
    """Load and check a case.

    source: path of a TOML file, or the name of a shipped case.
    overrides: "geometry.aspect=3", TOML values; bare words are texts. Giving geometry.height replaces
    geometry.aspect of the file, and the other way round.
    Raises CaseError with all problems at once, each with file, line, key and how to mend it.
    """
    values, problems = _parsed(overrides)
    given = read_case(source, values)
    try:
        case = Case.model_validate(given.tables)
    except ValidationError as invalid:
        problems += find_problems(given, invalid)
    if problems:
        raise CaseError(report(problems), tuple(problems))
    return case


def _parsed(overrides: Sequence[str]) -> tuple[dict[KeyPath, tuple[str, Any]], list[Problem]]:
    values: dict[KeyPath, tuple[str, Any]] = {}
    problems: list[Problem] = []
    for argument in overrides:
        try:
            key, value = parse_override(argument)
            values[key] = (argument, value)
        except ValueError as wrong:
            problems.append(bad_override(argument, str(wrong)))
    return values, problems


def resolved_toml(case: Case, derived: Mapping[str, str | float] | None = None) -> str:
    """Write a case with all defaults filled in; it loads back to an equal case.

    derived: numbers that follow from the case (time step, points, ...); they are added as comments.
    """
    tables = case.model_dump(by_alias=True, exclude_none=True)
    tables["material"] = {"law": case.material.law} | tables["material"]
    text = tomli_w.dumps(tables)
    comments = [f"# {name} = {value}" for name, value in (derived or {}).items()]
    return text + "\n".join(["", "# derived:", *comments, ""] if comments else [])


def flattened_text(source: str | Path) -> str:
    """Give the text of a case, comments included, with the tables that it takes over from other files."""
    texts = [link.text for link in reversed(read_chain(source))]
    blocks: dict[str, str] = {}
    for text in texts:
        blocks |= _blocks(text)
    return "\n".join(block.rstrip("\n") + "\n" for block in blocks.values())


def _blocks(text: str) -> dict[str, str]:
    """Split a case file before each line that begins with a table's header; the first block has no header."""
    parts = re.split(r"^(?=\[)", re.sub(r"^extends\b.*\n", "", text, flags=re.MULTILINE), flags=re.MULTILINE)
    return {part.partition("]")[0] if part.startswith("[") else "": part for part in parts}
