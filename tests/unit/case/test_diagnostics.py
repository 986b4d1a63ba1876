"""Problems of single keys: file, line, key, what was expected, hint."""

from __future__ import annotations

import pytest

from tests.support.case_files import GOOD, Write, error_of, only_problem, problems_of


def test_all_problems_are_reported_with_their_lines(write: Write) -> None:
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


def test_the_complete_message(write: Write) -> None:
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
        (
            "0.002",
            '"2 deg"',
            "grid.spacing",
            '"deg" cannot be converted to m (known: m, mm, cm); expected a number',
        ),
        ("0.002", '"2 furlongs"', "grid.spacing", 'unknown unit "furlongs" (known: m, mm, cm); expected'),
        ("0.002", "2020-01-01", "grid.spacing", "spacing = 2020-01-01: expected a number > 0, in m"),
        ("0.2", "0.5", "material.poissons_ratio", "expected a number >= 0 and < 0.5"),
        ("0.2", "-0.1", "material.poissons_ratio", "expected a number >= 0 and < 0.5"),
        ("33.0", "90", "material.friction_deg", "and <= 89, in deg"),
        ('"plane"', "1", "geometry.model", 'model = 1: expected "plane", "axisymmetric", "quarter" or "full"'),
        ('"plane"', '"cube"', "geometry.model", 'expected "plane", "axisymmetric", "quarter" or "full"'),
        ('"mohr-coulomb"', '"cam-clay"', "material.law", 'law = "cam-clay": expected "elastic"'),
        ('"mohr-coulomb"', "7", "material.law", "law = 7: expected"),
        ("schema = 1", "schema = 2", "schema", "schema = 2: expected 1"),
        ("schema = 1", "schema = true", "schema", "schema = true: expected 1"),
        ("schema = 1", "schema = 1\ngrid = 3", "grid", "grid = 3: expected a table"),
    ],
)
def test_an_invalid_value_is_reported_with_what_was_expected(
    write: Write, old: str, new: str, key: str, message: str
) -> None:
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
        ("[grid]\npoints_per_cell = 4.0", "points_per_cell = 4.0: expected 1, 4, 8, 9, 16 or 27"),
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
def test_an_invalid_value_of_an_optional_key_is_reported(write: Write, addition: str, message: str) -> None:
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
def test_an_unknown_key_is_reported_once_with_the_nearest_key(write: Write, old: str, new: str, meant: str) -> None:
    problem = only_problem(write(GOOD.replace(old, new)))
    assert "unknown key" in problem.message
    assert f'did you mean "{meant}"?' in problem.hint


def test_an_unknown_value_is_reported_with_the_nearest_value(write: Write) -> None:
    assert only_problem(write(GOOD.replace('"plane"', '"plain"'))).hint == 'did you mean "plane"?'
    assert only_problem(write(GOOD.replace('"mohr-coulomb"', '"mohr-coulom"'))).hint == 'did you mean "mohr-coulomb"?'


def test_a_misplaced_key_is_reported_with_its_table_or_law(write: Write) -> None:
    assert only_problem(write(GOOD + "cfl = 0.4\n")).hint == "move this key to [time]"
    assert "[time]" in only_problem(write("cfl = 0.4\n" + GOOD)).hint
    of_other_law = only_problem(write(GOOD + "softening_rate = 4\n"))
    assert of_other_law.hint == "not a key of law mohr-coulomb, but of mohr-coulomb-softening"


@pytest.mark.parametrize(
    ("addition", "message", "hint"),
    [
        ("[[layers]]\nto = 0.03\nfriction_deg = 22", '"friction_deg"', "material = { friction_deg = ... }"),
        ("[[walls]]\nfrom = 0.2\nmu = 0.3", 'unknown key "mu"', "the friction of a wall is its key friction"),
        ("[[walls]]\nfrom = 0.2\nfriction_deg = 15", "unknown key", "the friction of a wall is its key friction"),
        ("[walls]\nfrom = 0.2", "walls = a table: expected an array of tables", "write [[walls]]"),
        ("[layers]\nto = 0.03", "layers = a table: expected an array of tables", "write [[layers]]"),
        ('[output]\nsnapshots = "20"', "expected an integer >= 1", "write 20 without quotes"),
        ('[output]\nwall_forces = "true"', "expected true or false", "write true without quotes"),
        ("[output]\nhalf_width = 3", 'unknown key "half_width"', "move this key to [[walls]]"),
    ],
)
def test_the_hint_names_the_way_to_give_a_value(write: Write, addition: str, message: str, hint: str) -> None:
    problem = only_problem(write(f"{GOOD}\n{addition}\n"))
    assert message in problem.message and hint in problem.hint


