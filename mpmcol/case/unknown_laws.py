"""Problems beside a law that does not exist, which decides the other keys of its table."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from mpmcol.case.fields import nearest
from mpmcol.mpm.constitutive import LAWS

_TABLES = ("material", "base_material")
_COMMON = "elastic"  # whose keys all laws have
_ABOUT_LAW = ("union_tag_invalid", "union_tag_not_found")


class Errors(NamedTuple):
    """Errors of a case, and its tables with a law where the given one does not exist or is missing."""

    tables: dict[str, Any]
    found: list[ErrorDetails]


def errors_beside_law(tables: dict[str, Any], invalid: ValidationError, validate: Callable[[Any], Any]) -> Errors:
    """All errors of the tables of a case, also those of keys beside a law that does not exist or is missing.

    The keys are checked with the law of the most similar name; without one, those that all laws have.
    """
    errors = invalid.errors(include_url=False)
    of_laws = {
        name: error for error in errors if (name := _table_without_law(error)) and isinstance(tables[name], dict)
    }
    similar = {name: _similar(tables[name].get("law")) for name in of_laws}
    assumed = tables | {name: {**tables[name], "law": law or _COMMON} for name, law in similar.items()}
    if not of_laws:
        return Errors(tables, errors)
    unsure = {name for name, law in similar.items() if law is None}
    beside = [error for error in _errors(assumed, validate) if not _may_follow(error, unsure)]
    return Errors(assumed, [*of_laws.values(), *beside])


def _errors(tables: dict[str, Any], validate: Callable[[Any], Any]) -> list[ErrorDetails]:
    try:
        validate(tables)
    except ValidationError as invalid:
        return invalid.errors(include_url=False)
    return []


def _table_without_law(error: ErrorDetails) -> str:
    """The table of a material of which an error reports that its law is no known one; "" for other errors."""
    location = error["loc"]
    is_of_law = error["type"] in _ABOUT_LAW and len(location) == 1 and location[0] in _TABLES
    return str(location[0]) if is_of_law else ""


def _similar(law: Any) -> str | None:
    return nearest(law, LAWS) if isinstance(law, str) else None


def _may_follow(error: ErrorDetails, unsure: set[str]) -> bool:
    """Whether an error may follow from the assumed law of tables: an unknown key, or a material of a layer."""
    location = (*error["loc"], *error.get("ctx", {}).get("inside", ()))
    if location[:1] == ("layers",):
        return "material" in unsure and "material" in location
    return location[:1] != () and location[0] in unsure and error["type"] == "extra_forbidden"
