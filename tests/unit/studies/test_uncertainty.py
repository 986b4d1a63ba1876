"""Uncertain inputs: distributions, samples, statistics and shares of the variance against closed forms."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from scipy.stats import spearmanr

from mpmcol.errors import CaseError, UsageError
from mpmcol.report.uncertainty import uncertainty_sections
from mpmcol.studies.pareto.recommend import recommend
from mpmcol.studies.uncertainty.analysis import Passing, analyse
from mpmcol.studies.uncertainty.chart import _draw_passes, bar_label
from mpmcol.studies.uncertainty.inputs import parse_inputs
from mpmcol.studies.uncertainty.plan import plan_study, study_name
from mpmcol.studies.uncertainty.record import as_record, summary_lines
from mpmcol.studies.uncertainty.report import write_report
from mpmcol.studies.uncertainty.sampling import CFL_RANGE, draw_sample
from mpmcol.studies.uncertainty.statistics import median_ranks, probability_of, statistics_of
from mpmcol.studies.uncertainty.variance_shares import neighbour_variance, variance_shares
from mpmcol.sweep.axes import Axis
from mpmcol.sweep.table import read_table
from tests.support.json_keys import names_in, unexplained
from tests.support.uncertain import ASPECT, DENSITY, FRICTION, THREE, ended, inputs_of, planned, sampled

SURFACE_ERROR = 0.01  # of indices that are estimated with 4096 random points


@pytest.mark.parametrize(
    ("option", "mean", "deviation"),
    [
        (f"{FRICTION}=normal:33,1.5", 33.0, 1.5),
        ("grid.spacing=uniform:2 mm,0.4 cm", 3e-3, 2e-3 / np.sqrt(12.0)),
        (f"{ASPECT}=triangular:1,2,4", 7.0 / 3.0, np.sqrt((1 + 4 + 16 - 2 - 4 - 8) / 18.0)),
        ("material.cohesion = lognormal:1 kPa,2", 1e3 * np.exp(0.5 * np.log(2.0) ** 2), None),
        ("friction.floor=uniform:20 deg,30 deg", 0.5 * (np.tan(np.pi / 9) + np.tan(np.pi / 6)), None),
    ],
)
def test_distributions_have_their_known_moments(option: str, mean: float, deviation: float | None) -> None:
    (one,) = inputs_of(option)
    assert one.distribution.mean == pytest.approx(mean)
    assert deviation is None or one.distribution.standard_deviation == pytest.approx(deviation)


def test_a_lognormal_factor_contains_68_percent() -> None:
    (one,) = inputs_of("material.cohesion=lognormal:100,1.5")
    frozen = one.distribution.frozen
    assert frozen.cdf(150.0) - frozen.cdf(100.0 / 1.5) == pytest.approx(0.6827, abs=1e-4)
    assert frozen.median() == pytest.approx(100.0)


@pytest.mark.parametrize("option", [*THREE, "material.cohesion=lognormal:100,1.5"])
def test_standardised_values_have_the_standard_distribution(option: str) -> None:
    (one,) = inputs_of(option)
    shares = np.array([0.1, 0.5, 0.9])
    values = one.distribution.frozen.ppf(shares)
    assert one.distribution.standard.cdf(one.distribution.standardised(values)) == pytest.approx(shares)
    assert (one.distribution.standard.mean(), one.distribution.standard.std()) == pytest.approx((0.0, 1.0), abs=1e-12)


@pytest.mark.parametrize(
    ("option", "message"),
    [
        ("friction", "expected KEY=DISTRIBUTION, for example material.friction_deg=normal:33,1.5"),
        ("material.frction_deg=normal:33,1", 'Did you mean "material.friction_deg"?'),
        ("material.law=normal:33,1", "material.law is not a quantity"),
        ("grid.points_per_cell=uniform:4,9", "grid.points_per_cell is not a quantity"),
        ("time.cfl=normal:0.5,0.1", "time.cfl differs between the runs by itself"),
        (f"{FRICTION}=33", "expected normal:MEAN,SD, lognormal:MEDIAN,FACTOR"),
        (f"{FRICTION}=norm:33,1", "expected normal:MEAN,SD, lognormal:MEDIAN,FACTOR"),
        (f"{FRICTION}=normal:33", "expected normal:MEAN,SD with 2 numbers, found 1"),
        (f"{FRICTION}=normal:33,x", 'SD = "x": not a number with a unit'),
        (f"{FRICTION}=normal:33,0", "expected normal:MEAN,SD with SD > 0"),
        (f"{FRICTION}=normal:33 kPa,1", '"kPa" cannot be converted to deg'),
        (f"{FRICTION}=normal:1e999,1", "expected a finite number"),
        (f"{FRICTION}=uniform:36,30", "LOW < HIGH"),
        (f"{FRICTION}=triangular:30,40,36", "LOW <= MODE <= HIGH"),
        ("material.cohesion=lognormal:100,0.9", "68 % of the values are within MEDIAN/FACTOR to MEDIAN*FACTOR"),
        ("friction.floor=normal:0.4,2 deg", '"deg" cannot be converted to a number without unit'),
    ],
)
def test_bad_options_are_refused(option: str, message: str) -> None:
    inputs, seeds, (problem,) = parse_inputs([option])
    assert not inputs and not seeds and message in str(problem) and str(problem).startswith("--uncertain ")


def test_a_key_has_one_distribution() -> None:
    problem = parse_inputs([f"{FRICTION}=normal:33,1", f"{FRICTION}=normal:30,1"]).problems[0]
    assert f"{FRICTION} is given twice" in str(problem)


def test_a_hypercube_has_one_value_in_each_interval_and_is_reproducible() -> None:
    inputs = inputs_of(*THREE)
    sample = draw_sample(inputs, 0.5, 32, 7)
    for one in inputs:
        shares = one.distribution.frozen.cdf(sample.numbers(one.key))
        assert sorted(np.floor(32 * shares)) == list(range(32))
    cfl = np.array([float(text) for text in sample.cfl])
    assert sorted(np.floor(32 * (0.5 - cfl) / (0.5 * CFL_RANGE))) == list(range(32))
    assert abs(spearmanr(cfl, sample.numbers(FRICTION)).statistic) < 0.5  # the scatter is no input
    assert draw_sample(inputs, 0.5, 32, 7) == sample != draw_sample(inputs, 0.5, 32, 8)


def test_a_small_deviation_is_resolved() -> None:
    (one,) = inputs_of("material.density=normal:1000,0.01")
    values = sampled([one], 16)[:, 0]
    assert values.std(ddof=1) == pytest.approx(0.01, rel=0.15) and len(set(values)) == 16


def test_statistics_of_a_linear_model_are_those_of_its_distributions() -> None:
    """The variance of a sum of independent terms is the sum of theirs; a hypercube has it to a few per cent."""
    inputs = inputs_of(*THREE)
    factors = np.array([0.1, 0.002, 0.3])
    y = sampled(inputs, 256) @ factors
    found = statistics_of(y)
    deviations = factors * [one.distribution.standard_deviation for one in inputs]
    assert found.mean == pytest.approx(factors @ [one.distribution.mean for one in inputs], rel=1e-3)
    assert found.standard_deviation == pytest.approx(np.linalg.norm(deviations), rel=0.05)
    shares = variance_shares(inputs, sampled(inputs, 256), y, seed=0)
    assert shares and shares.surface == "quadratic" and shares.residual == pytest.approx(0.0, abs=1e-12)
    expected = deviations**2 / (deviations**2).sum()
    assert list(shares.first_order.values()) == pytest.approx(expected, abs=SURFACE_ERROR)
    assert list(shares.total.values()) == pytest.approx(expected, abs=SURFACE_ERROR)


def test_scatter_is_a_share_of_its_own() -> None:
    """Of y = x + e with var(e) = var(x), half of the variance is scatter."""
    inputs = inputs_of(THREE[0])
    x = sampled(inputs, 400)
    y = x[:, 0] + np.random.default_rng(0).normal(0.0, 1.5, len(x))
    shares = variance_shares(inputs, x, y, seed=0)
    assert shares and shares.residual == pytest.approx(0.5, abs=0.05)
    assert shares.first_order[FRICTION] == pytest.approx(1.0 - shares.residual)
    assert shares.cross_validated_r2 < shares.adjusted_r2 < shares.r2
    assert shares.scatter == pytest.approx(0.5, abs=0.07) and shares.scatter <= shares.residual


def test_scatter_is_separated_from_terms_that_the_surface_omits() -> None:
    """A cubic term without scatter: all of the residual is the term. Several inputs: not separated."""
    inputs = inputs_of(THREE[0])
    x = sampled(inputs, 64)
    z = (x[:, 0] - 33.0) / 1.5
    shares = variance_shares(inputs, x, z**3 - 3.0 * z, seed=0)
    assert shares and shares.residual > 0.5 and shares.scatter == pytest.approx(0.0, abs=0.02)
    two = inputs_of(*THREE[:2])
    several = variance_shares(two, sampled(two, 64), sampled(two, 64)[:, 0], seed=0)
    assert several and several.scatter is None


def test_variance_about_a_line_by_hand() -> None:
    """Of 0, 1, 0 at equal distances the middle differs by 1 from the mean of the others, with the variance 3/2."""
    assert neighbour_variance(np.array([0.0, 2.0, 1.0]), np.array([0.0, 0.0, 1.0])) == pytest.approx(2.0 / 3.0)
    apart = np.array([0.0, 1.0, 4.0])  # the middle counts with weights 3/4 and 1/4
    assert neighbour_variance(apart, np.array([0.0, 1.0, 0.0])) == pytest.approx(1.0 / 1.625)
    assert neighbour_variance(apart, np.array([3.0, 5.0, 11.0])) == pytest.approx(0.0, abs=1e-25)


def test_pure_scatter_has_no_input() -> None:
    inputs = inputs_of(*THREE)
    y = np.random.default_rng(1).normal(size=400)
    shares = variance_shares(inputs, sampled(inputs, 400), y, seed=0)
    assert shares and max(shares.total.values()) < 0.05 and shares.residual > 0.95


def scattered(deviation: float) -> Callable[[Mapping[str, Any]], dict[str, Any]]:
    """Runs whose runout decreases by 0.02 per degree, and scatters."""
    scatter = np.random.default_rng(3)

    def result(inputs: Mapping[str, Any]) -> dict[str, Any]:
        return {"zeta": {"front_height": 1.6 - 0.02 * (inputs[FRICTION] - 33.0) + scatter.normal(0.0, deviation)}}

    return result


@pytest.mark.parametrize(
    ("deviation", "note", "is_given"),
    [(0.005, "", True), (0.024, "the shares are not reliable", True), (0.3, "shares are not given", False)],
)
def test_shares_of_a_surface_that_does_not_describe_the_runs_are_not_given(
    tmp_path: Path, deviation: float, note: str, is_given: bool
) -> None:
    """The inputs have a standard deviation of 0.03 in runout; above are R2 of about 1, 0.4 and below 0."""
    plan = planned(tmp_path, f"{FRICTION}=normal:33,1.5", samples=16)
    analysis = analyse(plan, ended(plan, scattered(deviation)))
    (zeta,) = analysis.quantities
    assert zeta.shares and note in zeta.shares.note and bool(note) == bool(zeta.shares.note)
    assert zeta.shares.is_given == (zeta.shares.cross_validated_r2 >= 0.0) == is_given
    assert bar_label(zeta).endswith("(not reliable)") == bool(note)
    report = write_report(analysis, tmp_path)
    (row,) = report.record["quantities"]
    assert (row["first_order"][FRICTION] is not None) == (row["residual"] is not None) == is_given
    assert (
        row["note"] == (zeta.shares.note or None) and unexplained("uncertainty.json", names_in(report.record)) == set()
    )
    text = "\n".join(summary_lines(analysis))
    assert note in text and (f"({100 * zeta.shares.total[FRICTION]:.0f})" in text) == is_given
    sweep: Any = SimpleNamespace(runs=[SimpleNamespace(folder=run.folder.name) for run in plan.runs])
    (section,) = uncertainty_sections(tmp_path, sweep)
    assert any(note in line for line in section.lines) and (row["note"] is None) == (len(section.lines) == 2)
    assert (section.tables[1].rows[0][1] == "") != is_given


def test_an_interaction_is_in_the_total_index_only() -> None:
    """Of y = z1 z2 with standard normal z, all variance is the interaction; y = z1 + z1 z2 has half of it in z1."""
    inputs = inputs_of(f"{FRICTION}=normal:33,1", f"{DENSITY}=normal:1600,10")
    x = sampled(inputs, 64)
    z = (x - [33.0, 1600.0]) / [1.0, 10.0]
    pure = variance_shares(inputs, x, z[:, 0] * z[:, 1], seed=0)
    assert pure and list(pure.first_order.values()) == pytest.approx([0.0, 0.0], abs=5 * SURFACE_ERROR)
    assert list(pure.total.values()) == pytest.approx([1.0, 1.0], abs=5 * SURFACE_ERROR)
    mixed = variance_shares(inputs, x, z[:, 0] + z[:, 0] * z[:, 1], seed=0)
    assert mixed and mixed.first_order[FRICTION] == pytest.approx(0.5, abs=5 * SURFACE_ERROR)
    assert mixed.total[DENSITY] == pytest.approx(0.5, abs=5 * SURFACE_ERROR)


@pytest.mark.parametrize(("count", "surface"), [(20, "quadratic"), (19, "linear"), (8, "linear"), (7, None)])
def test_the_surface_has_two_runs_for_each_coefficient(count: int, surface: str | None) -> None:
    inputs = inputs_of(*THREE)  # 10 coefficients with squares and products, 4 without
    x = sampled(inputs, count)
    shares = variance_shares(inputs, x, x.sum(axis=1), seed=0)
    assert (shares.surface if shares else None) == surface


def test_equal_values_have_no_shares() -> None:
    inputs = inputs_of(THREE[0])
    assert variance_shares(inputs, sampled(inputs, 8), np.full(8, 0.5), seed=0) is None


@pytest.mark.parametrize(
    ("count", "ranks"),
    [(4, None), (5, (1, 5)), (8, (2, 7)), (10, (2, 9)), (20, (6, 15)), (25, (8, 18)), (50, (19, 32))],
)
def test_ranks_of_the_interval_of_the_median(count: int, ranks: tuple[int, int] | None) -> None:
    """Of ten values, the second and the ninth enclose the median with 1 - 2 (1 + 10) / 1024 = 97.9 %, the third and the
    eighth with 1 - 2 (1 + 10 + 45) / 1024 = 89.1 %, which is too little."""
    assert median_ranks(count, 0.90) == ranks


def test_quantiles_and_the_interval_of_the_median() -> None:
    found = statistics_of(np.arange(1.0, 21.0))
    assert found.median_interval == (6.0, 15.0) and found.quantiles["median"] == 10.5
    assert found.quantiles["p25"] == pytest.approx(1 / 3 + 20.3333333 * 0.25)  # Hyndman & Fan, type 8
    assert statistics_of(np.array([1.0, 2.0, 3.0])).median_interval is None


@pytest.mark.parametrize(
    ("met", "count", "lo", "hi"),
    [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)],
)
def test_the_wilson_interval(met: int, count: int, lo: float, hi: float) -> None:
    """Table I of Newcombe 1998, method 3 (doi:10.1002/(SICI)1097-0258(19980430)17:8<857::AID-SIM777>3.0.CO;2-E)."""
    found = probability_of(np.arange(count) < met)
    assert (found.lo, found.hi) == pytest.approx((lo, hi), abs=5e-5)
    assert found.value == met / count


def test_runs_are_planned_with_the_sample_and_names_that_state_it(tmp_path: Path) -> None:
    plan = planned(tmp_path, THREE[0])
    again = planned(tmp_path, THREE[0])
    assert [run.folder for run in plan.runs] == [run.folder for run in again.runs]
    assert len({run.folder for run in plan.runs}) == 16
    for run, friction, cfl in zip(plan.runs, plan.sample.numbers(FRICTION), plan.sample.cfl, strict=True):
        assert (run.case.material.friction_deg, run.case.time.cfl) == (friction, float(cfl))
        assert run.name == f"friction{friction:g}deg-cfl{float(cfl):.6g}"


def test_the_default_folder_names_case_keys_and_accuracy() -> None:
    fixed = [Axis(ASPECT, ("2",)), Axis("method.transfer", ("apic",))]
    name = study_name("coarse-channel", fixed, inputs_of(*THREE[:2]), 0.05)
    assert name == "coarse-channel-a2-transfer-apic-friction_deg-density-accuracy0.05-uncertain"


def test_all_runs_have_the_grid_for_the_means(tmp_path: Path) -> None:
    plan = planned(tmp_path, f"{FRICTION}=normal:31,3", f"{ASPECT}=uniform:0.9,1.3", accuracy=0.05)
    advice = recommend("coarse-channel", [f"{FRICTION}=31", f"{ASPECT}=1.1"], 0.05)
    assert plan.recommendation == advice
    (spacing,) = {run.case.grid.spacing for run in plan.runs}
    assert spacing == pytest.approx(advice.values["grid.spacing"], rel=1e-8)  # written with nine digits
    assert {run.case.geometry.base for run in plan.runs} == {advice.values.get("geometry.base", "elastic")}
    assert f"r_i/h = {advice.cells:g}" in plan.lines()[0]


@pytest.mark.parametrize(
    ("options", "fixed", "accuracy", "message"),
    [
        ([f"{FRICTION}=normal:33,20"], {}, None, ["= -", "expected a number >= 0 and <= 89", "truncated range"]),
        (["material.dilatancy_deg=uniform:0,40"], {}, None, ["must not exceed material.friction_deg", "(11 of 64"]),
        ([THREE[0]], {FRICTION: ("30",)}, None, [f"{FRICTION} is uncertain as well"]),
        ([THREE[0]], {ASPECT: ("1", "2")}, None, ["--set geometry.aspect=1,2: expected one value"]),
        (["grid.spacing=uniform:0.004,0.006"], {}, 0.05, ["--accuracy chooses grid.spacing"]),
        ([f"{FRICTION}=uniform:86,96"], {}, 0.05, ["sample ", "expected a number >= 0 and <= 89", "uniform:86."]),
        ([THREE[0]], {"grid.spacing": ("-1",)}, None, ["--set grid.spacing=-1: [grid] spacing = -1"]),
    ],
)
def test_samples_that_a_case_does_not_accept_are_refused(
    options: list[str], fixed: dict[str, tuple[str, ...]], accuracy: float | None, message: list[str], tmp_path: Path
) -> None:
    axes = [Axis(key, values) for key, values in fixed.items()]
    with pytest.raises(CaseError) as refused:
        plan_study("coarse-channel", axes, inputs_of(*options), tmp_path, samples=64, seed=0, accuracy=accuracy)
    assert all(part in str(refused.value) for part in message) and "nothing was run" in str(refused.value)


def test_the_message_names_key_sample_and_distribution(tmp_path: Path) -> None:
    with pytest.raises(CaseError) as refused:
        planned(tmp_path, f"{FRICTION}=normal:33,20", samples=64)
    first = str(refused.value).partition("\n")[0]
    assert first.startswith(f"--uncertain {FRICTION}=normal:33,20: sample 5 of 64, {FRICTION} = -")


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"samples": 4}, "samples = 4: expected 5 to 10,000"),
        ({"seed": -1}, "seed = -1: expected an integer >= 0"),
        ({"accuracy": 5.0}, "accuracy = 5.0: expected a relative error between 0 and 1"),
    ],
)
def test_numbers_out_of_range_are_refused(values: dict[str, Any], message: str, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=message):
        plan_study("coarse-channel", [], inputs_of(THREE[0]), tmp_path, **{"samples": 8, "seed": 0, **values})


def test_a_fixed_value_of_what_the_accuracy_chooses_is_refused(tmp_path: Path) -> None:
    axes = [Axis("grid.spacing", ("0.01",))]
    with pytest.raises(UsageError, match="--accuracy chooses grid.spacing = .*; remove --set grid.spacing=0.01"):
        plan_study("coarse-channel", axes, inputs_of(THREE[0]), tmp_path, samples=8, seed=0, accuracy=0.1)


def linear_result(inputs: Any) -> dict[str, Any]:
    """A run whose runout decreases linearly with the friction angle."""
    zeta = 1.6 - 0.02 * (inputs[FRICTION] - 33.0)
    return {
        "zeta": {"front_height": zeta},
        "front": {"front_height": {"mean": 0.09 * (1.0 + zeta), "min": 0.0, "max": 1.0}},
        "beta": 0.9,
        "repose_angle_deg": None,
        "wall_forces": {"dam": {"peak": 10.0 * zeta, "sustained": None}, "gate": {"peak": 0.0}},
    }


def test_an_analysis_of_known_results(tmp_path: Path) -> None:
    plan = planned(tmp_path, f"{FRICTION}=normal:33,1.5", samples=64, accuracy=0.05)
    analysis = analyse(plan, ended(plan, linear_result), distances=[0.234, 0.3])
    quantities = {one.name: one for one in analysis.quantities}
    assert list(quantities) == ["zeta.front_height", "front.front_height", "beta", "wall_forces.dam.peak"]
    zeta = quantities["zeta.front_height"]
    assert zeta.statistics.mean == pytest.approx(1.6, abs=1e-3)
    assert zeta.statistics.standard_deviation == pytest.approx(0.03, rel=0.03)
    assert zeta.shares and zeta.shares.first_order[FRICTION] == pytest.approx(1.0)
    assert plan.recommendation and zeta.grid_deviation == pytest.approx(
        plan.recommendation.errors["zeta.front_height"] / 1.645 * zeta.statistics.mean
    )
    assert quantities["beta"].shares is None and quantities["beta"].grid_share == pytest.approx(1.0)
    assert (quantities["wall_forces.dam.peak"].unit, quantities["wall_forces.dam.peak"].grid_share) == ("N/m", None)
    half, none = (passing.probability for passing in analysis.passes)
    assert (half.met, none.met, half.count) == (32, 0, 64)


def test_runout_front_and_height_are_corrected_for_the_error_of_the_grid(tmp_path: Path) -> None:
    raw = planned(tmp_path, f"{FRICTION}=normal:33,1.5", samples=64, accuracy=0.05)
    plan = planned(tmp_path, f"{FRICTION}=normal:33,1.5", samples=64, accuracy=0.05, corrected=True)
    assert plan.recommendation and raw.recommendation and plan.recommendation.cells < raw.recommendation.cells
    analysis = analyse(plan, ended(plan, linear_result))
    zeta, front, beta, dam = (one.statistics.mean for one in analysis.quantities)
    intervals, r_i = plan.recommendation.intervals, plan.means.geometry.r_i
    assert zeta == pytest.approx(1.6 * intervals["zeta.front_height"].factor, abs=1e-3) and zeta > 1.65
    assert front == pytest.approx(r_i * (1.0 + zeta)) and beta == pytest.approx(0.9 * intervals["beta"].factor)
    assert dam == pytest.approx(16.0, abs=0.01)
    assert next(summary_lines(analysis)).endswith("; runout, front and height corrected for the error of the grid")
    assert analysis.quantities[0].grid_deviation == pytest.approx(
        intervals["zeta.front_height"].relative / 1.645 * zeta
    )


def test_the_files_and_their_names_are_explained(tmp_path: Path) -> None:
    plan = planned(tmp_path, *THREE[:2], samples=16)
    analysis = analyse(plan, ended(plan, linear_result), distances=[0.234])
    report = write_report(analysis, tmp_path)
    assert [path.name for path in report.files] == ["uncertainty.json", "uncertainty.csv", "uncertainty.png"]
    record = json.loads((tmp_path / "uncertainty.json").read_text())
    assert record == as_record(analysis) and unexplained("uncertainty.json", names_in(record)) == set()
    rows = read_table(tmp_path / "uncertainty.csv")
    assert unexplained("uncertainty.csv", iter(rows[0])) == set()
    assert float(rows[0]["mean"]) == analysis.quantities[0].statistics.mean
    before = [path.stat().st_mtime_ns for path in report.files]
    write_report(analysis, tmp_path)
    assert [path.stat().st_mtime_ns for path in report.files] == before
    text = "\n".join(summary_lines(analysis))
    assert "16 of 16 runs of a Latin hypercube (seed 0)" in text and "not studied" in text
    assert "front_height passes 0.234 m from the wall or axis in 8 of 16 runs: probability 0.5" in text


def test_failed_runs_are_in_no_statistics(tmp_path: Path) -> None:
    plan = planned(tmp_path, THREE[0], samples=8)
    outcomes = ended(plan, linear_result)
    failed = [type(outcomes[0])(one.run, type(one.result)("failed", 1)) for one in outcomes[:6]]
    analysis = analyse(plan, [*failed, *outcomes[6:]])
    assert analysis.done == 2 and analysis.quantities[0].statistics.count == 2
    assert "2 of 8 runs" in (text := "\n".join(summary_lines(analysis))) and "may bias" in text
    assert "the variance is not split" in text and write_report(analysis, tmp_path).files[-1].exists()
    nothing = analyse(plan, failed + failed[:2], distances=[0.2])
    assert (nothing.done, list(nothing.quantities), list(nothing.passes)) == (0, [], [])
    assert [path.name for path in write_report(nothing, tmp_path).files] == ["uncertainty.json"]


def test_probabilities_at_distances_far_from_the_histogram_are_written_into_it() -> None:
    axes = Figure().add_subplot()
    axes.hist([0.20, 0.21, 0.22])
    none, half = (probability_of(np.array(met)) for met in ([False, False], [True, False]))
    _draw_passes(axes, [Passing(2.0, none), Passing(0.21, half)])
    assert [text.get_text().strip() for text in axes.texts] == ["P = 0.5", "P = 0 at 2 m"]
    assert [line.get_xdata()[0] for line in axes.lines] == [0.21] and axes.get_xlim()[1] < 0.25
