"""JSON text and flat tables of nested values."""

from __future__ import annotations

import json
from math import inf, nan

from mpmcol.io.values import flatten, to_json, toml_notation

NESTED = {"a": 1, "front": {"max": {"mean": 0.5, "min": nan}}, "list": [inf, (2.0, "x")]}


def test_measured_numbers_that_are_not_finite_become_null() -> None:
    expected = {"a": 1, "front": {"max": {"mean": 0.5, "min": None}}, "list": [None, [2.0, "x"]]}
    assert json.loads(to_json(NESTED)) == expected


def test_inputs_that_are_not_finite_are_written_in_the_notation_of_toml() -> None:
    assert json.loads(to_json({"gate_speed": inf, "low": -inf}, toml_notation)) == {"gate_speed": "inf", "low": "-inf"}


def test_flat_names_are_dotted() -> None:
    flat = dict(flatten({"a": 1, "front": {"max": {"mean": 0.5, "min": 0.1}}}))
    assert flat == {"a": 1, "front.max.mean": 0.5, "front.max.min": 0.1}


def test_unnamed_keys_add_nothing_to_the_name() -> None:
    flat = dict(flatten({"front": {"max": {"mean": 0.5, "min": 0.1}}}, unnamed=("mean",)))
    assert flat == {"front.max": 0.5, "front.max.min": 0.1}
