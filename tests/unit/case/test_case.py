"""Case files: what is accepted, and that every message names file, line, key and remedy."""

from __future__ import annotations

import json
import math
import random
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

from mpmcol.case import (
    Case,
    Problem,
    case_hash,
    explain,
    flattened_text,
    json_schema,
    key_names,
    load_case,
    resolved_toml,
    shipped_cases,
)
from mpmcol.case.toml_lines import locate
from mpmcol.errors import CaseError, UsageError
from mpmcol.mpm.constitutive import LAWS

GOOD = """\
schema = 1
title = "test"

[geometry]
model = "plane"
radius = 0.09
aspect = 3.0

[grid]
spacing = 0.002

[material]
law = "mohr-coulomb"
density = 2650.0
youngs_modulus = 10e6
poissons_ratio = 0.2
friction_deg = 33.0
"""
SHIPPED = [
    "bui-rods",
    "lube-channel",
    "lube-channel-dense",
    "lube-channel-loose",
    "lube-cylinder",
    "lube-quarter",
    "quickstart",
]
Write = Callable[..., Path]


@pytest.fixture
def write(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Write:
    monkeypatch.chdir(tmp_path)

    def write_case(text: str | bytes, name: str = "my.toml") -> Path:
        content = text if isinstance(text, bytes) else text.encode()
        Path(name).write_bytes(content)
        return Path(name)

    return write_case


def error_of(source: str | Path, *overrides: str) -> CaseError:
    with pytest.raises(CaseError) as raised:
        load_case(source, overrides)
    return raised.value


def problems_of(source: str | Path, *overrides: str) -> list[Problem]:
    return list(error_of(source, *overrides).problems)


def only_problem(source: str | Path, *overrides: str) -> Problem:
    problems = problems_of(source, *overrides)
    assert len(problems) == 1, "\n".join(map(str, problems))
    return problems[0]


# --- what is accepted


def test_defaults_are_those_of_the_design(write: Write) -> None:
    case = load_case(write(GOOD))
    method = case.method
    assert (method.basis, method.transfer, method.stress_order) == ("quadratic", "taylor-flip", "usl")
    assert (method.position_update, method.flip_fraction) == ("trapezoid", 1.0)
    assert method.kernel_correction and method.wall_impulse and method.opening_strain
    assert (case.geometry.base, case.geometry.base_thickness, case.geometry.gravity) == (
        "elastic",
        0.02,
        9.81,
    )
    assert (case.grid.points_per_cell, case.time.cfl, case.output.snapshots) == (4, 0.5, 20)
    assert (case.stages.equilibrate.damping, case.stages.collapse.damping) == (0.5, 0.05)
    assert (case.stages.collapse.end, case.stages.collapse.max_time_factor) == ("rest", 6.0)
    assert case.stages.gate_speed == math.inf
    assert case.score.experiment == "paper"


def test_defaults_that_follow_from_the_material(write: Write) -> None:
    case = load_case(write(GOOD), ["material.youngs_modulus=2 MPa"])
    assert case.stages.equilibrate.law == "mohr-coulomb"
    assert case.stages.k0 == pytest.approx((1 - math.sin(math.radians(33))) / (1 + math.sin(math.radians(33))))
    base = case.base_material
    assert (base.law, base.density, base.youngs_modulus, base.poissons_ratio) == ("elastic", 2650.0, 2e6, 0.2)


def test_given_values_win_over_those_that_follow_from_the_material(write: Write) -> None:
    stages = '[stages]\nk0 = 0.5\nequilibrate = { law = "elastic" }\n'
    base = "[base_material]\ndensity = 1\nyoungs_modulus = 2\npoissons_ratio = 0\nlaw = 'elastic'\n"
    case = load_case(write(GOOD + stages + base))
    assert (case.stages.k0, case.stages.equilibrate.law, case.base_material.density) == (0.5, "elastic", 1.0)


def test_height_and_aspect_ratio() -> None:
    by_aspect = load_case("lube-channel", ["geometry.aspect=5"]).geometry
    assert (by_aspect.r_i, by_aspect.a) == (0.09, 5.0)
    assert by_aspect.h_i == pytest.approx(0.45)
    by_height = load_case("bui-rods").geometry
    assert (by_height.h_i, by_height.a) == (0.1, 0.5)


def test_units_in_a_case(write: Write) -> None:
    text = GOOD.replace("0.002", '"2 mm"').replace("10e6", '"10 MPa"').replace("2650.0", '"2.65 g/cm3"')
    assert load_case(write(text)) == load_case(write(GOOD))


def test_windows_line_ends_and_byte_order_mark(write: Write) -> None:
    text = b"\xef\xbb\xbf" + GOOD.replace("\n", "\r\n").encode()
    assert load_case(write(text)).title == "test"
    bad = only_problem(write(text.replace(b"spacing", b"spacng")))
    assert (bad.line, bad.text) == (10, "spacng = 0.002")


def test_times_of_snapshots(write: Write) -> None:
    assert load_case(write(GOOD), ['output.times=[0, "100 ms", 0.2]']).output.times == (0.0, 0.1, 0.2)


# --- problems


def test_all_problems_at_once_each_at_its_line(write: Write) -> None:
    text = (
        GOOD.replace("spacing =", "spacng =")
        .replace("density = 2650.0", "density = true")
        .replace("10e6", "-1e7")
        .replace('"plane"', '"plan"')
        .replace('"test"', "3")
    )
    error = error_of(write(text))
    found = [(problem.file, problem.line, problem.key) for problem in error.problems]
    assert found == [
        ("my.toml", 2, "title"),
        ("my.toml", 5, "geometry.model"),
        ("my.toml", 10, "grid.spacng"),
        ("my.toml", 14, "material.density"),
        ("my.toml", 15, "material.youngs_modulus"),
    ]
    assert str(error).endswith("5 problems; nothing was run.   (mpmcol explain title)")
    assert error.exit_code == 2


def test_the_message_as_a_whole(write: Write) -> None:
    text = GOOD.replace("spacing =", "spacng =").replace("10e6", "-1e7")
    assert str(error_of(write(text))) == (
        'my.toml:10: [grid] unknown key "spacng"\n'
        "   10 | spacng = 0.002\n"
        '      | ^^^^^^ did you mean "spacing"?   (grid node spacing h: a number > 0, in m)\n'
        "my.toml:15: [material] youngs_modulus = -10000000: expected a number > 0, in Pa\n"
        "   15 | youngs_modulus = -1e7\n"
        "2 problems; nothing was run.   (mpmcol explain grid.spacing)"
    )


@pytest.mark.parametrize(
    ("old", "new", "key", "message"),
    [
        ("0.002", "nan", "grid.spacing", "spacing = nan: expected a number > 0, in m"),
        ("0.002", "inf", "grid.spacing", "spacing = inf: expected a number > 0, in m"),
        ("0.002", "0", "grid.spacing", "spacing = 0: expected a number > 0, in m"),
        ("0.002", "true", "grid.spacing", "spacing = true: expected a number > 0, in m"),
        ("0.002", "[1]", "grid.spacing", "spacing = [1]: expected a number > 0, in m"),
        ("0.002", '"2 deg"', "grid.spacing", '"deg" cannot be converted to m; expected a number > 0, in m'),
        ("0.002", '"2 furlongs"', "grid.spacing", 'unknown unit "furlongs"'),
        ("0.002", "2020-01-01", "grid.spacing", "spacing = 2020-01-01: expected a number > 0, in m"),
        ("0.2", "0.5", "material.poissons_ratio", "expected a number >= 0 and < 0.5"),
        ("0.2", "-0.1", "material.poissons_ratio", "expected a number >= 0 and < 0.5"),
        ("33.0", "90", "material.friction_deg", "and <= 89, in deg"),
        ('"plane"', "1", "geometry.model", 'model = 1: expected "plane", "axisymmetric", "quarter" or "full"'),
        ('"plane"', '"cube"', "geometry.model", 'expected "plane", "axisymmetric", "quarter" or "full"'),
        ('"mohr-coulomb"', '"drucker-prager"', "material.law", 'law = "drucker-prager": expected "elastic"'),
        ('"mohr-coulomb"', "7", "material.law", "law = 7: expected"),
        ("schema = 1", "schema = 2", "schema", "schema = 2: expected 1"),
        ("schema = 1", "schema = true", "schema", "schema = true: expected 1"),
        ("schema = 1", "schema = 1\ngrid = 3", "grid", "grid = 3: expected a table"),
    ],
)
def test_bad_value(write: Write, old: str, new: str, key: str, message: str) -> None:
    text = GOOD.replace(old, new, 1)
    if new.endswith("grid = 3"):
        text = text.replace("[grid]\nspacing = 0.002\n", "")
    problem = only_problem(write(text))
    assert (problem.file, problem.key) == ("my.toml", key)
    assert message in problem.message
    assert problem.text == text.split("\n")[(problem.line or 0) - 1]
    assert new.split("\n")[-1] in problem.text


@pytest.mark.parametrize(
    ("addition", "message"),
    [
        ("[grid]\npoints_per_cell = 5", "points_per_cell = 5: expected 1, 4, 8, 9, 16 or 27"),
        ("[grid]\npoints_per_cell = 4.0", "points_per_cell = 4: expected 1, 4, 8, 9, 16 or 27"),
        ("[grid]\npoints_per_cell = true", "points_per_cell = true: expected 1, 4, 8, 9, 16 or 27"),
        ("[grid]\npoints_per_cell = 8", "points_per_cell = 8: must be 1, 4, 9 or 16 with geometry.model"),
        ("[method]\nwall_impulse = 1", "[method] wall_impulse = 1: expected true or false"),
        ("[method]\nflip_fraction = 1.5", "flip_fraction = 1.5: expected a number >= 0 and <= 1"),
        ('[method]\ntransfer = "xpic"', 'expected "taylor-flip", "flip", "pic", "tpic" or "apic"'),
        ("[time]\ncfl = 2.1", "cfl = 2.1: expected a number > 0 and <= 2"),
        (
            "[stages]\ncollapse = { damping = 1 }",
            "[stages.collapse] damping = 1: expected a number >= 0 and < 1",
        ),
        ("[stages]\ngate_speed = nan", "gate_speed = nan: expected a number > 0, or inf, in m/s"),
        ("[stages]\nequilibrate = 3", "[stages] equilibrate = 3: expected a table"),
        ("[output]\nsnapshots = 0", "snapshots = 0: expected an integer >= 1"),
        ("[output]\nsnapshots = true", "snapshots = true: expected an integer >= 1"),
        ('[output]\ntimes = [0.1, "x"]', 'item 2: "x": not a number with a unit'),
        ("[output]\ntimes = [0.2, 0.1]", "times = [0.2, 0.1]: must be at least one time, in increasing order"),
        ("[output]\ntimes = []", "times = []: must be at least one time, in increasing order"),
        ('[score]\nexperiment = "lube"', 'experiment = "lube": expected "paper"'),
    ],
)
def test_bad_value_of_an_optional_key(write: Write, addition: str, message: str) -> None:
    text = GOOD.replace("[grid]", addition) if addition.startswith("[grid]") else GOOD + addition + "\n"
    problem = only_problem(write(text))
    assert message in problem.message
    assert problem.line == text[: text.index(addition)].count("\n") + 2


@pytest.mark.parametrize(
    ("old", "new", "meant"),
    [
        ("[grid]", "[gird]", "grid"),
        ("radius", "radus", "radius"),
        ("aspect", "Aspect", "aspect"),
        ("friction_deg", "frictiondeg", "friction_deg"),
        ("title", "titel", "title"),
    ],
)
def test_nearest_key_and_no_second_complaint(write: Write, old: str, new: str, meant: str) -> None:
    problem = only_problem(write(GOOD.replace(old, new)))
    assert "unknown key" in problem.message
    assert f'did you mean "{meant}"?' in problem.hint


def test_nearest_word(write: Write) -> None:
    assert only_problem(write(GOOD.replace('"plane"', '"plain"'))).hint == 'did you mean "plane"?'
    assert only_problem(write(GOOD.replace('"mohr-coulomb"', '"mohr-coulom"'))).hint == 'did you mean "mohr-coulomb"?'


def test_key_in_the_wrong_place(write: Write) -> None:
    assert only_problem(write(GOOD + "cfl = 0.4\n")).hint == "move this key to [time]"
    assert "[time]" in only_problem(write("cfl = 0.4\n" + GOOD)).hint
    of_other_law = only_problem(write(GOOD + "softening_rate = 4\n"))
    assert of_other_law.hint == "not a key of law mohr-coulomb, but of mohr-coulomb-softening"


def test_missing_keys_are_located_at_their_table(write: Write) -> None:
    problems = problems_of(write(GOOD.replace("spacing = 0.002\n", "").replace("density = 2650.0\n", "")))
    assert [(problem.line, problem.message) for problem in problems] == [
        (9, "[grid] spacing is missing: expected a number > 0, in m"),
        (11, "[material] density is missing: expected a number > 0, in kg/m3"),
    ]


def test_missing_law_and_missing_tables(write: Write) -> None:
    law = only_problem(write(GOOD.replace('law = "mohr-coulomb"\n', "")))
    assert (law.line, law.key) == (12, "material.law")
    assert 'law is missing: expected "elastic", "mohr-coulomb" or "mohr-coulomb-softening"' in law.message
    empty = problems_of(write(""))
    assert [problem.message.partition(":")[0] for problem in empty] == [
        "[geometry] is missing",
        "[grid] is missing",
        "[material] is missing",
    ]


@pytest.mark.parametrize(
    ("old", "new", "keys", "message"),
    [
        ("0.002", "0.09", {"grid.spacing", "geometry.radius"}, "[grid] spacing = 0.09: must be smaller than"),
        ("3.0", "0.02", {"grid.spacing", "geometry.aspect"}, "must be smaller than the column's height"),
        (
            "33.0",
            "33.0\ndilatancy_deg = 34",
            {"material.dilatancy_deg", "material.friction_deg"},
            "must not exceed",
        ),
        (
            "0.09",
            "0.09\ndomain_length = 0.05",
            {"geometry.domain_length", "geometry.radius"},
            "must be larger than",
        ),
        (
            "0.09",
            "0.09\ndomain_height = 0.2",
            {"geometry.domain_height", "geometry.aspect"},
            "must be larger than",
        ),
        (
            "0.09",
            "0.09\nbase_thickness = 1e-3",
            {"geometry.base_thickness", "grid.spacing"},
            "at least one cell",
        ),
        (
            '"plane"',
            '"axisymmetric"\nrelease = "two-sided"',
            {"geometry.release", "geometry.model"},
            'must be "one-sided"',
        ),
        ("3.0", "3.0\nheight = 0.2", {"geometry.height", "geometry.aspect"}, "remove one of them"),
    ],
)
def test_keys_that_disagree_are_both_named_with_their_lines(
    write: Write, old: str, new: str, keys: set[str], message: str
) -> None:
    text = GOOD.replace(old, new, 1)
    problems = [p for p in problems_of(write(text)) if message in p.message and keys <= named(p)]
    assert problems, error_of("my.toml")
    lines = {".".join(path): line for path, line in locate(text)}
    other = (keys - {problems[0].key}).pop()
    assert problems[0].line == lines[problems[0].key]
    assert f"{other}: my.toml:{lines[other]}" in problems[0].hint


def named(problem: Problem) -> set[str]:
    return {problem.key} | {part.partition(":")[0].strip() for part in problem.hint.split(";")}


def test_words_of_three_dimensions(write: Write) -> None:
    quarter = GOOD.replace('"plane"', '"quarter"')
    case = load_case(write(quarter))
    assert (case.grid.points_per_cell, case.geometry.shape, case.geometry.dimension) == (8, "cylinder", 3)
    box = load_case(write(quarter), ["geometry.section=box", "geometry.depth=0.2"])
    assert (box.geometry.shape, box.geometry.depth) == ("box", 0.2)
    assert case_hash(box) != case_hash(case) != case_hash(load_case(write(GOOD)))
    for overrides, message in (
        (["grid.points_per_cell=4"], "must be 1, 8 or 27 with geometry.model"),
        (["geometry.depth=0.2"], "has no meaning with geometry.section"),
        (["geometry.model=plane", "geometry.section=box"], 'must be "cylinder" with geometry.model'),
    ):
        with pytest.raises(CaseError, match=re.escape(message)):
            load_case(write(quarter), overrides)


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (["transfer=tpic", "flip_fraction=0.9"], 'has no meaning with method.transfer = "tpic"'),
        (["basis=linear", "kernel_correction=false"], 'has no meaning with method.basis = "linear"'),
        (["basis=linear", "transfer=apic"], 'must not be "apic" with method.basis = "linear"'),
        (["transfer=apic", "kernel_correction=false"], 'must not be "apic" with method.kernel_correction = false'),
    ],
)
def test_choices_of_the_method_that_exclude_each_other(overrides: list[str], message: str) -> None:
    assert message in only_problem("quickstart", *(f"method.{each}" for each in overrides)).message


