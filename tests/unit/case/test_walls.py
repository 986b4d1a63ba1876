"""Walls of a case file: values, messages, and the boxes of cells that they become."""

from __future__ import annotations

import pytest

from mpmcol.case import case_hash, explain, load_case, resolved_toml
from mpmcol.errors import CaseError, UsageError
from mpmcol.setup.discretization import discretize
from mpmcol.setup.model import build_model
from mpmcol.setup.time_step import case_limit
from tests.support.case_files import GOOD, Write, only_problem

COARSE = ("grid.spacing=0.0075",)
QUARTER = ("geometry.base=rigid", "method.wall_impulse=true", "stages.initial_stress=k0", "grid.spacing=0.0194")


def with_walls(walls: str, *overrides: str, case: str = "frictional-floor"):  # type: ignore[no-untyped-def]
    return load_case(case, [*(COARSE if case == "frictional-floor" else QUARTER), f"walls=[{walls}]", *overrides])


def test_defaults_and_hash(write: Write) -> None:
    case, plain = with_walls("{from=0.18, to=0.21}, {from='30 cm', friction='20 deg', name='end'}"), with_walls("")
    assert [wall.name for wall in case.walls] == ["wall-1", "end"]
    assert case.walls[0].friction == 0.0 and case.walls[1].friction == pytest.approx(0.36397, abs=1e-5)
    assert load_case(write(resolved_toml(case))) == case
    named = with_walls("{from=0.18, to=0.21, name='dam'}, {from=0.3, friction='20 deg'}")
    assert case_hash(case) == case_hash(named) != case_hash(plain)
    assert "walls" not in resolved_toml(plain).replace("side_walls", "")
    assert "walls.half_width" in explain("walls")


@pytest.mark.parametrize(
    ("walls", "message"),
    [
        ("{from=0.05, to=0.21}", "wall wall-1: overlaps the column, which ends at x = 0.09 m; set from > 0.09 m"),
        ("{from=0.21, to=0.18}", "from = 0.21 m must be smaller than to = 0.18 m"),
        ("{to=0.18}", "[[walls]] 1: from is missing"),
        ("{from=0.18, name='gate'}", "not the name of another wall"),
        ("{from=0.18, name='a.b'}", "letters, digits and hyphens"),
        ("{from=0.18, to=0.21}, {from=0.2}", "walls wall-1 and wall-2 overlap"),
        ("{from=0.18, to=0.21, name='a'}, {from=0.3, name='a'}", "two walls have the name a"),
        ("{from=-0.18, to=-0.15}", "outside the domain, which begins at x = 0"),
        ("{from=0.18, half_width=0.1}", "half_width has no meaning in two dimensions"),
        ("{from=0.18, height=-1}", "[[walls]] 1: height = -1: expected a number > 0, in m"),
        ("{from=0.18, frm=3}", 'did you mean "from"?'),
        ("3", "expected an array of tables"),
    ],
)
def test_invalid_walls_are_refused(walls: str, message: str) -> None:
    with pytest.raises(CaseError) as refused:
        with_walls(walls)
    assert message in str(refused.value)


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (("geometry.base=elastic", "method.wall_impulse=true"), 'set geometry.base = "rigid" or "granular"'),
        (("geometry.base=rigid", "method.wall_impulse=false"), "set method.wall_impulse = true"),
    ],
)
def test_walls_need_a_firm_floor_and_the_reaction_of_walls(overrides: tuple[str, ...], message: str) -> None:
    with pytest.raises(CaseError) as refused:
        load_case("coarse-channel", ["walls=[{from=0.2}]", *overrides])
    assert message in str(refused.value)


@pytest.mark.parametrize(
    ("walls", "overrides", "message"),
    [
        ("{from=0.18, to=0.21}, {from=0.22}", (), "are 1 cell of 0.0075 m apart"),
        ("{from=0.18, to=5}", ("geometry.domain_length=1",), "to = 5 m: outside the domain"),
    ],
)
def test_walls_that_do_not_fit_the_grid_are_refused(walls: str, overrides: tuple[str, ...], message: str) -> None:
    with pytest.raises(UsageError) as refused:
        discretize(with_walls(walls, *overrides))
    assert message in str(refused.value)


