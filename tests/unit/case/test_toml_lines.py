"""Line numbers of keys."""

from __future__ import annotations

from mpmcol.case.toml_lines import locate


def test_lines_of_all_kinds_of_statements() -> None:
    text = 'a = """\n[b]\n"""\n# [c]\n[d]\n\ne.f = 1\n"g h" = [\n 1,\n]\n[d.i]\nj = { k = 1 }\n[[l]]\n'
    assert dict(locate(text)) == {
        ("a",): 1,
        ("d",): 5,
        ("d", "e"): 7,
        ("d", "e", "f"): 7,
        ("d", "g h"): 8,
        ("d", "i"): 11,
        ("d", "i", "j"): 12,
        ("d", "i", "j", "k"): 12,
        ("l",): 13,
    }