def test_rules_between_keys_are_checked_beside_other_problems(write: Write) -> None:
    text = GOOD.replace("10e6", "-1e7").replace("33.0", "33.0\ndilatancy_deg = 34")
    assert [problem.line for problem in problems_of(write(text))] == [15, 18]


def test_softening_angles_must_be_in_order() -> None:
    problem = only_problem("lube-channel-dense", "material.friction_residual_deg=51")
    assert "must not exceed material.friction_peak_deg = 50" in problem.message
    problem = only_problem("lube-channel-dense", "material.dilatancy_residual_deg=26")
    assert "must not exceed material.dilatancy_peak_deg = 25" in problem.message


def test_neither_height_nor_aspect(write: Write) -> None:
    problem = only_problem(write(GOOD.replace("aspect = 3.0\n", "")))
    assert (problem.line, problem.message) == (
        4,
        "[geometry] aspect is missing: give geometry.aspect or geometry.height",
    )


def test_an_experiment_must_be_about_the_model() -> None:
    problem = only_problem("bui-rods", "geometry.model=axisymmetric")
    assert problem.message == (
        '[score] experiment = "bui-2008": is for another kind of column than geometry.model = "axisymmetric" '
        'and geometry.section = "cylinder"'
    )


def test_law_of_equilibration_is_elastic_or_the_columns_own() -> None:
    problem = only_problem("quickstart", "stages.equilibrate.law=mohr-coulomb-softening")
    assert 'must be "elastic" or that of the column, material.law = "mohr-coulomb"' in problem.message


