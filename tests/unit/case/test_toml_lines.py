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
        ("l", "0"): 13,
    }


def test_lines_of_arrays_of_tables() -> None:
    text = "[[l]]\na.b = 1\n# [[l]]\n\n[[l]]\na = 2\n[l.c]\nd = 3\n[e]\nf = [\n{ g = 1 }, { g = 2 }]\n"
    assert dict(locate(text)) == {
        ("l",): 1,
        ("l", "0"): 1,
        ("l", "0", "a"): 2,
        ("l", "0", "a", "b"): 2,
        ("l", "1"): 5,
        ("l", "1", "a"): 6,
        ("l", "1", "c"): 7,
        ("l", "1", "c", "d"): 8,
        ("e",): 9,
        ("e", "f"): 10,
        ("e", "f", "0"): 10,
        ("e", "f", "0", "g"): 10,
        ("e", "f", "1"): 10,
        ("e", "f", "1", "g"): 10,
    }
