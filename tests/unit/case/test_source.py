"""Reading of case files: extends, missing and damaged files."""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from mpmcol.case import load_case, shipped_cases
from mpmcol.errors import CaseError
from tests.support.case_files import GOOD, Write, only_problem, problems_of


def test_keys_replace_those_of_the_extended_case(write: Write) -> None:
    write('extends = "lube-quarter"\ntitle = "mine"\n[grid]\nspacing = 0.01\n[stages]\ncollapse = { damping = 0.02 }\n')
    case, parent = load_case("my.toml"), load_case("lube-quarter")
    assert (case.title, case.grid.spacing, case.stages.collapse.damping) == ("mine", 0.01, 0.02)
    assert case.grid.points_per_cell == parent.grid.points_per_cell == 8
    assert case.stages.equilibrate == parent.stages.equilibrate and case.method == parent.method
    assert case.stages.equilibrate.damping == 0.7


def test_a_height_replaces_the_aspect_ratio_of_the_extended_case(write: Write) -> None:
    write('extends = "coarse-channel"\n[geometry]\nheight = 0.18\n')
    assert load_case("my.toml").geometry.a == pytest.approx(2.0)


def test_a_material_with_another_law_replaces_that_of_the_extended_case() -> None:
    child, parent = load_case("lube-channel-loose"), load_case("lube-channel")
    assert child.geometry == parent.geometry
    assert child.material.law == child.stages.equilibrate.law == "mohr-coulomb-softening"
    assert child.material.model_dump()["friction_peak_deg"] == 39.0


def test_a_path_in_extends_is_relative_to_the_file(write: Write) -> None:
    Path("folder").mkdir()
    write(GOOD, "folder/parent.toml")
    write('extends = "parent.toml"\n[grid]\nspacing = 0.003\n', "folder/child.toml")
    case = load_case("folder/child.toml")
    assert (case.grid.spacing, case.title) == (0.003, "test")


def test_a_problem_of_the_extended_case_is_reported_in_its_file(write: Write) -> None:
    Path("folder").mkdir()
    write(GOOD.replace("0.002", "-1"), "folder/parent.toml")
    write('extends = "parent.toml"\n\n[time]\ncfl = 3\n', "folder/child.toml")
    problems = problems_of("folder/child.toml")
    assert [(problem.file, problem.line) for problem in problems] == [
        ("folder/child.toml", 4),
        ("folder/parent.toml", 10),
    ]


@pytest.mark.parametrize(
    ("extends", "message"),
    [
        ('"my.toml"', "the case extends itself, directly or through another case"),
        ('"lube-chanel"', "no such case file"),
        ("3", "expected the name of a shipped case or a path, in quotes"),
        ('""', "no such case file"),
        (f'"{"x" * 3000}"', "no such case file"),
    ],
)
def test_an_invalid_extends_is_reported(write: Write, extends: str, message: str) -> None:
    problem = only_problem(write(f"schema = 1\nextends = {extends}\n"))
    assert (problem.file, problem.line, problem.message) == ("my.toml", 2, f"extends: {message}")
    assert ("lube-channel" in problem.hint) == ("lube" in extends)


def test_a_missing_file_is_reported_with_the_nearest_shipped_case(write: Write) -> None:
    for source in ("quikstart", "cases/quickstart.toml", Path("quickstart.toml")):
        assert 'did you mean the shipped case "quickstart"?' in only_problem(source).hint
    assert "mpmcol cases" in only_problem("a\0b").hint
    assert "no such case file" in only_problem("x" * 5000).message


def test_a_file_written_by_the_shell_of_windows_is_read(write: Write) -> None:
    write('extends = "coarse-channel"\r\ntitle = "mine"\r\n'.encode("utf-16"))
    assert load_case("my.toml").title == "mine"


@pytest.mark.parametrize(
    ("content", "line", "message"),
    [
        (b"a = 1\nb = mm\n", 2, "not valid TOML: Invalid value"),
        (b"a = 2 mm\n", 1, "not valid TOML: Expected newline"),
        (b"a = 1\n\na = 2\n", 3, "Cannot overwrite a value"),
        (b"\n[grid\n", 2, "not valid TOML"),
        (b"a = 1\nb = '\xff'\n", 2, "not valid UTF-8"),
        (b"a = " + b"1" * 5000, 1, "integer with more than 64 bits"),
        (b"a = [[0x" + b"f" * 5000 + b"]]", 1, "integer with more than 64 bits"),
        (b"a = " + b"[" * 20000, 1, "nested too deeply"),
        (b"#" * 200_001, None, "larger than 200 kB"),
        (b"\xff\xfea", 1, "not valid UTF-8"),
    ],
)
def test_a_file_that_cannot_be_parsed_is_reported_with_its_line(
    write: Write, content: bytes, line: int | None, message: str
) -> None:
    problem = only_problem(write(content))
    assert (problem.file, problem.line) == ("my.toml", line)
    assert message in problem.message