def test_rules_hold_for_a_case_built_in_python() -> None:
    tables = load_case("quickstart").model_dump(by_alias=True)
    tables["grid"]["spacing"] = 1.0
    with pytest.raises(ValidationError, match=r"grid.spacing must be smaller than geometry.radius = 0.09"):
        Case.model_validate(tables)


# --- overrides


def test_overrides_win_over_the_file(write: Write) -> None:
    case = load_case(write(GOOD), ["geometry.aspect=5", "title=a b", "stages.collapse.damping=0", "grid.spacing=1 mm"])
    assert (case.geometry.a, case.title, case.stages.collapse.damping, case.grid.spacing) == (
        5.0,
        "a b",
        0.0,
        0.001,
    )


def test_overriding_the_height_replaces_the_aspect_ratio(write: Write) -> None:
    assert load_case(write(GOOD), ["geometry.height=0.18"]).geometry.a == pytest.approx(2.0)
    assert load_case("bui-rods", ["geometry.aspect=1"]).geometry.h_i == pytest.approx(0.2)
    both = only_problem("bui-rods", "geometry.aspect=1", "geometry.height=0.2")
    assert "remove one of them" in both.message


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("grid.spacing=-1", "[grid] spacing = -1: expected a number > 0, in m"),
        ("grid.spacng=1", '[grid] unknown key "spacng"'),
        ("geometry=3", "geometry = 3: expected a table"),
        ("stages.collapse={ damping = 2 }", "[stages.collapse] damping = 2: expected"),
        ("grid.spacing=1", "must be smaller than geometry.radius"),
        ("title.x=1", "title = a table: expected a string in quotes"),
        ("grid={}", "[grid] spacing is missing"),
    ],
)
def test_problem_of_an_override_is_located_there(write: Write, override: str, message: str) -> None:
    problem = problems_of(write(GOOD), override)[0]
    assert (problem.file, problem.line) == (f"--set {override}", None)
    assert message in problem.message


