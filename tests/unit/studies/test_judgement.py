"""The judgement of a run: experiments are named where they apply, and the error of the grid where it was studied."""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import pytest

from mpmcol.case import load_case
from mpmcol.errors import UsageError
from mpmcol.studies import judgement
from mpmcol.studies.pareto.error_interval import ErrorInterval
from mpmcol.studies.pareto.recommend import recommend
from mpmcol.studies.pareto.score import BETA, ZETA
from mpmcol.studies.pareto.shipped import converged_values
from mpmcol.studies.pareto.studied import StudiedError, studied_error


def lines(
    name: str,
    zeta: float,
    beta: float,
    *overrides: str,
    error: float | None = None,
    cases: Sequence[str] = (),
    at_rest: bool = True,
    with_grid: bool = True,
) -> list[str]:
    """The judgement of a run with this result."""
    case = load_case(name, overrides)
    geometry = case.geometry
    summary: dict[str, Any] = {
        "front": {"front_height": geometry.r_i * (1.0 + zeta)}, "zeta": {"front_height": zeta},
        "height": beta * geometry.h_i, "beta": beta, "at_rest": at_rest,
    }  # fmt: skip
    results: Any = SimpleNamespace(case=case, summary=summary)
    studied = None if error is None else of_grid(error, cases)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(judgement, "studied_error", lambda case: studied)
        return judgement.judge(results, with_grid)


def of_grid(error: float, cases: Sequence[str]) -> StudiedError:
    """A grid on which runout and height are too small."""
    intervals = dict.fromkeys((ZETA, BETA), ErrorInterval(-error, 0.0))
    return StudiedError("light", 20.0, {ZETA: error, BETA: error}, intervals, cases)


def test_a_result_agrees_within_scatter_and_the_error_of_the_grid() -> None:
    runout, height, grid = lines("coarse-channel", 1.75, 0.9, error=0.0)
    expected = (
        "runout 157.5 mm, zeta = 1.750: +9.4% against Lube et al. 2007 (1.600, scatter 10%); on finer grids +9.4%: "
        "agrees within the scatter"
    )
    assert runout == expected
    assert "against Lube et al. 2007 (unverified) (1.000" in height and height.endswith(
        "(1.000, scatter 5%); on finer grids -10.0%: differs by more than the scatter and the error of the grid"
    )
    assert "error of the grid: -0.0% to +0.0% in runout" in grid


@pytest.mark.parametrize(
    ("zeta", "error", "ending"),
    [
        (
            1.36,
            0.12,
            "-15.0% against Lube et al. 2007 (1.600, scatter 10%); on finer grids -9.2%: agrees within the scatter",
        ),
        (1.36, 0.08, "on finer grids -11.3%: differs by more than the scatter and the error of the grid"),
        (1.33, 0.12, "on finer grids -11.2%: undecided within the error of the grid"),
        (
            1.70,
            0.12,
            "+6.2% against Lube et al. 2007 (1.600, scatter 10%); on finer grids +13.5%: differs by more than the "
            "scatter and the error of the grid",
        ),
    ],
)
def test_what_finer_grids_give_is_compared(zeta: float, error: float, ending: str) -> None:
    """On this grid runouts are too short by up to `error`: finer ones may agree better, or only this one agrees."""
    assert lines("coarse-channel", zeta, 0.9, error=error)[0].endswith(ending)


def test_without_an_error_of_the_grid_no_difference_is_certain() -> None:
    runout, *_, grid = lines("coarse-channel", 1.0, 1.0)
    assert runout.endswith("scatter 10%), undecided: beyond the scatter, but the error of the grid is not known")
    assert grid == "error of the grid: not studied for these settings; --accuracy 5% chooses studied ones"
    assert lines("coarse-channel", 1.6, 1.0)[0].endswith("agrees within the scatter")


def test_beside_a_statement_of_accuracy_nothing_is_undecided_for_want_of_an_error() -> None:
    far, _ = lines("coarse-channel", 1.0, 1.0, with_grid=False)
    assert far.endswith("-37.5% against Lube et al. 2007 (1.600, scatter 10%)")
    assert lines("coarse-channel", 1.6, 1.0, with_grid=False)[0].endswith("agrees within the scatter")


