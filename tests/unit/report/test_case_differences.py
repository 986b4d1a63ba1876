"""Differences between the cases of several runs, whatever tables and keys these have."""

from __future__ import annotations

from itertools import permutations
from types import SimpleNamespace
from typing import Any

import pytest

from mpmcol.case import load_case
from mpmcol.case.values import leaf_values
from mpmcol.report.provenance import ABSENT, case_differences, with_unit

CASES = (  # of different structure
    "channel", "quarter", "dam", "layered-column", "heap", "granular-bed", "cohesive-column", "mu-i-cylinder",
    "lube-channel-dense", "inclined-channel",
)  # fmt: skip


def differences(*names: str) -> dict[str, list[str]]:
    runs: Any = [SimpleNamespace(case=load_case(name)) for name in names]
    return {key: cells for key, *cells in case_differences(runs, names).rows}


@pytest.mark.parametrize("names", list(permutations(CASES, 2)))
def test_all_keys_that_differ_are_shown_for_cases_of_any_structure(names: tuple[str, str]) -> None:
    first, second = (leaf_values(load_case(name)) for name in names)
    expected = {key for key in first.keys() | second.keys() if first.get(key) != second.get(key)} - {"title"}
    found = differences(*names)
    assert found.keys() == {with_unit(key) for key in expected}
    for key in expected - second.keys():
        assert found[with_unit(key)][1] == ABSENT


def test_a_key_that_only_the_last_case_has_is_shown() -> None:
    assert differences("channel", "channel", "dam")["walls.0.name"] == [ABSENT, ABSENT, load_case("dam").walls[0].name]
