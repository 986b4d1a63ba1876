"""Layers of the column in a case file: values, messages and their lines."""

from __future__ import annotations

import pytest

from mpmcol.case import case_hash, explain, load_case, resolved_toml
from mpmcol.errors import CaseError
from tests.support.case_files import GOOD, Write, only_problem

LAYERS = (
    GOOD
    + """
[[layers]]
from = 0.0
to = "5 cm"
material = { friction_deg = 22 }

[[layers]]
from = 0.1
to = 0.15
[layers.material]
density = 1500
"""
)


def test_keys_that_are_not_given_are_those_of_the_column(write: Write) -> None:
    case = load_case(write(LAYERS))
    weak, light = case.layers
    assert (weak.from_, weak.to, light.from_, light.to) == (0.0, 0.05, 0.1, 0.15)
    assert weak.material == case.material.model_copy(update={"friction_deg": 22.0})
    assert light.material == case.material.model_copy(update={"density": 1500.0})
    assert case.materials == (case.material, case.base_material, weak.material, light.material)


def test_an_override_changes_a_key_of_one_layer(write: Write) -> None:
    case = load_case(write(LAYERS), ["layers.1.material.density=1600", "layers.0.to=0.04"])
    assert (case.layers[0].to, case.layers[1].material.density) == (0.04, 1600.0)
    problem = only_problem(write(LAYERS), "layers.0.to=-1")
    assert problem.file == "--set layers.0.to=-1" and "[[layers]] 1: to = -1" in problem.message
    for key in ("layers.7.to", "layers.x.to", "layers.0"):
        assert only_problem(write(LAYERS), f"{key}=1").message


def test_a_resolved_case_has_the_layers_and_the_hash_depends_on_them(write: Write) -> None:
    case, uniform = load_case(write(LAYERS)), load_case(write(GOOD))
    assert load_case(write(resolved_toml(case))) == case
    assert case_hash(case) != case_hash(uniform)
    assert "layers" not in resolved_toml(uniform)


@pytest.mark.parametrize(
    ("old", "new", "line", "message"),
    [
        ("to = 0.15", "to = -1", 26, "[[layers]] 2: to = -1: expected a number > 0, in m"),
        ("to = 0.15", "", 24, "[[layers]] 2: to is missing: expected a number > 0, in m"),
        ("density = 1500", "density = 0", 28, "[[layers]] 2: material density = 0: expected a number > 0"),
        ("density = 1500", "densty = 1500", 28, '[[layers]] 2: material unknown key "densty"'),
        ("from = 0.1", "frm = 0.1", 25, '[[layers]] 2: unknown key "frm"'),
        ("friction_deg = 22", "dilatancy_deg = 40", 22, "dilatancy_deg must not exceed friction_deg"),
        ("from = 0.1", "from = 0.04", 25, "[[layers]] 2: from = 0.04: lies in another layer, which ends at 0.05 m"),
        ("to = 0.15", "to = 0.05", 25, "[[layers]] 2: from = 0.1: must be smaller than to = 0.05 m"),
        ("from = 0.1", "from = 9", 25, "[[layers]] 2: from = 9: must be smaller than to = 0.15 m"),
    ],
)
def test_messages_name_the_layer_and_its_line(write: Write, old: str, new: str, line: int, message: str) -> None:
    problem = only_problem(write(LAYERS.replace(old, new)))
    assert message in problem.message, problem.message
    assert problem.line == line


def test_a_layer_above_the_column_another_law_and_too_many_layers_are_refused(write: Write) -> None:
    above = LAYERS.replace("from = 0.1", "from = 1").replace("to = 0.15", "to = 2")
    assert "[[layers]] 2: from = 1: lies above the column, 0.27 m high" in only_problem(write(above)).message
    other = LAYERS.replace("density = 1500", 'law = "elastic"')
    assert only_problem(write(other)).line is not None
    many = GOOD + "".join(
        f"[[layers]]\nfrom = {0.01 * k}\nto = {0.01 * k + 0.005}\nmaterial = {{}}\n" for k in range(15)
    )
    assert "15 layers, expected at most 14" in only_problem(write(many)).message
    assert "an array of tables" in only_problem(write(GOOD), "layers=3").message


def test_layers_are_explained() -> None:
    text = explain("layers")
    assert text.startswith("[[layers]]") and "layers.material.friction_deg" in text


def test_a_layer_without_a_material_repeats_no_problem_of_the_column(write: Write) -> None:
    text = GOOD + "cohesion = 1.0\ntension = 1e9\n[[layers]]\nto = 0.1\n"
    assert only_problem(write(text)).key == "material.tension"
    assert only_problem(write(text.replace("to = 0.1", "to = -1").replace("1e9", "0"))).key == "layers.0.to"


def test_an_invalid_material_does_not_hide_the_mistakes_of_layers(write: Write) -> None:
    """Missing keys and misspelt ones are reported with it; keys that follow from it are not reported as missing."""
    text = LAYERS.replace("density = 2650.0", "density = -1").replace('to = "5 cm"\n', "")
    with pytest.raises(CaseError) as caught:
        load_case(write(text.replace("{ friction_deg = 22 }", "{ frction_deg = 22 }")))
    messages = [problem.message for problem in caught.value.problems]
    assert messages == [
        "[material] density = -1: expected a number > 0, in kg/m3",
        "[[layers]] 1: to is missing: expected a number > 0, in m",
        '[[layers]] 1: material unknown key "frction_deg"',
    ]