@pytest.mark.parametrize(
    ("given", "line", "message"),
    [
        ("from = 0.18\nto = 0.19", 7, "[[walls]] 2: to = 0.19: wall wall-2: 1 cell of 0.0075 m, expected at least 2"),
        ("from = 0.18\nheight = 0.01", 7, "[[walls]] 2: height = 0.01: wall wall-2: 1 cell of 0.0075 m"),
        ("from = 0.05\nto = 0.2", 6, "[[walls]] 2: from = 0.05: wall wall-2: overlaps the column"),
        ("from = 0.4\nto = 0.45", 5, "[[walls]] 2: walls wall-1 and wall-2 overlap"),
    ],
)
def test_the_refusal_of_a_wall_names_its_line(write: Write, given: str, line: int, message: str) -> None:
    text = f'extends = "dam"\nschema = 1\n[[walls]]\nfrom = 0.3\n[[walls]]\n{given}\n'
    problem = only_problem(write(text))
    assert (problem.line, problem.message[: len(message)]) == (line, message)
    assert problem.about in ("walls", "walls.to", "walls.height", "walls.from")


def test_a_missing_radius_is_the_only_problem_of_a_case_with_walls(write: Write) -> None:
    text = GOOD.replace("radius = ", "height = ").replace("aspect = ", "# ")
    assert "height" in text.partition("[geometry]")[2]
    problem = only_problem(
        write(text), "walls=[{from=0.3, to=0.35}]", 'geometry.base="rigid"', "method.wall_impulse=true"
    )
    assert "radius is missing" in problem.message


def test_the_refusal_of_a_name_is_printable() -> None:
    with pytest.raises(CaseError) as refused:
        with_walls('{from=0.18, name="a\\u001b[0m"}')
    assert "wall a?[0m: expected letters" in str(refused.value) and str(refused.value).replace("\n", "").isprintable()


def test_a_wall_in_a_quarter_is_as_thick_as_its_half(write: Write) -> None:
    """The half width is the part that is modelled: one cell of a quarter, two of a full column."""
    wall = "{from=0.194, to=0.2522, height=0.0582, half_width=0.0194}"
    with pytest.raises(CaseError, match=r"half_width = 0.0194: wall wall-1: 1 cell of 0.0194 m"):
        with_walls(wall, case="quarter")
    assert with_walls(wall, "geometry.model=full", case="quarter").walls


def test_edges_are_on_nodes_and_the_domain_ends_in_an_end_wall() -> None:
    dam = discretize(with_walls("{from=0.183, to=0.21, height=0.045}"))
    assert (dam.wall_boxes[0].low, dam.wall_boxes[0].high) == ((24, 0), (28, 6))
    (warning,) = (text for text in dam.warnings if "became" in text)
    assert warning == "wall wall-1: from became 0.18 m (-0.003 m), on a node of the grid"
    end = discretize(with_walls("{from=0.18}"))
    assert end.cells == (29, end.cells_up) and not any("wall" in text for text in end.warnings)
    assert end.wall_boxes[0].high == end.cells
    tall = discretize(with_walls("{from=0.18, to=0.21, height=0.3}"))
    assert tall.cells_up == 46


def test_in_three_dimensions_walls_have_a_width_and_a_quarter_its_half() -> None:
    quarter = discretize(with_walls("{from=0.194, to=0.2522, height=0.0582, half_width=0.0776}", case="quarter"))
    assert (quarter.wall_boxes[0].low, quarter.wall_boxes[0].high) == ((10, 0, 0), (13, 3, 4))
    full = with_walls(
        "{from=-0.2522, to=-0.194, side_from=-0.0388, side_to=0.0582}", "geometry.model=full", case="quarter"
    )
    box, n = discretize(full).wall_boxes[0], discretize(full).cells_along
    assert (box.low, box.high[::2]) == ((n - 13, 0, n - 2), (n - 10, n + 3))
    across = discretize(with_walls("{from=0.194, to=0.2522}", case="quarter"))
    assert across.wall_boxes[0].high == (13, *across.cells[1:])


def test_a_bed_has_no_points_in_a_wall() -> None:
    case = load_case("granular-bed", ["grid.spacing=0.0075", "walls=[{from=0.18, to=0.21, height=0.03}]"])
    model, plain = build_model(case), build_model(load_case("granular-bed", ["grid.spacing=0.0075"]))
    x = model.points.x
    assert not ((x[:, 0] > 0.18) & (x[:, 0] < 0.21) & (x[:, 1] < 0.03)).any()
    assert len(plain.points) - len(model.points) == 4 * 2 * 9 and model.discretization.wall_boxes[0].low[1] == 0


def test_the_stability_limit_is_that_beside_one_face() -> None:
    limit, where = case_limit(with_walls("{from=0.18}", "friction.floor=0.3"))
    assert (limit, where) == (pytest.approx(0.537, abs=1e-3), "next to two walls with friction")