@pytest.mark.parametrize(
    "override",
    ["", "x", "=1", "grid.=1", "grid.spacing=", 'title="a', "title=[", "title=1\na=2"],
)
def test_malformed_overrides_are_all_reported(write: Write, override: str) -> None:
    problems = problems_of(write(GOOD), override, "grid.spacing=-1", "y")
    assert len(problems) == 3
    assert all(problem.file.startswith("--set") for problem in problems)


def test_an_override_cannot_extend(write: Write) -> None:
    assert "extends can only be set in a case file" in only_problem(write(GOOD), "extends=quickstart").message


# --- extends


def test_a_table_replaces_the_whole_table_of_the_parent() -> None:
    child, parent = load_case("lube-channel-loose"), load_case("lube-channel")
    assert child.geometry == parent.geometry
    assert child.material.law == child.stages.equilibrate.law == "mohr-coulomb-softening"
    assert child.material.model_dump()["friction_peak_deg"] == 39.0


def test_extending_a_path_beside_the_file(write: Write) -> None:
    Path("folder").mkdir()
    write(GOOD, "folder/parent.toml")
    write('extends = "parent.toml"\n[grid]\nspacing = 0.003\n', "folder/child.toml")
    case = load_case("folder/child.toml")
    assert (case.grid.spacing, case.title) == (0.003, "test")


