"""Cost against error: limits of refinements, what is chosen, studies as files, and a small study from end to end."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

from mpmcol.case import load_case
from mpmcol.cli import main
from mpmcol.errors import CaseError, UsageError
from mpmcol.measure.profile_distance import area_between
from mpmcol.studies.convergence import Limit, combine, find_limit
from mpmcol.studies.pareto.configurations import Setting, overrides_of, settings_of
from mpmcol.studies.pareto.score import BETA, PROFILE, ZETA, Error, Scored
from mpmcol.studies.pareto.selection import cheapest, effects, kept_errors, pareto_front
from mpmcol.studies.pareto.study import Family, load_study, shipped_studies
from mpmcol.studies.runs import with_settings

STUDY = """
schema = 1
title = "tiny"
repeats = 2
cells = [5, 6, 7]
base = "plain"
reference = ["plain", "nine"]

[scenes.low]
case = "lube-cylinder"
aspect = 0.9
set = { "stages.collapse.max_time_factor" = 2.0, "stages.collapse.end" = "time" }

[families.plain]

[families.nine]
set = { "grid.points_per_cell" = 9 }

[families.fast]
set = { "time.cfl" = 1.9 }
cells = [6]
"""


def test_the_limit_of_a_power_law_is_found_with_its_order() -> None:
    rng = np.random.default_rng(1)
    for order in (0.7, 1.0, 1.8):
        runs = {h: 1.2 - 0.4 * h**order + 1e-4 * rng.standard_normal(4) for h in (1.0, 0.7, 0.5, 0.35)}
        limit = find_limit({h: values.tolist() for h, values in runs.items()})
        assert limit is not None and abs(limit.order - order) < 0.1
        assert abs(limit.value - 1.2) < 3.0 * limit.error + 1e-3 and limit.error < 0.02


def test_the_stated_error_covers_the_scatter_and_a_misfit() -> None:
    """Of noisy refinements, the truth lies within two standard errors as often as it should."""
    rng = np.random.default_rng(2)
    inside = 0
    for _ in range(200):
        limit = find_limit({h: (1.0 - 0.3 * h + 0.02 * rng.standard_normal(4)).tolist() for h in (1.0, 0.7, 0.5, 0.35)})
        assert limit is not None
        inside += abs(limit.value - 1.0) < 2.0 * limit.error
    assert inside > 180
    bent = find_limit({h: [v, v + 1e-4] for h, v in ((1.0, 0.8), (0.7, 1.0), (0.5, 0.9), (0.35, 1.0))})
    assert bent is not None and bent.error > 0.05  # on no power law


def test_a_limit_needs_spacings_and_repetitions() -> None:
    assert find_limit({1.0: [1.0, 1.1], 0.5: [1.0, 1.2]}) is None
    assert find_limit({1.0: [1.0], 0.5: [1.1], 0.4: [1.2]}) is None
    near = find_limit({10.0: [5.0, 5.1], 1.0: [1.0, 1.01], 0.7: [1.0, 1.01], 0.5: [1.0, 1.01]})
    assert near is not None and abs(near.value - 1.005) < 0.02  # the coarsest is too far to count


def test_two_limits_that_disagree_are_no_surer_than_half_their_difference() -> None:
    both = combine(Limit(1.0, 0.01, 1.0), Limit(1.2, 0.01, 1.0))
    assert both.value == pytest.approx(1.1) and both.error == pytest.approx(0.1)
    agreeing = combine(Limit(1.0, 0.01, 1.0), Limit(1.0, 0.03, 1.0))
    assert agreeing.error == pytest.approx(0.01 * np.sqrt(0.9))


def scored(
    family: str, cells: float, cost: float, bias: float, failed: str = "", scene: str = "low", left: int = 0
) -> Scored:
    """A setting of no runs, with one that failed, or with some that are left to be made."""
    error = Error(bias, 0.0, 2)
    members = (with_settings("quickstart", 1.0, 0.01),) * (left + bool(failed))
    made = Scored(
        Setting(scene, family, cells, members), [], dict.fromkeys((ZETA, BETA, PROFILE), error), [failed] * bool(failed)
    )
    made.__dict__["cost"] = {"core_seconds": cost, "point_steps": cost}
    return made


def test_an_error_that_grows_again_was_luck() -> None:
    lucky = [scored("a", 10, 1.0, 0.001), scored("a", 20, 2.0, 0.05), scored("a", 40, 4.0, 0.02)]
    assert [kept.error for kept in kept_errors(lucky, ZETA)] == [0.02, 0.05, 0.05]
    found = cheapest(lucky, ZETA, 0.03)
    assert found is not None and found.setting.cells == 40
    assert cheapest(lucky, ZETA, 0.01) is None


def test_the_front_leaves_out_what_is_beaten_or_failed_or_unfinished_or_alone() -> None:
    all_ = [scored("a", n, n, 1.0 / n) for n in (10, 20, 40)]
    all_ += [scored("b", n, 2.0 * n, 1.0 / n) for n in (10, 20, 40)]
    all_ += [scored("c", n, 0.1 * n, 0.5 / n, failed="diverged") for n in (10, 20, 40)]
    all_ += [scored("d", n, 0.1 * n, 0.5 / n, left=1) for n in (10, 20, 40)]
    all_ += [scored("alone", 10, 0.1, 0.001)]
    assert [(kept.one.setting.family, kept.one.setting.cells) for kept in pareto_front(all_, ZETA)] == [
        ("a", 10), ("a", 20), ("a", 40)
    ]  # fmt: skip


def test_effects_are_ratios_to_the_base(tmp_path: Path) -> None:
    study = load_study(str(write(tmp_path)))
    (effect,) = effects(
        study, [scored("plain", 4, 2.0, -0.2), scored("nine", 4, 5.0, -0.1), scored("nine", 5, 9.0, 0.0)]
    )
    assert effect.cost_ratio == 2.5 and effect.change[ZETA][0] == pytest.approx(0.9 / 0.8 - 1.0)


def test_areas_between_profiles() -> None:
    assert area_between(np.array([1.0, 3.0]), np.array([2.0, 2.0])) == 0.5


def write(folder: Path, old: str = "", new: str = "") -> Path:
    path = folder / "tiny.toml"
    path.write_text(STUDY.replace(old, new) if old else STUDY)
    return path


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("repeats = 2", "repeats = 0", "repeats: Input should be greater than or equal to 1"),
        ('base = "plain"', 'base = "none"', "no family is called 'none'"),
        ('["plain", "nine"]', '["plain", "plain"]', "reference takes two different families"),
        ("[families.plain]", "[families.plain]\nscenes = ['high']", "families.plain: no scene is called 'high'"),
        ("title =", "titel =", "titel: Extra inputs are not permitted"),
        ("schema = 1", "schema = ", "tiny.toml:2: not valid TOML: Invalid value"),
        ("cells = [5, 6, 7]", "cells = [5, 1e9]", "cells.1: Input should be less than or equal to 1000"),
    ],
)
def test_a_study_that_is_wrong_is_told_with_its_key(old: str, new: str, told: str, tmp_path: Path) -> None:
    path = write(tmp_path, old, new)
    with pytest.raises((CaseError, UsageError)) as error:
        load_study(str(path))
    assert told in str(error.value) and str(path) in str(error.value)


def test_an_unknown_study_is_told_with_the_nearest() -> None:
    with pytest.raises(UsageError, match="defualt: no such study; did you mean 'default'"):
        load_study("defualt")


def test_shipped_studies_hold_cases_that_are_right() -> None:
    assert set(shipped_studies()) == {"choices", "default", "quick"}
    for name in shipped_studies():
        members = {setting.members[0] for setting in settings_of(load_study(name))}
        points = [member.plan(Path("x")) for member in members]
        assert len({point.folder for point in points}) == len(points) > 10


def test_a_scene_may_leave_out_the_finest_spacings(tmp_path: Path) -> None:
    study = load_study(str(write(tmp_path, "aspect = 0.9", "aspect = 0.9\nfinest = 6")))
    assert [setting.cells for setting in settings_of(study) if setting.family == "plain"] == [5, 6]


def test_softness_becomes_a_modulus_that_is_never_raised() -> None:
    case = load_case("lube-cylinder")
    soft = overrides_of(case, Family(softness=2e-3))["material.youngs_modulus"]
    assert soft == pytest.approx(2650.0 * 9.81 * 0.9 * 0.097 / 2e-3)
    assert overrides_of(case, Family(softness=1e-6))["material.youngs_modulus"] == case.material.youngs_modulus


def test_a_small_study_from_end_to_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    path = write(tmp_path)

    def invoke(*words: str) -> Any:
        return CliRunner().invoke(main, ["pareto", str(path), *words])

    done = invoke("--jobs", "2")
    assert done.exit_code == 0, done.output  # though the step beyond the limit diverges, as it must
    out = tmp_path / "pareto" / "tiny"
    rows = list(csv.DictReader((out / "pareto.csv").read_text().splitlines()))
    assert [(row["family"], row["cells"]) for row in rows[:3]] == [("plain", "5.0"), ("plain", "6.0"), ("plain", "7.0")]
    assert all(float(row["core_seconds"]) > 0.0 and row["zeta.front_height usual"] for row in rows[:6])
    assert rows[6]["runs"] == "0" and rows[6]["failed"] == "2" and "lower time.cfl" in rows[6]["message"]
    text = (out / "pareto.md").read_text()
    assert "| low | fast, r_i/h = 6 | 2 of 2 | " in text and "![pareto-low](pareto-low.png)" in text
    assert json.loads((out / "environment.json").read_text())["numba"]
    assert (out / "pareto-low.png").stat().st_size > 20_000
    before = {file: file.stat().st_mtime_ns for file in (out / "runs").rglob("*") if file.is_file()}
    again = invoke("--report-only", "--quiet")
    assert (again.exit_code, again.output) == (0, "")
    assert {file: file.stat().st_mtime_ns for file in (out / "runs").rglob("*") if file.is_file()} == before
    assert (out / "pareto.md").read_text() == text
    write(tmp_path, "cells = [5, 6, 7]", "cells = [3, 4, 5]")
    wrong = invoke()
    assert wrong.exit_code == 2 and "low, plain, r_i/h = 3:" in wrong.output and "at least one cell" in wrong.output
