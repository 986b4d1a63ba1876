"""Outlines in case files: points, CSV files, messages, and the keys that they replace."""

from __future__ import annotations

from pathlib import Path

import pytest

from mpmcol.case import case_hash, json_schema, load_case, resolved_toml
from mpmcol.case.outline import area
from mpmcol.experiments import OUTLINE
from tests.support.case_files import GOOD, Write, only_problem, problems_of

HEAP = "[[0, 0], [0.3, 0], [0, 0.1]]"
SLOPE = GOOD.replace("radius = 0.09\naspect = 3.0\n", f"outline = {HEAP}\n")


def test_radius_and_height_follow_from_the_points(write: Write) -> None:
    geometry = load_case(write(SLOPE)).geometry
    assert (geometry.r_i, geometry.h_i, geometry.a) == (0.3, 0.1, pytest.approx(1.0 / 3.0))
    assert geometry.outline == ((0.0, 0.0), (0.3, 0.0), (0.0, 0.1))
    assert not geometry.is_rectangle and geometry.column_section == OUTLINE


@pytest.mark.parametrize(
    "points",
    [
        '[["0 m", 0], ["30 cm", 0], [0, "100 mm"]]',
        "[[0, 0], [0, 0.1], [0.3, 0]]",
        "[[0, 0], [0.3, 0], [0, 0.1], [0, 0]]",
    ],
    ids=["units", "clockwise", "closed"],
)
def test_points_are_converted_to_a_counterclockwise_polygon(write: Write, points: str) -> None:
    outline = load_case(write(SLOPE.replace(HEAP, points))).geometry.outline
    assert outline is not None and sorted(outline) == [(0.0, 0.0), (0.0, 0.1), (0.3, 0.0)]
    assert area(outline) == pytest.approx(0.015)


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ("3", "expected an array of 3 to 500 points [x, y] in m, x and y >= 0, or the path of a CSV file"),
        ("[]", "0 points, expected 3 to 500"),
        ("[[0, 0], [0.3, 0]]", "2 points, expected 3 to 500"),
        ("[[0, 0], [0.3, 0], 4]", "point 3 is not a pair [x, y] of numbers"),
        ("[[0, 0], [0.3, 0], [1, 2, 3]]", "point 3 is not a pair [x, y] of numbers"),
        ("[[0, 0], [0.3, -0.1], [0, 0.1]]", "point 2, [0.3, -0.1]: expected a number >= 0, in m for x and y"),
        ("[[0, 0], [0.3, nan], [0, 0.1]]", "point 2, [0.3, nan]: expected a number >= 0, in m"),
        ('[[0, 0], ["3 furlong", 0], [0, 0.1]]', 'point 2, ["3 furlong", 0]: unknown unit "furlong"'),
        ("[[0, 0], [0.3, 0], [0.3, 0], [0, 0.1]]", "point 2, [0.3, 0] is given twice in a row"),
        (
            "[[0, 0], [0.3, 0], [0, 0.1], [0.3, 0.1]]",
            "the edge from point 2, [0.3, 0], crosses or touches the edge from point 4, [0.3, 0.1]",
        ),
        (
            "[[0, 0], [0.3, 0], [0.3, 0.2], [0.1, 0], [0, 0.1]]",
            "the edge from point 1, [0, 0], crosses or touches the edge from point 3, [0.3, 0.2]",
        ),
        (
            "[[0, 0], [0.3, 0], [0.5, 0], [0.4, 0], [0, 0.1]]",
            "the edge from point 2, [0.3, 0], crosses or touches the edge from point 3, [0.5, 0]",
        ),
        ("[[0, 0], [0.3, 0], [0.1, 0]]", "the edge from point 1, [0, 0], crosses or touches the edge from point 2"),
        ("[[0, 0], [0.1, 0.1], [0.2, 0.2000000001]]", "the points lie on a line: the polygon has no area"),
        ("[[0, 0.1], [0.3, 0.1], [0, 0.2]]", "point 1, [0, 0.1] is the lowest: the material must stand on the base"),
    ],
)
def test_a_wrong_point_is_named(write: Write, points: str, message: str) -> None:
    problem = only_problem(write(SLOPE.replace(HEAP, points)))
    assert problem.line == 6 and problem.message.startswith("[geometry] outline = ") and message in problem.message