def test_problem_in_the_parent_is_located_in_the_parent(write: Write) -> None:
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
def test_bad_extends(write: Write, extends: str, message: str) -> None:
    problem = only_problem(write(f"schema = 1\nextends = {extends}\n"))
    assert (problem.file, problem.line, problem.message) == ("my.toml", 2, f"extends: {message}")
    assert ("lube-channel" in problem.hint) == ("lube" in extends)


# --- files


def test_missing_file_names_the_nearest_shipped_case(write: Write) -> None:
    for source in ("quikstart", "cases/quickstart.toml", Path("quickstart.toml")):
        assert 'did you mean the shipped case "quickstart"?' in only_problem(source).hint
    assert "mpmcol cases" in only_problem("a\0b").hint
    assert "no such case file" in only_problem("x" * 5000).message


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
    ],
)
def test_file_that_cannot_be_parsed(write: Write, content: bytes, line: int | None, message: str) -> None:
    problem = only_problem(write(content))
    assert (problem.file, problem.line) == ("my.toml", line)
    assert message in problem.message


def test_a_flood_of_problems_is_cut(write: Write) -> None:
    error = error_of(write(GOOD + "".join(f"x{i} = 1\n" for i in range(3000))))
    assert len(error.problems) == 1000
    assert len(str(error)) < 10_000
    assert str(error).endswith("... and 950 more\n1000 problems or more; nothing was run.   (mpmcol explain material)")


