"""Constraints between keys."""

from __future__ import annotations

import re

import pytest
from pydantic import ValidationError

from mpmcol.case import Case, Problem, case_hash, load_case
from mpmcol.case.toml_lines import locate
from mpmcol.errors import CaseError
from tests.support.case_files import GOOD, Write, error_of, only_problem, problems_of


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
def test_a_violation_names_both_keys_with_their_lines(
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


def test_keys_of_3d_models(write: Write) -> None:
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
def test_options_of_the_method_that_exclude_each_other(overrides: list[str], message: str) -> None:
    assert message in only_problem("coarse-channel", *(f"method.{each}" for each in overrides)).message


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (["geometry.base=granular", "base_material.law=elastic"], '"elastic" with an elastic or rigid base'),
        (["base_material.law=mohr-coulomb"], '"elastic" with an elastic or rigid base'),
        (["geometry.base=granular", "base_material.dilatancy_deg=40"], "must not exceed"),
        (["geometry.base=granular", "method.deactivate_base=true"], "a granular bed moves"),
        (["base_material.friction_deg=20"], "not a key of law elastic, but of mohr-coulomb"),
        (["geometry.base=granular", "base_material.frictio_deg=20"], 'did you mean "friction_deg"?'),
        (["geometry.base=granular", "base_material.law=sand"], "expected"),
    ],
)
def test_materials_of_bases(overrides: list[str], message: str) -> None:
    problem = only_problem("coarse-channel", *overrides)
    assert message in f"{problem.message} {problem.hint}"


def test_keys_of_the_base_that_follow_from_an_invalid_material_are_not_reported(write: Write) -> None:
    text = GOOD.replace("10e6", "-1e7") + "[base_material]\npoissons_ratio = 0.7\n"
    assert [problem.key for problem in problems_of(write(text))] == [
        "material.youngs_modulus",
        "base_material.poissons_ratio",
    ]


def test_violations_are_reported_together_with_other_problems(write: Write) -> None:
    text = GOOD.replace("10e6", "-1e7").replace("33.0", "33.0\ndilatancy_deg = 34")
    assert [problem.line for problem in problems_of(write(text))] == [15, 18]


def test_residual_angles_must_not_exceed_peak_angles() -> None:
    problem = only_problem("lube-channel-dense", "material.friction_residual_deg=51")
    assert "must not exceed material.friction_peak_deg = 50" in problem.message
    problem = only_problem("lube-channel-dense", "material.dilatancy_residual_deg=26")
    assert "must not exceed material.dilatancy_peak_deg = 25" in problem.message


def test_height_or_aspect_is_required(write: Write) -> None:
    problem = only_problem(write(GOOD.replace("aspect = 3.0\n", "")))
    assert (problem.line, problem.message) == (
        4,
        "[geometry] aspect is missing: give geometry.aspect or geometry.height",
    )


def test_the_experiment_must_be_for_this_kind_of_column() -> None:
    problem = only_problem("bui-rods", "geometry.model=axisymmetric")
    assert problem.message == (
        '[score] experiment = "bui-2008": is for another kind of column than geometry.model = "axisymmetric" '
        'and geometry.section = "cylinder"'
    )


def test_the_law_of_the_first_stage_is_elastic_or_that_of_the_column() -> None:
    problem = only_problem("coarse-channel", "stages.equilibrate.law=mohr-coulomb-softening")
    assert 'must be "elastic" or that of the column, material.law = "mohr-coulomb"' in problem.message


def test_constraints_apply_to_a_case_built_in_python() -> None:
    tables = load_case("coarse-channel").model_dump(by_alias=True)
    tables["grid"]["spacing"] = 1.0
    with pytest.raises(ValidationError, match=r"grid.spacing must be smaller than geometry.radius = 0.09"):
        Case.model_validate(tables)


RIGID = ["geometry.base=rigid", "method.wall_impulse=true"]


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (["friction.floor=0.3"], 'needs a rigid floor, not geometry.base = "elastic"'),
        (
            [RIGID[0], "method.wall_impulse=false", "friction.floor=0"],
            "needs the reaction of walls, not method.wall_impulse = false: set method.wall_impulse = true",
        ),
        (["method.wall_impulse=false", "output.wall_forces=true"], "needs the reaction of walls"),
        (["geometry.release=two-sided", "friction.back_wall=0.3"], "which only a one-sided plane column has"),
        (["geometry.model=quarter", "friction.back_wall=0"], "which only a one-sided plane column has"),
        (["geometry.model=quarter", "friction.back_wall=0"], "in 3D a wall with friction is one of [[walls]]"),
        (
            ["geometry.model=full", "friction.side_walls=0.3", "friction.channel_width=0.2"],
            "in 3D the sides of a channel are [[walls]] with side_from or side_to, and friction",
        ),
        (
            ["friction.side_walls=0.3"],
            "side_walls = 0.3: needs friction.channel_width, which is missing: give both",
        ),
        (
            ["friction.channel_width=0.2"],
            "channel_width = 0.2: needs friction.side_walls, which is missing: give both",
        ),
        (
            ["geometry.model=full", "friction.side_walls=0.3", "friction.channel_width=0.2"],
            "needs a channel in plane strain, not geometry.model",
        ),
        (["output.wall_forces=true", "method.deactivate_base=true"], "an inactive base transmits no forces"),
    ],
)
def test_friction_and_forces_need_walls_that_give_them(write: Write, overrides: list[str], message: str) -> None:
    assert message in only_problem(write(GOOD), *overrides).message


def test_friction_changes_the_hash_only_where_it_is_given(write: Write) -> None:
    base, *others = (
        case_hash(load_case(write(GOOD), [*RIGID, *more]))
        for more in ([], ["output.wall_forces=true"], ["friction.floor=0.4"], ["friction.floor=0.3"])
    )
    assert others[0] == base and len({base, *others}) == 3


def test_a_cone_without_friction_has_no_apex_at_which_it_could_fail() -> None:
    elastic = "density=1800.0, youngs_modulus=5e6, poissons_ratio=0.3"
    clay = f"material={{law='drucker-prager', {elastic}, friction_deg=0.0, cohesion=1e3, failure_strain=%s}}"
    (problem,) = problems_of("coarse-channel", clay % "0.0")
    assert "which has no apex" in problem.message and "failure_strain" in str(problem)
    load_case("coarse-channel", [clay % "inf"])
