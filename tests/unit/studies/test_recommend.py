"""Runs with a requested accuracy: selection from a table of errors, error bars, and plans."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mpmcol.case import load_case
from mpmcol.cli.accuracy import narrower_bars
from mpmcol.errors import UsageError
from mpmcol.io.results import Results
from mpmcol.setup.discretization import discretize
from mpmcol.studies.pareto import recommend, savings, shipped
from mpmcol.studies.pareto.certify import error_bar
from mpmcol.studies.pareto.savings import propose
from mpmcol.studies.pareto.score import BETA, ZETA
from mpmcol.studies.pareto.shipped import (
    ColumnParameters,
    ShippedConfiguration,
    neighbouring_cases,
    shipped_study,
)
from mpmcol.studies.pareto.study import shipped_studies
from tests.support.cli import invoke

ELASTIC = "density = 2650.0\nyoungs_modulus = 10e6\npoissons_ratio = 0.2\n"
ERRORS = {10.0: 0.2, 20.0: 0.08, 40.0: 0.0382}
BIASES = {"as specified": -0.1, "rigid floor": -0.05, "k0": -0.1, "E / 10": -0.1, "quarter in 3D": -0.1}


def configurations() -> Iterator[ShippedConfiguration]:
    """A table in which errors decrease with the spacing, and are half as large for "light"."""
    for case in shipped_study().cases:
        for variant in ("as specified", "light", "rigid floor", "k0", "E / 10", "quarter in 3D"):
            for cells, error in ERRORS.items():
                bounds = dict.fromkeys((ZETA, BETA), error / 2.0 if variant == "light" else error)
                pace = 6e-8 if variant == "quarter in 3D" else 3e-8
                bias = dict.fromkeys((ZETA, BETA), BIASES.get(variant, 0.0))
                scatter = dict.fromkeys((ZETA, BETA), 0.1 * error)
                yield ShippedConfiguration(case, variant, cells, pace, bias, scatter, dict.fromkeys(bias, 0.01), bounds)


@pytest.fixture(autouse=True)
def table(monkeypatch: pytest.MonkeyPatch) -> None:
    made = tuple(configurations())
    for module in (recommend, savings):
        monkeypatch.setattr(module, "shipped_configurations", lambda: made)


def test_the_cheapest_accurate_configuration_is_recommended() -> None:
    """With half the error, "light" reaches 5 % with half the cells, and it costs less per step."""
    found = recommend.recommend("lube-cylinder", (), 0.05)
    assert (found.variant, found.cells, found.error) == ("light", 20.0, 0.04)
    case = load_case("lube-cylinder", found.overrides)
    assert case.geometry.base == "rigid" and case.stages.initial_stress == "k0"
    assert case.grid.spacing == pytest.approx(case.geometry.r_i / 20.0)
    assert case.material.youngs_modulus < 2e6
    assert recommend.recommend("lube-cylinder", (), 0.02).cells == 40.0
    assert recommend.recommend("lube-cylinder", (), 0.5).cells == 10.0


def test_corrected_values_are_as_accurate_on_a_coarser_grid(monkeypatch: pytest.MonkeyPatch) -> None:
    """The study knows the errors better than they are small; a correction is at most twice the accuracy."""
    monkeypatch.setattr(recommend, "shipped_configurations", shipped.shipped_configurations)
    raw, corrected = (recommend.recommend("channel", ("geometry.aspect=1",), 0.05, one) for one in (False, True))
    assert corrected.core_seconds < 0.2 * raw.core_seconds
    for interval in corrected.intervals.values():
        assert interval.relative <= 0.05 and abs(1.0 - 1.0 / interval.factor) <= 0.1
    with pytest.raises(UsageError, match=r"has corrected values with errors of at most 1%(?s:.*)use --accuracy [2-9]"):
        recommend.recommend("channel", ("geometry.aspect=1",), 0.01, corrected=True)


def test_an_accuracy_is_proposed_only_if_the_study_permits_it() -> None:
    assert narrower_bars("lube-cylinder", (), 0.1) == "a finer grid makes it narrower: --accuracy 5%"
    assert "no configuration with half the error" in narrower_bars("lube-cylinder", (), 0.03)


def test_a_bound_holds_for_grids_finer_than_the_finest_of_a_neighbouring_case(monkeypatch: pytest.MonkeyPatch) -> None:
    """One neighbour was studied up to r_i/h = 40, the other, which needs a finer grid, up to 80."""
    needed, other = "cylinder, a = 0.9", "cylinder, a = 2.75"
    studied = [one for one in configurations() if one.case == other and one.cells != 20.0]
    for cells, error in ((10.0, 0.2), (20.0, 0.12), (40.0, 0.09), (80.0, 0.02)):
        values = dict.fromkeys((ZETA, BETA), error)
        studied.append(ShippedConfiguration(needed, "light", cells, 3e-8, values, values, values, values))
    monkeypatch.setattr(recommend, "shipped_configurations", lambda: tuple(studied))
    between = ("geometry.aspect=1.5",)
    found = recommend.recommend("lube-cylinder", between, 0.05)
    assert (found.cells, found.error) == (80.0, 0.02)  # 0.0191 of the other case at 40
    assert found.studied == 40.0 and not any("r_i/h" in str(difference) for difference in found.differences)
    assert "not all of these were studied beyond r_i/h = 40: its errors count" in str(found)
    offered = {(one.variant, one.cells) for one in recommend.options("lube-cylinder", between)}
    assert offered == {("light", 10.0), ("light", 40.0), ("light", 80.0)}  # at 20 the other case has a gap
    cases = [needed, other]
    assert set(recommend.studied_configurations(cases)) == {("light", 10.0), ("light", 40.0)}


def test_differences_from_the_study_are_reported(tmp_path: Path) -> None:
    assert (
        recommend.recommend("cylinder", ("material.density=1600", "material.youngs_modulus=5e6"), 0.1).differences == []
    )
    assert recommend.recommend("quarter", (), 0.1).differences == []
    values = ("geometry.aspect=12", "material.friction_deg=15", "method.transfer=pic", "stages.collapse.damping=0.1")
    found = recommend.recommend("channel", values, 0.1)
    assert list(map(str, found.differences)) == [
        "a = 12, in the study 0.5 to 7",
        "friction = 15, in the study 22 to 42",
        'method.transfer = "pic", in the study "taylor-flip"',
        "stages.collapse.damping = 0.1, in the study 0.05",
    ]
    assert "note: these errors may not apply: a = 12" in str(found)
    assert 'material.law = "mohr-coulomb-softening", in the study' in str(recommend.recommend("channel-dense", (), 0.1))


def test_a_quarter_becomes_axisymmetric_and_a_box_is_refused() -> None:
    found = recommend.recommend("lube-quarter", (), 0.05)
    case = load_case("lube-quarter", found.overrides)
    assert (case.geometry.model, case.grid.points_per_cell) == ("axisymmetric", 4)
    with pytest.raises(UsageError, match="no box columns; set grid.spacing instead"):
        recommend.recommend("lube-quarter", ("geometry.section=box",), 0.05)


def test_an_accuracy_out_of_reach_is_refused_with_the_best(tmp_path: Path) -> None:
    with pytest.raises(
        UsageError, match=r"at most 1% for cases like this one(.|\n)*r_i/h = 40(.|\n)*accuracy 2% or more"
    ):
        recommend.recommend("lube-cylinder", (), 0.01)
    path = tmp_path / "block.toml"
    path.write_text('extends = "lube-cylinder"\n[material]\nlaw = "elastic"\n' + ELASTIC)
    with pytest.raises(UsageError, match='law = "elastic": the errors were studied for materials with friction only'):
        recommend.recommend(path, (), 0.05)


@pytest.mark.parametrize(
    ("a", "friction", "cases"),
    [
        (0.9, 33.0, ["cylinder, a = 0.9"]),
        (0.4, 34.0, ["cylinder, a = 0.5"]),
        (1.5, 33.0, ["cylinder, a = 0.9", "cylinder, a = 2.75"]),
        (5.0, 33.0, ["cylinder, a = 2.75", "cylinder, a = 7"]),
        (10.0, 33.0, ["cylinder, a = 7"]),
        (2.75, 27.0, ["cylinder, a = 0.9, 22 degrees", "cylinder, a = 2.75"]),
        (0.9, 44.5, ["cylinder, a = 0.9, 42 degrees"]),
        (2.75, 41.0, ["cylinder, a = 0.9, 42 degrees", "cylinder, a = 2.75"]),
    ],
)
def test_a_column_has_neighbouring_cases(a: float, friction: float, cases: list[str]) -> None:
    assert sorted(neighbouring_cases(ColumnParameters("axisymmetric", a, friction))) == sorted(cases)


def test_a_plan_lists_saving_and_effect_of_each_change() -> None:
    found = {one.name: one for one in propose("lube-quarter", ("geometry.domain_length=1",), 0.1)}
    assert set(found) == {
        "axisymmetric instead of 3D", "rigid floor instead of the elastic layer",
        "initial stress assigned instead of loaded",
        "softer column and base", "domain sized by the expected runout",
    }  # fmt: skip
    assert found["axisymmetric instead of 3D"].cost_ratio < 0.05
    assert all(one.cost_ratio < 0.98 for one in found.values())
    assert found["domain sized by the expected runout"].effect == {ZETA: 0.0, BETA: 0.0}
    effect = found["rigid floor instead of the elastic layer"].effect
    assert effect is not None and effect[ZETA] == pytest.approx(0.95 / 0.9 - 1.0)
    finer = {one.name: one for one in propose("lube-cylinder", ("grid.spacing=0.002",), 0.1)}
    assert finer["coarser grid"].values["grid.spacing"] == pytest.approx(0.097 / 20.0)
    light = ("geometry.base=rigid", "stages.initial_stress=k0", "material.youngs_modulus=1e5")
    assert [one.name for one in propose("lube-cylinder", (*light, "geometry.domain_length=1"), 0.1)] == []
    whole = propose("lube-quarter", ("geometry.model=full",), 0.1)
    assert "a quarter instead of the full column" in {one.name for one in whole}


def test_a_plan_can_be_applied(tmp_path: Path) -> None:
    new = tmp_path / "new.toml"
    done = invoke("plan", "lube-cylinder", "--accuracy", "5%", "--apply", new)
    assert done.exit_code == 0, done.output
    assert "rigid floor instead of the elastic layer" in done.output and "+5.6%" in done.output
    assert 'cheapest within 5%: "light" at r_i/h = 20' in done.output
    assert load_case(str(new)).geometry.base == "rigid"


@pytest.mark.parametrize("text", ["5", "nan", "-1%", "0", "five", "5 mm"])
def test_an_accuracy_is_a_relative_error(text: str) -> None:
    done = invoke("run", "coarse-channel", "--accuracy", text)
    assert done.exit_code == 2 and "for example 5% or 0.05" in done.output


def test_certify_needs_accuracy() -> None:
    done = invoke("run", "coarse-channel", "--certify")
    assert done.exit_code == 2 and "--certify requires --accuracy" in done.output
    done = invoke("run", "coarse-channel", "--accuracy", "10%", "--certify", "--max-wall", "1h")
    assert done.exit_code == 2 and "--max-wall applies to a single run" in done.output


def test_a_dry_run_of_error_bars_shows_all_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    done = invoke("run", "lube-cylinder", "--accuracy", "20%", "--certify", "--dry-run")
    assert done.exit_code == 0 and "8 runs: " in done.stdout and "nothing was run" in done.stdout
    assert "runs on the finest grid are made if an error bar of the others is wider" in done.stdout
    assert list(tmp_path.iterdir()) == []


def test_a_dry_run_shows_the_recommendation(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    done = invoke("run", "lube-cylinder", "--accuracy", "20%", "--dry-run")
    assert done.exit_code == 0, done.output
    assert '"light" at r_i/h = 10' in done.output and "nothing was run" in done.output


def test_each_run_of_a_sweep_gets_the_recommended_configuration(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    command = ("sweep", "lube-cylinder", "--aspect", "0.9,2,9", "--accuracy", "5%")
    forecast = invoke(*command, "--dry-run", "--json")
    assert forecast.exit_code == 0, forecast.output
    single = load_case(
        "lube-cylinder", ["geometry.aspect=2", *recommend.recommend("lube-cylinder", (), 0.05).overrides]
    )
    points = json.loads(forecast.stdout)["runs"][1]["points"]
    assert points == discretize(single).most_points
    assert 'cheapest within 5%: "light" at r_i/h = 20 for 3 runs' in forecast.stderr
    assert "note: these errors may not apply to a = 9; in the study a is 0.5 to 7" in forecast.stderr
    planned = invoke(*command, "--engine", "commands")
    folder = tmp_path / "sweeps" / "lube-cylinder-accuracy0.05"
    assert planned.exit_code == 0 and len(planned.stdout.splitlines()) == 3
    assert {load_case(path).geometry.base for path in folder.glob("*/case.toml")} == {"rigid"}


def test_a_sweep_names_the_runs_for_which_no_configuration_is_accurate() -> None:
    refused = invoke("sweep", "lube-cylinder", "--aspect", "0.9,2", "--accuracy", "1%", "--dry-run")
    assert (refused.exit_code, refused.stdout) == (2, "")
    for run in ("run a0.9: ", "run a2: "):
        assert f"{run}no configuration of the study has errors of at most 1%" in refused.stderr


def test_the_shipped_study_has_five_percent_for_the_columns_of_the_paper(monkeypatch: pytest.MonkeyPatch) -> None:
    """The documented command `mpmcol sweep --aspect 0.5:7 --accuracy 5%` is not refused."""
    monkeypatch.setattr(recommend, "shipped_configurations", shipped.shipped_configurations)
    for case in ("cylinder", "channel"):
        for a in np.arange(0.5, 7.5, 0.5):
            assert recommend.recommend(case, (f"geometry.aspect={a}",), 0.05).error <= 0.05


@pytest.mark.parametrize("cells", [(13, 14, 19, 20, 27, 28), (19, 20, 27, 28, 39, 40, 55, 56)])
@pytest.mark.parametrize("order", [0.75, 1.0, 1.5, 2.0])
@pytest.mark.parametrize("scatter", [1e-4, 0.01])
def test_the_error_bar_contains_the_converged_value(cells: tuple[int, ...], order: float, scatter: float) -> None:
    """In at least 90 % of draws."""
    rng = np.random.default_rng(3)
    inside = 0
    for _ in range(300):
        runs = {one: 1.0 - 0.2 * (14 / one) ** order + scatter * rng.standard_normal() for one in cells}
        bar = error_bar(ZETA, runs)
        inside += abs(bar.value - 1.0) <= bar.error
    assert inside > 270


@pytest.mark.parametrize(("quantity", "widest"), [(ZETA, 0.11), (BETA, 0.06)])
def test_error_bars_from_the_study_contain_its_grid_converged_values(quantity: str, widest: float) -> None:
    """At least nine of ten bars from three neighbouring spacings, with the uncertainty of the converged values."""
    by_variant: dict[tuple[str, str], dict[float, dict[str, str]]] = {}
    for row in csv.DictReader(shipped_studies()["default"].with_suffix(".csv").read_text().splitlines()):
        if row[f"{quantity} bias"] and float(row["cells"]) >= 14.0:
            by_variant.setdefault((row["case"], row["variant"]), {})[float(row["cells"])] = row
    inside, widths = [], []
    for rows in by_variant.values():
        first = next(iter(rows.values()))
        reference, uncertainty = (float(first[f"{quantity} reference{name}"]) for name in ("", " uncertainty"))
        own = [(cells, reference * (1.0 + float(row[f"{quantity} bias"]))) for cells, row in sorted(rows.items())]
        for runs in zip(own, own[1:], own[2:], strict=False):
            bar = error_bar(quantity, dict(runs), float(first["a"]) if quantity == BETA else 1.0)
            inside.append(abs(bar.value - reference) <= np.hypot(bar.error, uncertainty * reference))
            widths.append(bar.relative)
    assert len(inside) == 158 and np.mean(inside) >= 0.9 and np.median(widths) < widest


def test_parts_of_the_error_bar() -> None:
    smooth = error_bar(ZETA, {cells: 10.0 - 10.0 / cells for cells in (10, 14, 20)})
    assert smooth.value == pytest.approx(10.0, abs=smooth.error) and smooth.error < 0.5 and "order" in smooth.cause
    irregular = error_bar(ZETA, {100: 0.9, 140: 0.96, 200: 0.94})
    assert irregular.from_misfit > irregular.from_order and "irregular" in irregular.cause
    exact = error_bar(ZETA, dict.fromkeys((100, 140, 200), 1.2))
    assert exact.relative == pytest.approx(0.01)
    coarse = error_bar(BETA, dict.fromkeys((10, 14, 20), 0.9), unit=2.0)  # a = 2: r_i is half of h_i
    assert coarse.error == pytest.approx(1.5 / 40.0) and coarse.cause.startswith("the spacing: 1.5 node spacings")
    runs = {9: 0.9, 10: 0.9, 13: 0.96, 14: 0.95, 19: 0.94, 20: 0.94}
    coarser = error_bar(ZETA, {5: 9.0, 6: 8.0, **runs})
    assert coarser.value == error_bar(ZETA, runs).value and list(coarser.runs) == [5, 6, *runs]


@pytest.mark.slow
def test_a_certified_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    arguments = ("run", "lube-cylinder", "--set", "stages.collapse.max_time_factor=1", "--accuracy", "20%", "--certify")
    done = invoke(*arguments)
    assert done.exit_code == 0, done.output
    folder = tmp_path / "runs" / "lube-cylinder-collapse.max_time_factor1-accuracy0.2-certified"
    assert (
        "zeta.front_height = " in done.output
        and "against Lube et al. 2004 (1.116, scatter 10%), differs" in done.output
    )
    assert "grid: error bar of runs up to r_i/h = " in done.output
    assert invoke("verify", str(folder)).exit_code == 0
    again: Any = json.loads(invoke(*arguments, "--json").stdout)
    bars, accuracy = again["error_bars"], again["accuracy"]
    assert json.loads((folder / "accuracy.json").read_text()) == accuracy
    assert accuracy["zeta"]["value"] == bars[ZETA]["value"] and accuracy["zeta"]["scatter"] == 0.0
    assert set(bars) == {ZETA, BETA} and bars[ZETA]["error"] > 0.0
    assert json.loads((folder / "error_bars.json").read_text()) == bars
    finest = max(bars[ZETA]["runs"], key=float)
    assert Results(folder).case.geometry.radius / Results(folder).case.grid.spacing == pytest.approx(float(finest))
    assert len(list((folder / "repeats").glob("cells*"))) == len(bars[ZETA]["runs"])


def test_certify_keeps_a_folder_with_other_files(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    done = invoke("run", "lube-cylinder", "--accuracy", "20%", "--certify", "--out", str(tmp_path))
    assert done.exit_code == 2 and "holds no run with --certify; use --out" in done.output
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]