def test_unquoted_text_is_told_to_need_quotes(write: Write) -> None:
    assert "strings in quotes" in only_problem(write(GOOD.replace('"plane"', "plane"))).hint
    assert "unit in quotes" in only_problem(write(GOOD.replace("0.002", "2 mm"))).hint


def test_a_folder_is_no_case(tmp_path: Path) -> None:
    assert "cannot be read" in only_problem(tmp_path).message


def test_any_damage_ends_in_a_case_error(write: Write) -> None:
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


# --- line numbers


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


# --- shipped cases, resolved and flattened text


def test_the_shipped_cases() -> None:
    assert list(shipped_cases()) == SHIPPED


@pytest.mark.parametrize("name", SHIPPED)
def test_resolved_toml_loads_back_to_an_equal_case(write: Write, name: str) -> None:
    case = load_case(name)
    text = resolved_toml(case, {"dt_s": 1e-5, "points": 36450})
    assert load_case(write(text)) == case
    assert case_hash(load_case("my.toml")) == case_hash(case)
    assert "# dt_s = 1e-05\n# points = 36450\n" in text


@pytest.mark.parametrize("name", SHIPPED)
def test_flattened_text_stands_alone(write: Write, name: str) -> None:
    text = flattened_text(name)
    assert "\nextends" not in text
    assert load_case(write(text)) == load_case(name)
    assert text.startswith("# ") and f"mpmcol run {name}" in text


