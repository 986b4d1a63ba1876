"""Case files: schema, loading, checking, overrides, and writing with all defaults resolved."""

from __future__ import annotations

from mpmcol.case.conditions import (
    applicable_experiments,
    common_experiments,
    compared_experiment,
    conditions_of,
    experiment_of,
)
from mpmcol.case.load import flattened_text, load_case, located, resolved_toml
from mpmcol.case.markdown import markdown_reference
from mpmcol.case.problem import Problem
from mpmcol.case.reference import explain, hint_for, json_schema, key_names, keys_with
from mpmcol.case.schema import Case
from mpmcol.case.source import shipped_cases
from mpmcol.case.values import case_hash

__all__ = [
    "Case",
    "Problem",
    "applicable_experiments",
    "case_hash",
    "common_experiments",
    "compared_experiment",
    "conditions_of",
    "experiment_of",
    "explain",
    "flattened_text",
    "hint_for",
    "json_schema",
    "key_names",
    "keys_with",
    "load_case",
    "located",
    "markdown_reference",
    "resolved_toml",
    "shipped_cases",
]
