"""The resolved text of a case."""

from __future__ import annotations

import pytest

from mpmcol.case import case_hash, key_names, load_case, resolved_toml, shipped_cases
from tests.support.case_files import Write


@pytest.mark.parametrize("name", shipped_cases())
def test_the_resolved_text_loads_to_an_equal_case(write: Write, name: str) -> None:
    case = load_case(name)
    text = resolved_toml(case, {"dt_s": 1e-5, "points": 36450})
    assert load_case(write(text)) == case
    assert case_hash(load_case("my.toml")) == case_hash(case)
    assert "# dt_s = 1e-05\n# points = 36450\n" in text


def test_the_resolved_text_has_every_key_that_has_a_value() -> None:
    text = resolved_toml(load_case("coarse-channel"))
    for key in key_names(("method",)) + key_names(("stages", "equilibrate")):
        assert f"\n{key.rpartition('.')[2]} = " in text