@pytest.mark.parametrize(
    "overrides",
    [
        ("material.friction_deg=0", "material.cohesion=3000"),
        ("geometry.slope_deg=5",),
        ("friction.floor=0.1", "geometry.base=rigid", "method.wall_impulse=true"),
    ],
)
def test_advice_for_less_error_is_accepted(overrides: tuple[str, ...]) -> None:
    """`--accuracy` refuses these cases, so that it is not proposed."""
    *_, grid = lines("coarse-channel", 1.0, 0.9, *overrides)
    assert grid.endswith("not studied for these settings; compare with a run at half the grid.spacing")
    with pytest.raises(UsageError, match="the errors were studied"):
        recommend("coarse-channel", overrides, 0.2)


def test_a_front_that_has_not_advanced_is_no_negative_runout() -> None:
    runout, *_ = lines("heap", -0.02, 1.0)
    assert runout.endswith("zeta = -0.020: the front has not advanced by a cell")


@pytest.mark.parametrize(
    ("overrides", "reason"),
    [
        (("material.cohesion=35e3",), "Lube et al. 2007: for grains without cohesion"),
        (("material.friction_deg=1",), "Lube et al. 2007: for friction of 28 to 40 deg; here it is 1 deg"),
        (
            ("material={ law = 'elastic', density = 2000, youngs_modulus = 1e6, poissons_ratio = 0.2 }",),
            "this material has none",
        ),
        (("geometry.aspect=30",), "no law for a >= 20"),
        (
            ("geometry.model=quarter", "geometry.section=box", "grid.points_per_cell=8"),
            "no published collapse of a box",
        ),
    ],
)
def test_no_experiment_is_named_that_does_not_apply(overrides: tuple[str, ...], reason: str) -> None:
    runout, height, why, grid = lines("coarse-channel", 1.0, 0.9, *overrides)
    assert "against" not in runout + height
    assert reason in why
    assert "not studied" in grid


def test_the_error_of_the_model_is_that_of_grid_converged_values() -> None:
    """There is none if the neighbouring case has not the friction of the experiment, or if the column still moves."""
    converged = converged_values()["channel, a = 1"]
    runout, height = converged[ZETA] / 1.6 - 1.0, converged[BETA] - 1.0
    *_, line = lines("coarse-channel", 1.6, 0.95, error=0.1, cases=["channel, a = 1"])
    assert line == (
        f"error of the model, which is left on fine grids: {runout:+.1%} in runout and {height:+.1%} in height against "
        "Lube et al. 2007"
    )
    *_, grid = lines("coarse-channel", 1.6, 0.95, error=0.1, cases=["channel, a = 1, 42 degrees"])
    assert grid.startswith("error of the grid: -10.0% to +0.0% in runout")
    *_, grid = lines("coarse-channel", 1.6, 0.95, error=0.1, cases=["channel, a = 1"], at_rest=False)
    assert grid.startswith("error of the grid: -10.0% to +0.0% in runout")


def test_a_column_that_still_moves_is_not_compared() -> None:
    runout, height, why, _ = lines("coarse-channel", 1.6, 1.0, at_rest=False)
    assert "against" not in runout + height and why.startswith("the column still moved at the end")
    assert why.endswith("stages.collapse.max_time_factor = 20 allows twice as many steps")
    assert "max_time_factor" not in lines("coarse-channel", 1.6, 1.0, 'stages.collapse.end="time"', at_rest=False)[2]


def test_another_experiment_with_a_similar_material_is_found() -> None:
    runout, *_ = lines("coarse-channel", 1.2, 0.9, "material.friction_deg=24")
    assert "Lajeunesse et al. 2005" in runout


def test_lengths_have_a_unit_that_suits_them() -> None:
    size = ("geometry.radius=12", "grid.spacing=0.6", "geometry.base_thickness=2.4")
    assert lines("coarse-channel", 1.5, 0.9, *size)[0].startswith("runout 18 m, ")


def test_runout_and_height_have_the_unit_of_the_larger_side_of_the_column() -> None:
    size = ("geometry.radius=0.5", "geometry.height=1", "grid.spacing=0.025", "geometry.base_thickness=0.1")
    runout, height, *_ = lines("coarse-channel", 1.5, 0.99996, *size)
    assert runout.startswith("runout 0.75 m, ") and height.startswith("height 1 m, ")


def test_the_first_run_of_a_user_has_an_error_of_the_grid() -> None:
    studied, finer = (
        studied_error(load_case("quickstart")),
        studied_error(load_case("quickstart", ["grid.spacing=0.004"])),
    )
    assert studied and finer and str(studied).endswith("r_i/h = 20") and str(finer).endswith("r_i/h = 20 and finer")
    assert finer.intervals[ZETA].high > studied.intervals[ZETA].high
    assert studied_error(load_case("quickstart", ["stages.initial_stress=gravity"])) is None