@pytest.mark.parametrize(
    ("case", "array", "given", "missing"),
    [("dam", "walls", "height = 0.05", "from"), ("layered-column", "layers", "from = 0.01", "to")],
)
def test_an_array_that_replaces_that_of_the_extended_case_is_named(
    write: Write, case: str, array: str, given: str, missing: str
) -> None:
    write(f'extends = "{case}"\n', "between.toml")
    problem = only_problem(write(f'extends = "between.toml"\n\n[[{array}]]\n{given}\n'))
    assert f"{missing} is missing" in problem.message
    change = f"--set {array}.0.{given.replace(' ', '')}"
    assert f"[[{array}]] replaces all of {case}.toml: give every key, or change one of them by {change}" in problem.hint
    alone = only_problem(write(GOOD + "[[walls]]\nto = 0.3\n"))
    assert "from is missing" in alone.message and "replaces" not in alone.hint


@pytest.mark.parametrize(
    ("changed", "key", "hint"),
    [
        (("0.002", "10"), "grid.spacing", 'if grid.spacing is in mm, write "10 mm"'),
        (("0.09", "0.0009"), "grid.spacing", ""),
        (("radius = 0.09", "radius = 90\nbase_thickness = 0.02", "0.002", "2"), "geometry.base_thickness", '"2 mm"'),
    ],
)
def test_a_length_in_mm_is_one_problem_with_a_hint(write: Write, changed: tuple[str, ...], key: str, hint: str) -> None:
    text = GOOD
    for old, new in zip(changed[::2], changed[1::2], strict=True):
        text = text.replace(old, new, 1)
    problem = only_problem(write(text))
    assert problem.key == key and hint in problem.message and bool(hint) == ("in mm" in problem.message)


def test_a_number_in_quotes_is_no_misspelt_one(write: Write) -> None:
    assert only_problem(write(GOOD), 'grid.points_per_cell="4"').hint == "write 4 without quotes"


def test_a_layer_whose_law_is_no_name_is_one_problem(write: Write) -> None:
    problem = only_problem(write(f"{GOOD}\n[[layers]]\nto = 0.03\nmaterial = {{ law = [] }}\n"))
    assert problem.message.startswith('[[layers]] 1: material law = []: expected "elastic", "mohr-coulomb"')


@pytest.mark.parametrize("own", ['law = "elastic"', 'law = "elastic", friction_deg = 22'])
def test_a_layer_with_another_law_is_one_problem(write: Write, own: str) -> None:
    problem = only_problem(write(f"{GOOD}\n[[layers]]\nto = 0.03\nmaterial = {{ {own} }}\n"))
    assert problem.message == '[[layers]] 1: material law = "elastic": must be that of the column, "mohr-coulomb"'
    assert (problem.hint, problem.about) == ("", "layers.material.law")


LAYER = "[[layers]]\nto = 0.03\nmaterial = { frction_deg = 22 }\n"


@pytest.mark.parametrize(
    ("law", "expected"),
    [
        ("mohr-coulom", ["law", "density", "frictiondeg", "frction_deg"]),
        ("cam-clay", ["law", "density"]),  # the other keys may be those of this law
        (None, ["law", "density"]),
    ],
)
def test_an_unknown_law_does_not_hide_the_problems_beside_it(
    write: Write, law: str | None, expected: list[str]
) -> None:
    line = "" if law is None else f'law = "{law}"\n'
    text = GOOD.replace('law = "mohr-coulomb"\n', line).replace("density = 2650.0", "density = -1")
    text = text.replace("friction_deg", "frictiondeg") + LAYER
    found = [problem.key.rpartition(".")[2] for problem in problems_of(write(text))]
    assert sorted(found) == sorted(expected)


def test_an_unknown_law_of_a_bed_does_not_hide_the_problems_beside_it(write: Write) -> None:
    text = GOOD.replace('model = "plane"', 'model = "plane"\nbase = "granular"')
    bed = '[base_material]\nlaw = "mohr-coulom"\nfriction_deg = 95\n'
    keys = [problem.key for problem in problems_of(write(text + bed))]
    assert keys == ["base_material.law", "base_material.friction_deg"]


def test_missing_keys_are_reported_at_their_table(write: Write) -> None:
    problems = problems_of(write(GOOD.replace("spacing = 0.002\n", "").replace("density = 2650.0\n", "")))
    assert [(problem.line, problem.message) for problem in problems] == [
        (9, "[grid] spacing is missing: expected a number > 0, in m"),
        (11, "[material] density is missing: expected a number > 0, in kg/m3"),
    ]


def test_a_missing_law_and_missing_tables_are_reported(write: Write) -> None:
    law = only_problem(write(GOOD.replace('law = "mohr-coulomb"\n', "")))
    assert (law.line, law.key) == (12, "material.law")
    assert 'law is missing: expected "elastic", "mohr-coulomb", ' in law.message
    assert law.message.endswith('"drucker-prager" or "mu-i"')
    empty = problems_of(write(""))
    assert [problem.message.partition(":")[0] for problem in empty] == [
        "[geometry] is missing",
        "[grid] is missing",
        "[material] is missing",
    ]


def test_a_long_list_of_problems_is_cut(write: Write) -> None:
    error = error_of(write(GOOD + "".join(f"x{i} = 1\n" for i in range(3000))))
    assert len(error.problems) == 1000
    assert len(str(error)) < 10_000
    assert str(error).endswith("... and 950 more\n1000 problems or more; nothing was run.   (mpmcol explain material)")
