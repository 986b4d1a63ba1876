"""Loading and checking of case files, and writing of resolved cases."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import tomli_w
from pydantic import ValidationError

from mpmcol.case.diagnostics import find_problems, problem_of
from mpmcol.case.overrides import Override, Overrides, assignments, parse_override
from mpmcol.case.problem import Problem, case_error, set_option
from mpmcol.case.schema import Case
from mpmcol.case.source import read_case, read_chain
from mpmcol.case.title import with_own_aspect
from mpmcol.case.toml_lines import KeyPath
from mpmcol.case.unknown_laws import errors_beside_law
from mpmcol.errors import UnfitCase


def load_case(source: str | Path, overrides: Overrides = ()) -> Case:
    """Load and check a case.

    Args:
        source: path of a TOML file, or name of a shipped case.
        overrides: assignments such as "geometry.aspect=3", whose values are TOML or bare strings, or a mapping such as
            {"geometry.aspect": 3}. An override of geometry.height removes geometry.aspect of the file, and vice versa.

    Raises:
        TypeError: a value of the mapping is none of TOML.
        CaseError: the case is invalid; lists all problems with file, line, key and remedy.
    """
    parsed, problems = _parsed(overrides)
    given = read_case(source, parsed)
    try:
        case = Case.model_validate(given.tables)
    except ValidationError as invalid:
        errors = errors_beside_law(given.tables, invalid, Case.model_validate)
        problems = find_problems(given, *errors) + problems
    if problems:
        raise case_error(problems)
    return with_own_aspect(case)


@contextmanager
def located(source: str | Path, overrides: Overrides) -> Iterator[None]:
    """Raise each UnfitCase of the block as a CaseError, with file and line; arguments as of `load_case`."""
    try:
        yield
    except UnfitCase as unfit:
        given, key = read_case(source, _parsed(overrides)[0]), tuple(unfit.key.split("."))
        raise case_error([problem_of(given, key, unfit.message, unfit.remedy, key)]) from None


def _parsed(overrides: Overrides) -> tuple[dict[KeyPath, Override], list[Problem]]:
    parsed: dict[KeyPath, Override] = {}
    problems: list[Problem] = []
    for argument in assignments(overrides):
        try:
            override = parse_override(argument)
            parsed[override.key] = override
        except ValueError as wrong:
            problems.append(Problem(set_option(argument), None, "", str(wrong), ""))
    return parsed, problems


def resolved_toml(case: Case, derived: Mapping[str, str | float] | None = None) -> str:
    """TOML text of a case with all defaults resolved; loading it gives an equal case.

    Args:
        case: the case.
        derived: derived numbers (time step, number of points, ...), appended as comments.
    """
    values = case.model_dump(by_alias=True, exclude_none=True)
    tables = {key: value for key, value in values.items() if value != {}}
    tables["material"] = {"law": case.material.law} | tables["material"]
    for array in ("layers", "walls"):
        if not tables[array]:
            del tables[array]
    if case.stages.initial_stress != "k0":  # without effect, and another one with another friction angle
        del tables["stages"]["k0"]
    comments = [f"# {name} = {value}" for name, value in (derived or {}).items()]
    return tomli_w.dumps(tables) + "\n".join(["", "# derived:", *comments, ""] if comments else [])


def flattened_text(source: str | Path) -> str:
    """Text of a shipped case, comments included, with the keys inherited from the cases that it extends.

    Each key must have a line of its own.
    """
    blocks: dict[str, str] = {}
    for link in reversed(read_chain(source)):
        own = _blocks(link.text)
        blocks |= {header: _merge_lines(blocks.get(header, ""), block) for header, block in own.items()}
    return "\n".join(block.rstrip("\n") + "\n" for block in blocks.values())


def _blocks(text: str) -> dict[str, str]:
    """Blocks of a case file by table header; the block before the first header has the key ""."""
    alone = re.sub(r"^extends\b.*\n", "", text, flags=re.MULTILINE)
    parts = re.split(r"^(?=\[)", alone, flags=re.MULTILINE)
    return {part.partition("]")[0] if part.startswith("[") else "": part for part in parts}


def _merge_lines(inherited: str, own: str) -> str:
    """Text of a table in which its own lines replace the inherited ones, as in `merge_cases`."""
    old, new = _key_lines(inherited), _key_lines(own)
    has_other_law = "law" in old and "law" in new and tomllib.loads(old["law"]) != tomllib.loads(new["law"])
    if not own.startswith("[") or has_other_law:
        return own
    kept = [new.pop(_key(line), line) for line in inherited.splitlines()]
    return "\n".join([*kept, *new.values()] if kept else [own])


def _key_lines(block: str) -> dict[str, str]:
    return {_key(line): line for line in block.splitlines() if _key(line)}


def _key(line: str) -> str:
    """The key that a line gives a value; "" for a comment, a header or an empty line."""
    return line.partition("=")[0].strip() if re.match(r"\w+\s*=", line) else ""