def test_an_unquoted_string_is_reported_with_a_hint(write: Write) -> None:
    assert "strings in quotes" in only_problem(write(GOOD.replace('"plane"', "plane"))).hint
    assert "unit in quotes" in only_problem(write(GOOD.replace("0.002", "2 mm"))).hint


@pytest.mark.parametrize(
    ("text", "line", "table"),
    [
        ("[geometry]\nradius = 1\n[geometry]\naspect = 1\n", 3, "geometry"),
        ("[stages.collapse]\n[stages.collapse]\n", 2, "stages.collapse"),
        ("grid = { spacing = 1 }\ngrid.points_per_cell = 4\n", 2, "grid"),
        ("[a.b]\n[a]\nb.c = 1\n", 3, "a.b"),
        ("[[layers]]\n[layers]\n", 2, "layers"),
    ],
)
def test_a_table_that_is_given_twice_is_named_as_in_the_file(write: Write, text: str, line: int, table: str) -> None:
    problem = only_problem(write(text))
    assert (problem.line, problem.message) == (line, f"not valid TOML: [{table}] is given twice")
    assert problem.hint == "give all keys of a table below one header"


def test_a_folder_is_not_a_case(tmp_path: Path) -> None:
    assert "is a folder; expected a case file" in only_problem(tmp_path).message


def test_random_damage_is_loaded_or_reported_as_a_case_error(write: Write) -> None:
    generator = random.Random(20260605)
    texts = [path.read_bytes() for path in shipped_cases().values()]
    refused = 0
    for _ in range(400):
        content = bytearray(generator.choice(texts))
        for _ in range(generator.randint(1, 4)):
            at = generator.randrange(len(content))
            content[at : at + generator.randint(0, 3)] = generator.choice(
                [b"[", b"=", b'"', b"9", b"\xff", b".", b"\n"]
            )
        try:
            load_case(write(bytes(content)))
        except CaseError as error:
            refused += 1
            assert "my.toml" in str(error)
    assert refused > 100


def test_windows_line_ends_and_a_byte_order_mark_are_accepted(write: Write) -> None:
    text = b"\xef\xbb\xbf" + GOOD.replace("\n", "\r\n").encode()
    assert load_case(write(text)).title == "test"
    bad = only_problem(write(text.replace(b"spacing", b"spacng")))
    assert (bad.line, bad.text) == (10, "spacng = 0.002")


@pytest.mark.parametrize(
    ("line", "hint"),
    [
        ("friction_deg = yes", "write true or false, in small letters"),
        ("friction_deg = True # x", "write true or false, in small letters"),
        ("friction_deg = 33,5", "the decimal separator is a point"),
        ("friction_deg = -0,5 # x", "the decimal separator is a point"),
        ("friction_deg = .5", "write a digit before the decimal point"),
        ('friction_deg = "33 deg', "close the quotes at the end of the value"),
        ("friction_deg = '33 deg", "close the single quotes at the end of a value"),
        ("friction_deg = 33.", "write a digit after the decimal point"),
        ("youngs_modulus = 5.e6 # Pa", "write a digit after the decimal point"),
        ("grid:", "a case file is TOML: [table], then key = value"),
        ("  spacing: 0.005", "a case file is TOML: [table], then key = value"),
        ("- from: 0.1", "a case file is TOML: [table], then key = value"),
        ('{ "grid": 3 }', "a case file is TOML: [table], then key = value"),
        ("friction_deg = 33 deg", "put strings and numbers with a unit in quotes"),
        (r'title = "C:\Users\me"', "write paths with / or in single quotes"),
        (r'extends = "..\cases\coarse-channel"', "write paths with / or in single quotes"),
    ],
)
def test_the_hint_at_a_syntax_error_names_its_cause(write: Write, line: str, hint: str) -> None:
    assert only_problem(write(f"schema = 1\n{line}\n")).hint == hint


@pytest.mark.parametrize("name", [r"data\new", r"my\table", r"my\box", r"my\form", r"my\red"])
@pytest.mark.parametrize("key", ['extends = "{}.toml"', '[geometry]\noutline = "{}.csv"'])
def test_a_path_with_an_escape_sequence_gets_a_hint(write: Write, key: str, name: str) -> None:
    """TOML reads the backslash and the letter after it as one character, and the file is not found."""
    assert only_problem(write(f"{key.format(name)}\n")).hint == "write paths with / or in single quotes"


def test_other_formats_and_folders_are_recognised(write: Write) -> None:
    write("schema: 1\n", "case.yaml")
    assert only_problem("case.yaml").hint == "a case file is TOML: [table], then key = value"
    Path("folder").mkdir()
    write(GOOD, "folder/case.toml")
    problem = only_problem("folder")
    assert problem.message == "is a folder; expected a case file" and "folder/case.toml" in problem.hint
