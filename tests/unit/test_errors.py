"""Selection by names and groups of names."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from mpmcol.errors import UsageError, select, suggestion

ITEMS = [SimpleNamespace(name=name) for name in ("group-one", "group-two", "groups")]


@pytest.mark.parametrize(
    ("names", "selected"),
    [
        ([], ["group-one", "group-two", "groups"]),
        (["group"], ["group-one", "group-two"]),
        (["groups", "group-two"], ["group-two", "groups"]),
        (["group", "group-one"], ["group-one", "group-two"]),
    ],
)
def test_names_select_items_and_groups_in_the_order_of_the_items(names: list[str], selected: list[str]) -> None:
    assert [item.name for item in select(ITEMS, names, "item")] == selected


def test_an_unknown_name_is_rejected_with_a_suggestion() -> None:
    with pytest.raises(UsageError, match="no item is called 'group-on'; did you mean 'group-one'?"):
        select(ITEMS, ["group", "group-on"], "item")


def test_without_a_similar_name_the_suggestion_lists_all_names() -> None:
    assert suggestion("x", ["first", "second"]) == "known: first, second"