def test_resolved_toml_holds_every_key_that_has_a_value() -> None:
    text = resolved_toml(load_case("quickstart"))
    for key in key_names(("method",)) + key_names(("stages", "equilibrate")):
        assert f"\n{key.rpartition('.')[2]} = " in text


def test_the_papers_cases() -> None:
    channel, cylinder = load_case("lube-channel"), load_case("lube-cylinder")
    assert (channel.geometry.r_i, channel.geometry.a, channel.grid.spacing) == (0.09, 3.0, 0.002)
    assert (channel.stages.equilibrate.damping, channel.stages.collapse.damping) == (0.5, 0.05)
    assert (cylinder.geometry.model, cylinder.geometry.r_i, cylinder.grid.spacing) == (
        "axisymmetric",
        0.097,
        0.005,
    )
    assert (cylinder.stages.equilibrate.damping, cylinder.stages.equilibrate.law) == (0.7, "elastic")


# --- hash


def test_hash_is_stable_and_sensitive() -> None:
    base = case_hash(load_case("quickstart"))
    assert base == case_hash(load_case("quickstart"))
    assert len(base) == 12 and int(base, 16) >= 0
    assert base == case_hash(load_case("quickstart", ["title=other"]))
    assert base == case_hash(load_case("quickstart", ["grid.spacing=5 mm", "time.cfl=0.5"]))
    changes = [
        "grid.spacing=0.004",
        "time.cfl=0.51",
        "material.friction_deg=33.0000001",
        "stages.gate_speed=2",
    ]
    hashes = {case_hash(load_case("quickstart", [change])) for change in changes}
    assert len(hashes | {base}) == len(changes) + 1


# --- reference


@pytest.mark.parametrize("key", key_names())
def test_every_key_is_explained(key: str) -> None:
    text = explain(key)
    assert key in text.split("\n")[0]
    assert len(text.split("\n")) >= 2
    assert "does not exist" not in text and "None" not in text


def test_explain_names_unit_bounds_default_and_law() -> None:
    assert explain("grid.spacing") == "grid.spacing\n    grid node spacing h\n    a number > 0, in m; required"
    assert '"gravity" or "k0"; default "gravity"' in explain("stages")
    assert "laws: mohr-coulomb-softening" in explain("material.softening_rate")
    assert all(key in explain() for key in key_names())


@pytest.mark.parametrize(("key", "meant"), [("grid.spacng", "grid.spacing"), ("spacing", "grid.spacing")])
def test_explain_names_the_nearest_key(key: str, meant: str) -> None:
    with pytest.raises(UsageError, match=f'Did you mean "{meant}"?'):
        explain(key)


def test_schema_is_draft_4_and_inlined() -> None:
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


def test_schema_describes_every_key() -> None:
    described = set(described_keys(json_schema()))
    assert described == set(key_names())


def described_keys(schema: dict[str, Any], prefix: str = "") -> list[str]:
    keys = []
    for table in schema.get("oneOf", [schema]):
        for name, part in table.get("properties", {}).items():
            assert part["description"]
            keys += [prefix + name, *described_keys(part, f"{prefix}{name}.")]
    return keys