def test_points_from_a_csv_file_beside_the_case(write: Write, tmp_path: Path) -> None:
    (tmp_path / "deposit.csv").write_text("# surface\nx [mm], y [mm]\n0,0\n300,0\n\n0,100\n")
    case = load_case(write(SLOPE.replace(HEAP, '"deposit.csv"')))
    assert case.geometry.outline == ((0.0, 0.0), (0.3, 0.0), (0.0, 0.1))
    (tmp_path / "deposit.csv").write_text("0,0\n0.3,0\n0,0.1\n")
    assert load_case(write(SLOPE.replace(HEAP, '"deposit.csv"'))) == case
    assert load_case(write(GOOD), [f"geometry.outline={tmp_path / 'deposit.csv'}"]) == case
    (tmp_path / "deposit.csv").unlink()
    assert load_case(write(resolved_toml(case))) == case  # the folder of a run needs no other file


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "cannot be read: No such file or directory"),
        (b"\xff\xfe\xfd", "not a text file in UTF-8"),
        (b"0" * 200_001, "larger than 200 kB, the limit of an outline"),
        (b"r,z\n0,0\n", "line 1: expected the header x,y or x [mm],y [mm], or two numbers"),
        (b"x,y\n0,0\n0;3\n", "line 3: 1 values, expected x and y, separated by a comma"),
        (b"x,y\n0,0\n0,3,0,0\n", "line 3: 4 values, expected x and y, separated by a comma; the decimal separator"),
        (b"x,y\n0,0\n-1,0\n", "line 3: -1,0: expected a number >= 0, in m"),
        (b"x [furlong],y\n0,0\n", 'line 2: 0,0: unknown unit "furlong"'),
        (b"x,y\n", "0 points, expected 3 to 500"),
    ],
)
def test_a_csv_file_that_is_no_outline_is_refused(
    write: Write, tmp_path: Path, content: bytes | None, message: str
) -> None:
    if content is not None:
        (tmp_path / "deposit.csv").write_bytes(content)
    problem = only_problem(write(SLOPE.replace(HEAP, '"deposit.csv"')))
    assert problem.line == 6 and message in problem.message
    given = only_problem(write(GOOD), f"geometry.outline={tmp_path / 'deposit.csv'}")
    assert given.file.startswith("--set geometry.outline=") and message in given.message


@pytest.mark.parametrize(
    ("addition", "message"),
    [
        ("radius = 0.3", "must not be given together with geometry.outline"),
        ("height = 0.1", "must not be given together with geometry.outline"),
        ("aspect = 3", "must not be given together with geometry.outline"),
        ("domain_length = 0.3", "must be larger than the largest x of geometry.outline"),
        ("domain_height = 0.1", "must be larger than the largest y of geometry.outline"),
    ],
)
def test_keys_that_an_outline_excludes(write: Write, addition: str, message: str) -> None:
    assert message in only_problem(write(SLOPE.replace(HEAP, f"{HEAP}\n{addition}"))).message


def test_the_json_schema_accepts_points_and_a_path() -> None:
    path, points = json_schema()["properties"]["geometry"]["properties"]["outline"]["oneOf"]
    assert path == {"type": "string"}
    assert (points["minItems"], points["items"]["items"]["minimum"]) == (3, 0.0)


def test_other_limits_of_an_outline(write: Write) -> None:
    path = write(SLOPE)
    assert "outlines are for" in only_problem(path, "geometry.model=quarter").message
    assert (
        "must be smaller than the largest x and y of"
        in only_problem(path, "grid.spacing=0.1", "geometry.base=rigid").message
    )
    assert "published columns are rectangles" in only_problem(path, "score.experiment=bui-2008").message
    assert (
        "has no meaning with stages.gate = false"
        in only_problem(path, "stages.gate=false", "stages.gate_speed=1").message
    )
    missing = problems_of(write(GOOD.replace("radius = 0.09\n", "")))
    assert [one.message.partition(":")[0] for one in missing] == ["[geometry] radius is missing"]


def test_an_outline_replaces_inherited_sizes_and_a_radius_an_inherited_outline(write: Write) -> None:
    child = f'extends = "coarse-channel"\n[geometry]\noutline = {HEAP}\n'
    geometry = load_case(write(child, "heap.toml")).geometry
    assert (geometry.radius, geometry.aspect, geometry.r_i) == (None, None, 0.3)
    back = 'extends = "heap.toml"\n[geometry]\nradius = 0.2\nheight = 0.1\n'
    geometry = load_case(write(back, "column.toml")).geometry
    assert (geometry.outline, geometry.r_i, geometry.h_i) == (None, 0.2, 0.1)


def test_the_first_law_is_elastic_without_a_gate(write: Write) -> None:
    path = write(SLOPE)
    assert load_case(path).stages.equilibrate.law == "mohr-coulomb"
    assert load_case(path, ["stages.gate=false"]).stages.equilibrate.law == "elastic"
    given = load_case(path, ["stages.gate=false", "stages.equilibrate.law=mohr-coulomb"])
    assert given.stages.equilibrate.law == "mohr-coulomb"
    assert len({case_hash(load_case(path)), case_hash(given), case_hash(load_case(write(GOOD)))}) == 3


def test_a_rectangle_keeps_the_laws_of_the_aspect_ratio(write: Write) -> None:
    geometry = load_case(write(SLOPE.replace(HEAP, "[[0, 0], [0.3, 0], [0.3, 0.1], [0.1, 0.1], [0, 0.1]]"))).geometry
    assert geometry.is_rectangle and geometry.column_section == "cylinder"
