"""Published laws at values computed by hand, their ranges, and scores."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from mpmcol.errors import UsageError
from mpmcol.experiments import (
    EXPERIMENTS,
    Conditions,
    Score,
    expected_runout,
    find_experiment,
    profile_score,
    profile_scores,
    score,
)


def value(name: str, quantity: str, a: float) -> float | None:
    law = EXPERIMENTS[name].law(quantity)
    assert law is not None
    return law(a)


@pytest.mark.parametrize(
    ("name", "quantity", "a", "expected"),
    [
        ("lube-2007", "zeta", 1.0, 1.6),
        ("lube-2007", "zeta", 3.0, 4.576),
        ("lube-2007", "zeta", 10.0, 10.211),
        ("lube-2007", "beta", 1.0, 1.0),
        ("lube-2007", "beta", 2.0, 0.660),
        ("lube-2007", "beta", 3.0, 0.517),
        ("lube-2007", "beta", 5.0, 0.381),
        ("lube-2007", "beta", 7.0, 0.311),
        ("lube-2007", "beta", 10.0, 0.251),
        ("lube-2004", "zeta", 0.55, 0.682),
        ("lube-2004", "zeta", 0.9, 1.116),
        ("lube-2004", "zeta", 2.75, 2.653),
        ("lube-2004", "zeta", 7.0, 4.233),
        ("lube-2004", "beta", 0.9, 1.0),
        ("lube-2004", "beta", 2.0, 0.494),
        ("lube-2004", "beta", 7.0, 0.174),
        ("lube-2005", "zeta", 1.0, 1.2),
        ("lube-2005", "zeta", 8.0, 7.6),
        ("lube-2005-single-break", "zeta", 2.5, 3.500),
        ("lajeunesse-2005", "zeta", 2.0, 3.6),
        ("lajeunesse-2005", "beta", 8.0, 0.25),
        ("lajeunesse-2004", "zeta", 4.0, 4.0),
        ("lajeunesse-2004", "beta", 4.0, 0.185),
        ("bougouin-lacaze-2018", "zeta", 1.0, 2.7),
        ("bougouin-lacaze-2018", "beta", 2.0, 0.510),
        ("lagree-2011", "zeta", 10.0, 19.546),
        ("lagree-2011", "beta", 2.0, 0.414),
        ("kumar-dem", "zeta", 1.0, 1.67),
        ("dunatunga-kamrin-2015", "zeta", 1.0, 2.28),
        ("bui-2008", "zeta", 0.5, 1.2115),
    ],
)
def test_laws_have_the_values_computed_by_hand(name: str, quantity: str, a: float, expected: float) -> None:
    assert value(name, quantity, a) == pytest.approx(expected, abs=6e-4)


def test_runout_distances_are_those_of_the_paper() -> None:
    """Section 3.2: 163 mm at a = 0.55 and 205 mm at a = 0.90, r_i = 97 mm."""
    for a, distance in ((0.55, 0.163), (0.90, 0.205)):
        zeta = value("lube-2004", "zeta", a)
        assert zeta is not None
        assert 0.097 * (1.0 + zeta) == pytest.approx(distance, abs=5e-4)


@pytest.mark.parametrize(
    ("name", "quantity", "a", "comment"),
    [
        ("lube-2007", "zeta", 1.8, "no law for 1.8 <= a < 2.8"),
        ("lube-2007", "zeta", 2.79, "no law for 1.8 <= a < 2.8"),
        ("lube-2007", "zeta", 0.3, "no law for a < 0.5"),
        ("lube-2007", "zeta", 20.0, "no law for a >= 20"),
        ("lube-2004", "beta", 1.0, "no law for 1 <= a < 1.7"),
        ("lube-2004", "beta", 10.0, "no law for a >= 10"),
        ("lajeunesse-2005", "beta", 0.8, "no law for 0.7 <= a < 1"),
        ("bui-2008", "zeta", 1.0, "no law for a >= 0.505"),
    ],
)
def test_a_law_has_no_value_outside_its_range_and_gives_the_reason(
    name: str, quantity: str, a: float, comment: str
) -> None:
    law = EXPERIMENTS[name].law(quantity)
    assert law is not None
    assert law(a) is None
    assert law.gap(a) == comment


def test_a_range_includes_its_lower_end_only() -> None:
    assert value("lube-2007", "zeta", math.nextafter(1.8, 0)) == pytest.approx(2.88)
    assert value("lube-2007", "zeta", 2.8) == pytest.approx(2.2 * 2.8 ** (2 / 3))
    assert value("lube-2004", "zeta", 1.7) == pytest.approx(2.086, abs=5e-4)


def test_every_record_is_complete() -> None:
    for name, experiment in EXPERIMENTS.items():
        assert name == experiment.name
        assert experiment.doi or "DOI" in experiment.note
        quantities = [law.quantity for law in experiment.laws]
        assert len(set(quantities)) == len(quantities)
        for law in experiment.laws:
            assert law.pieces or law.note
            assert 0.0 < law.scatter < 0.5 and law.scatter_source
            ends = [end for piece in law.pieces for end in (piece.lo, piece.hi)]
            assert ends == sorted(ends)


def test_no_height_law_exceeds_the_initial_height() -> None:
    for experiment in EXPERIMENTS.values():
        law = experiment.law("beta")
        heights = [law(a) or 0.0 for a in np.geomspace(0.1, 30.0, 400)] if law else [0.0]
        assert max(heights) <= 1.005


def area(x: tuple[float, ...], y: tuple[float, ...]) -> float:
    return float(np.trapezoid(y, x))


def test_digitised_profiles_conserve_mass() -> None:
    shape = EXPERIMENTS["lube-2005"].profiles[0]
    assert area(shape.x, shape.y) == pytest.approx(0.372, abs=0.002)
    surface = EXPERIMENTS["bui-2008"].profiles[0]
    assert area(surface.x, surface.y) == pytest.approx(0.0203, abs=5e-5)
    assert surface.x[-1] == pytest.approx(0.442, abs=5e-4)


@pytest.mark.parametrize(("a", "factor"), [(2.0, 0.190), (3.0, 0.200), (5.0, 0.207), (7.0, 0.210)])
def test_the_volume_factor_of_the_axisymmetric_laws(a: float, factor: float) -> None:
    zeta, beta = (value("lube-2004", quantity, a) for quantity in ("zeta", "beta"))
    assert zeta is not None and beta is not None
    assert 1.0 / ((1.0 + zeta) ** 2 * beta) == pytest.approx(factor, abs=6e-4)


def measured(zeta: float, beta: float) -> dict[str, object]:
    return {"zeta": {"front_max": 1.02 * zeta, "front_height": zeta}, "beta": beta}


def find(scores: list[Score], experiment: str, quantity: str, front: str = "") -> Score:
    keys = (experiment, quantity, front)
    return next(s for s in scores if (s.experiment, s.quantity, s.front_definition) == keys)


def test_scores_are_relative_errors_of_each_front_definition() -> None:
    scores = score(measured(1.52, 0.98), 1.0, "plane")
    assert find(scores, "lube-2007", "zeta", "front_height").error == pytest.approx(-0.05)
    assert find(scores, "lube-2007", "zeta", "front_max").error == pytest.approx(1.5504 / 1.6 - 1.0)
    assert find(scores, "lube-2007", "beta").error == pytest.approx(-0.02)
    assert find(scores, "lube-2005", "zeta", "front_height").error == pytest.approx(1.52 / 1.2 - 1.0)


def test_an_error_beyond_the_scatter_is_marked() -> None:
    near, far = (score(measured(zeta, 1.0), 1.0, "plane") for zeta in (1.6 * 1.09, 1.6 * 1.11))
    assert find(near, "lube-2007", "zeta", "front_height").within_scatter is True
    assert find(far, "lube-2007", "zeta", "front_height").within_scatter is False
    assert find(score(measured(1.6, 0.94), 1.0, "plane"), "lube-2007", "beta").within_scatter is False


def test_without_a_law_there_is_neither_an_error_nor_a_comparison_with_the_scatter() -> None:
    result = find(score(measured(3.0, 0.6), 2.0, "plane"), "lube-2007", "zeta", "front_max")
    assert (result.expected, result.error, result.within_scatter) == (None, None, None)
    assert result.comment == "no law for 1.8 <= a < 2.8"


def test_scores_are_for_the_kind_of_column_and_each_law_is_scored_once() -> None:
    for model in ("plane", "axisymmetric"):
        scores = score({"zeta": 1.0, "beta": 1.0, "stop_time": 3.0}, 1.2, model)
        assert {EXPERIMENTS[s.experiment].model for s in scores} == {model}
        keys = [(s.experiment, s.quantity) for s in scores]
        assert len(set(keys)) == len(keys)


def test_the_stop_time_is_scored_if_it_is_given() -> None:
    scores = score({"stop_time": 3.5}, 3.0, "plane")
    assert find(scores, "lube-2007", "stop_time").error == pytest.approx(3.5 / 3.3 - 1.0)
    assert {s.quantity for s in scores} == {"stop_time"}


def test_the_distance_of_the_digitised_surface_to_itself_is_zero_and_to_a_raised_one_its_offset() -> None:
    bui = EXPERIMENTS["bui-2008"]
    surface = bui.profiles[0]
    x, y = np.append(surface.x, 0.45), np.append(surface.y, 0.0)
    same, raised = profile_score(x, y, bui), profile_score(x, y + 0.004, bui)
    assert same is not None and raised is not None
    assert same.rms_mm == pytest.approx(0.0, abs=0.02)
    assert same.front == pytest.approx(0.4423)
    assert same.error == pytest.approx(0.0, abs=1e-9)
    assert raised.rms_mm == pytest.approx(4.0, rel=1e-6)


def test_a_short_deposit_has_zero_height_beyond_its_end() -> None:
    result = profile_score([0.0, 0.2, 0.2001], [0.1, 0.1, 0.0], EXPERIMENTS["bui-2008"])
    assert result is not None and result.error is not None
    assert result.front == pytest.approx(0.2001, abs=1e-4)
    assert result.error == pytest.approx(0.2001 / 0.4423 - 1.0, abs=1e-3)
    assert result.rms_mm > 20.0


def test_a_dimensionless_shape_is_scaled_to_the_deposit() -> None:
    lube = EXPERIMENTS["lube-2005"]
    shape = lube.profiles[0]
    exact = profile_score(0.3 * np.array(shape.x), 0.08 * np.array(shape.y), lube)
    triangle = profile_score([0.0, 0.3], [0.08, 0.0], lube)
    assert exact is not None and triangle is not None
    assert exact.rms_mm == pytest.approx(0.0, abs=1e-9)
    assert 5.0 < triangle.rms_mm < 20.0
    assert exact.expected_front is None


def test_an_empty_deposit_and_an_experiment_without_a_surface() -> None:
    for name in ("bui-2008", "lube-2005"):
        result = profile_score([0.001], [0.0], EXPERIMENTS[name])
        assert result is not None
        assert math.isfinite(result.rms_mm)
    assert profile_score([0.0], [1.0], EXPERIMENTS["lajeunesse-2005"]) is None


def test_profiles_in_metres_are_compared_for_one_size_of_column() -> None:
    assert EXPERIMENTS["bui-2008"].fits(0.2, 0.1)
    assert not EXPERIMENTS["bui-2008"].fits(0.2, 0.12)
    assert EXPERIMENTS["lube-2005"].fits(0.09, 0.27)


def test_paper_depends_on_the_model_and_unknown_names_are_reported() -> None:
    assert find_experiment("paper", "plane").name == "lube-2007"
    assert find_experiment("paper", "axisymmetric").name == "lube-2004"
    with pytest.raises(UsageError, match="did you mean 'lube-2005'"):
        find_experiment("lube-205", "plane")
    with pytest.raises(UsageError, match="'axisymmetric'; this column is 'plane'"):
        find_experiment("lube-2004", "plane")


@pytest.mark.parametrize("model", ["quarter", "full"])
def test_a_cylinder_in_3d_has_the_experiments_of_the_axisymmetric_one(model: str) -> None:
    values = measured(1.116, 1.0)
    assert score(values, 0.9, model) == score(values, 0.9, "axisymmetric") != []
    assert find_experiment("paper", model).name == "lube-2004"
    assert find_experiment("lube-2004", model) is EXPERIMENTS["lube-2004"]
    with pytest.raises(UsageError, match="'plane'; this column is 'axisymmetric'"):
        find_experiment("lube-2005", model)
    assert expected_runout(model, 0.9) == expected_runout("axisymmetric", 0.9)
    x, y = [0.0, 0.3], [0.08, 0.0]
    assert profile_scores(x, y, model, 0.09, 0.09) == profile_scores(x, y, "axisymmetric", 0.09, 0.09)


@pytest.mark.parametrize("model", ["quarter", "full"])
def test_no_experiment_on_a_box_is_published(model: str) -> None:
    assert score(measured(1.0, 1.0), 1.0, model, "box") == []
    assert profile_scores([0.0, 0.3], [0.08, 0.0], model, 0.09, 0.09, "box") == []
    assert find_experiment("paper", model, "box").laws == ()
    with pytest.raises(UsageError, match="'axisymmetric'; this column is 'box'"):
        find_experiment("lube-2004", model, "box")
    assert expected_runout(model, 0.9, "box") == expected_runout("plane", 0.9)


def test_the_mean_over_azimuth_is_scored() -> None:
    over_azimuth = {"zeta": {"front_height": {"mean": 1.1, "min": 1.0, "max": 1.3}}, "beta": 1.0}
    assert score(over_azimuth, 0.9, "quarter") == score({"zeta": {"front_height": 1.1}, "beta": 1.0}, 0.9, "quarter")


@pytest.mark.parametrize("model", ["plane", "axisymmetric"])
def test_the_expected_runout_is_an_upper_bound_and_increases_with_a(model: str) -> None:
    ratios = np.geomspace(0.1, 20.0, 500)
    runout = np.array([expected_runout(model, a) for a in ratios])
    assert np.isfinite(runout).all() and (np.diff(runout) > 0.0).all()
    for experiment in EXPERIMENTS.values():
        law = experiment.law("zeta")
        if experiment.model == model and experiment.kind == "laboratory" and law is not None:
            assert all(bound >= (law(a) or 0.0) for a, bound in zip(ratios, runout, strict=True))
    assert expected_runout(model, 1e-3) > 0.0 and math.isfinite(expected_runout(model, 1e3))


@pytest.mark.parametrize(
    ("name", "quantity", "verified"),
    [
        ("lube-2007", "zeta", True),
        ("lube-2007", "beta", False),
        ("lube-2007", "stop_time", False),
        ("lube-2004", "zeta", True),
        ("lube-2004", "beta", True),
        ("lube-2004", "stop_time", False),
        ("bougouin-lacaze-2018", "zeta", False),
    ],
)
def test_unverified_laws_are_marked_in_labels_and_scores(name: str, quantity: str, verified: bool) -> None:
    experiment = EXPERIMENTS[name]
    law = experiment.law(quantity)
    assert law is not None and law.verified is verified
    assert experiment.label(quantity) == experiment.citation + ("" if verified else " (unverified)")
    result = find(score({quantity: 1.0}, 0.9, experiment.model), name, quantity)
    assert result.verified is verified
    assert result.comment.endswith("(unverified)") is not verified
    assert result.as_dict()["verified"] is verified


def test_an_unverified_profile_is_marked_in_its_score() -> None:
    bui = EXPERIMENTS["bui-2008"]
    unverified = replace(bui, profiles=tuple(replace(profile, verified=False) for profile in bui.profiles))
    for experiment, verified in ((bui, True), (unverified, False)):
        result = profile_score([0.0, 0.3], [0.08, 0.0], experiment)
        assert result is not None and result.verified is verified
        assert result.comment.endswith("(unverified)") is not verified


@pytest.mark.parametrize(
    ("friction", "cohesion", "reason"),
    [
        (33.0, 0.0, ""),
        (28.0, 0.009, ""),
        (27.0, 0.0, "for friction of 28 to 40 deg; here it is 27 deg"),
        (33.0, 0.02, "for grains without cohesion; here it is 0.02 rho g h_i"),
        (None, 0.0, "for friction of 28 to 40 deg; this material has none"),
    ],
)
def test_laws_apply_to_similar_materials(friction: float | None, cohesion: float, reason: str) -> None:
    conditions = Conditions(friction, cohesion)
    assert EXPERIMENTS["lube-2007"].misfit(conditions) == reason
    scores = [one for one in score({"zeta": 1.5}, 1.0, "plane", conditions=conditions) if one.experiment == "lube-2007"]
    assert [(one.error is None, one.comment) for one in scores] == [(bool(reason), reason or "sand")]
