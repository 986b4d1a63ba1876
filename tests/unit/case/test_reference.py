"""Explanations of keys and the JSON schema."""

from __future__ import annotations

import json
from typing import Any

import pytest

from mpmcol.case import explain, json_schema, key_names
from mpmcol.errors import UsageError
from mpmcol.mpm.constitutive import LAWS


@pytest.mark.parametrize("key", key_names())
def test_every_key_is_explained(key: str) -> None:
    text = explain(key)
    assert key in text.split("\n")[0]
    assert len(text.split("\n")) >= 2
    assert "does not exist" not in text and "None" not in text


def test_an_explanation_holds_unit_bounds_default_and_law() -> None:
    assert explain("grid.spacing") == "grid.spacing\n    grid node spacing h\n    a number > 0, in m; required"
    assert '"gravity" or "k0"; default "gravity"' in explain("stages")
    assert "laws: mohr-coulomb-softening" in explain("material.softening_rate")
    assert all(key in explain() for key in key_names())


@pytest.mark.parametrize(
    ("key", "meant"),
    [
        ("grid.spacng", "grid.spacing"),
        ("spacing", "grid.spacing"),
        ("stages.collaps.damping", "stages.collapse.damping"),
    ],
)
def test_an_unknown_key_is_reported_with_the_nearest_key(key: str, meant: str) -> None:
    with pytest.raises(UsageError, match=f'Did you mean "{meant}"?'):
        explain(key)


def test_the_json_schema_is_draft_4_without_references() -> None:
    schema = json_schema()
    assert schema["$schema"] == "http://json-schema.org/draft-04/schema#"
    text = json.dumps(schema, allow_nan=False)
    for later in ("$ref", "$defs", "const", "discriminator"):
        assert f'"{later}"' not in text
    for part in parts_of(schema):
        assert isinstance(part.get("exclusiveMinimum", True), bool)
        assert isinstance(part.get("exclusiveMaximum", True), bool)
        assert part.get("required") != []
    assert schema["properties"]["grid"]["properties"]["spacing"] == {
        "description": "grid node spacing h (a number > 0, in m)",
        "type": ["number", "string"],
        "minimum": 0,
        "exclusiveMinimum": True,
    }
    laws = [part["properties"]["law"]["enum"] for part in schema["properties"]["material"]["oneOf"]]
    assert laws == [[law] for law in LAWS]


def parts_of(schema: Any) -> list[dict[str, Any]]:
    if isinstance(schema, list):
        return [part for item in schema for part in parts_of(item)]
    if not isinstance(schema, dict):
        return []
    return [schema, *(part for item in schema.values() for part in parts_of(item))]


def test_the_json_schema_describes_every_key() -> None:
    described = set(described_keys(json_schema()))
    assert described == set(key_names())


def described_keys(schema: dict[str, Any], prefix: str = "") -> list[str]:
    keys = []
    for table in schema.get("oneOf", [schema, *schema.get("anyOf", [])]):
        for name, part in table.get("properties", {}).items():
            assert part["description"]
            keys += [prefix + name, *described_keys(part, f"{prefix}{name}.")]
    return keys
