"""Overrides by --set."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from mpmcol.case import load_case
from mpmcol.case.overrides import refuse_repeated
from mpmcol.errors import CaseError
from tests.support.case_files import GOOD, Write, only_problem, problems_of


def test_overrides_replace_values_of_the_file(write: Write) -> None:
    case = load_case(write(GOOD), ["geometry.aspect=5", "title=a b", "stages.collapse.damping=0", "grid.spacing=1 mm"])
    assert (case.geometry.a, case.title, case.stages.collapse.damping, case.grid.spacing) == (
        5.0,
        "a b",
        0.0,
        0.001,
    )


@pytest.mark.parametrize(
    ("values", "texts"),
    [
        ({"geometry.aspect": 5, "title": 'a "b"'}, ["geometry.aspect=5", 'title=a "b"']),
        ({"grid.spacing": "1 mm", "method.wall_impulse": True}, ["grid.spacing=1 mm", "method.wall_impulse=true"]),
        ({"grid.spacing": np.float64(0.001), "time.cfl": np.array(0.3)}, ["grid.spacing=0.001", "time.cfl=0.3"]),
        ({"output.times": [0.1, 0.2]}, ["output.times=[0.1, 0.2]"]),
        ({"stages.collapse": {"damping": 0.1}}, ["stages.collapse.damping=0.1"]),
        ({}, []),
    ],
)
def test_overrides_as_a_mapping_are_those_as_texts(write: Write, values: dict[str, Any], texts: list[str]) -> None:
    assert load_case(write(GOOD), values) == load_case(write(GOOD), texts)


def test_a_single_override_needs_no_list(write: Write) -> None:
    assert load_case(write(GOOD), "geometry.aspect=5").geometry.a == 5.0


def test_a_value_that_toml_does_not_have_is_refused(write: Write) -> None:
    with pytest.raises(TypeError, match="title: expected a number"):
        load_case(write(GOOD), {"title": None})


def test_an_override_of_the_height_removes_the_aspect_ratio(write: Write) -> None:
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
def test_a_problem_of_an_override_is_reported_there(write: Write, override: str, message: str) -> None:
    problem = problems_of(write(GOOD), override)[0]
    assert (problem.file, problem.line) == (f"--set {override}", None)
    assert message in problem.message


@pytest.mark.parametrize(
    "override",
    ["", "x", "=1", "grid.=1", "grid.spacing=", 'title="a', "title=[", "title=1\na=2"],
)
def test_all_malformed_overrides_are_reported(write: Write, override: str) -> None:
    problems = problems_of(write(GOOD), override, "grid.spacing=-1", "y")
    assert len(problems) == 3
    assert all(problem.file.startswith("--set") for problem in problems)


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("x", "there is no equals sign: expected key=value"),
        ("=3", "the key is missing"),
        ("grid..spacing=3", "a part of the key is empty"),
        ("grid.spacing=", "the value is missing"),
    ],
)
def test_what_is_missing_in_an_override_is_named(write: Write, override: str, message: str) -> None:
    assert message in only_problem(write(GOOD), override).message


def test_two_values_of_one_key_are_refused_where_a_user_gives_them(write: Write) -> None:
    """A study appends its values to those of the user; the last one counts."""
    twice = ["grid.spacing=0.01", "geometry.aspect=2", " grid . spacing = 0.02"]
    with pytest.raises(CaseError) as refused:
        refuse_repeated(twice)
    (problem,) = refused.value.problems
    assert problem.file == "--set  grid . spacing = 0.02" and problem.key == "grid.spacing"
    assert problem.message == "grid.spacing is given twice; the other one is --set grid.spacing=0.01"
    refuse_repeated(["grid.spacing=0.01", "grid.spacing=0.01", "geometry.aspect=2"])
    assert load_case(write(GOOD), twice).grid.spacing == 0.02


def test_an_override_cannot_set_extends(write: Write) -> None:
    assert "extends can only be set in a case file" in only_problem(write(GOOD), "extends=coarse-channel").message


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("grid.points_per_cell=4.0", "points_per_cell = 4.0: expected 1, 4"),
        ("output.snapshots=20.0", "snapshots = 20.0: expected an integer"),
        ("grid.spacing=0,005", 'spacing = "0,005": the decimal separator is a point'),
        ("grid.spacing='5,0 mm'", 'spacing = "5,0 mm": the decimal separator is a point'),
    ],
)
def test_a_message_shows_the_value_as_given(write: Write, override: str, message: str) -> None:
    assert message in only_problem(write(GOOD), override).message


def test_no_unrelated_key_is_proposed(write: Write) -> None:
    assert "did you mean" not in only_problem(write(GOOD), "geometry.base_friction=0.3").hint


def test_the_degree_sign_is_a_unit(write: Write) -> None:
    assert load_case(write(GOOD), ["material.friction_deg=31°"]).material.model_dump()["friction_deg"] == 31.0
