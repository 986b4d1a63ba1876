"""Cost against error: selection of configurations, definitions of studies, and a small study from end to end."""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from mpmcol.case import load_case
from mpmcol.errors import CaseError, UsageError
from mpmcol.measure.profile_distance import area_between
from mpmcol.plotting.figures import MOST_ENTRIES
from mpmcol.studies.convergence import ConvergedValue
from mpmcol.studies.pareto.chart import _named_variants
from mpmcol.studies.pareto.reference import PROFILE, QUANTITIES
from mpmcol.studies.pareto.report import limits_table
from mpmcol.studies.pareto.score import BETA, ZETA, RelativeError, ScoredConfiguration
from mpmcol.studies.pareto.selection import cheapest, effects, error_bounds, pareto_front
from mpmcol.studies.pareto.study import (
    Configuration,
    Variant,
    configurations_of,
    load_study,
    shipped_studies,
    variant_values,
)
from mpmcol.studies.runs import CompletedRun, study_run
from tests.support.cli import invoke

STUDY = """
schema = 1
title = "tiny"
repeats = 2
cells = [6, 7, 8]
baseline = "plain"
reference = ["plain", "nine"]

[cases.low]
extends = "lube-cylinder"
aspect = 0.9
set = { "stages.collapse.max_time_factor" = 2.0, "stages.collapse.end" = "time" }

[variants.plain]

[variants.nine]
set = { "grid.points_per_cell" = 9 }

[variants.fast]
set = { "time.cfl" = 1.9 }
cells = [6]
"""


def scored(
    variant: str, cells: float, cost: float, bias: float, failed: str = "", missing: int = 0
) -> ScoredConfiguration:
    """A configuration without runs, with one failed run, or with some missing ones."""
    error = RelativeError(bias, 0.0, 2)
    runs = (study_run("coarse-channel", 1.0, 0.01),) * (missing + bool(failed))
    errors = dict.fromkeys((ZETA, BETA, PROFILE), error)
    one = ScoredConfiguration(Configuration("low", variant, cells, runs), [], errors, [failed] * bool(failed))
    one.__dict__["cost"] = {"core_seconds": cost, "point_steps": cost}
    return one


def test_an_error_bound_includes_finer_spacings() -> None:
    coincidence = [scored("a", 10, 1.0, 0.001), scored("a", 20, 2.0, 0.05), scored("a", 40, 4.0, 0.02)]
    assert [bound.error for bound in error_bounds(coincidence, ZETA)] == [0.02, 0.05, 0.05]
    found = cheapest(coincidence, ZETA, 0.03)
    assert found is not None and found.configuration.cells == 40
    assert cheapest(coincidence, ZETA, 0.01) is None


def test_the_front_has_no_dominated_failed_unfinished_or_single_configurations() -> None:
    all_ = [scored("a", n, n, 1.0 / n) for n in (10, 20, 40)]
    all_ += [scored("dominated", n, 2.0 * n, 1.0 / n) for n in (10, 20, 40)]
    all_ += [scored("failed", n, 0.1 * n, 0.5 / n, failed="diverged") for n in (10, 20, 40)]
    all_ += [scored("unfinished", n, 0.1 * n, 0.5 / n, missing=1) for n in (10, 20, 40)]
    all_ += [scored("single", 10, 0.1, 0.001)]
    front = [bound.scored.configuration for bound in pareto_front(all_, ZETA)]
    assert [(one.variant, one.cells) for one in front] == [("a", 10), ("a", 20), ("a", 40)]


def test_effects_are_mean_ratios_of_runs_at_equal_spacings(tmp_path: Path) -> None:
    study = load_study(str(write(tmp_path)))
    plain = completed_at({0.25: 1.0, 0.3: 2.0}, scored("plain", 4, 2.0, 0.0))
    nine = completed_at({0.25: 1.1, 0.3: 2.6, 0.4: 9.0}, scored("nine", 4, 5.0, 0.0))
    (effect,) = effects(study, [plain, nine, scored("nine", 5, 9.0, 0.0)])
    assert effect.cost_ratio == 2.5 and effect.change[ZETA] == pytest.approx((0.2, 0.1))
    elsewhere = completed_at({0.26: 1.1, 0.31: 2.6}, scored("nine", 4, 5.0, 0.0))
    assert not list(effects(study, [plain, elsewhere]))  # different runs of both failed


def test_the_limit_of_another_variant_is_compared_with_the_reference(tmp_path: Path) -> None:
    """Runs on a line that ends 4 % above a value known to 3 %; variants of the reference are left out."""
    study = load_study(str(write(tmp_path)))
    on_line = {h: 2.08 - 3.0 * h for h in (0.1, 0.11, 0.14, 0.15, 0.2, 0.21)}
    fast, plain = (completed_at(on_line, scored(variant, 10, 1.0, 0.0)) for variant in ("fast", "plain"))
    values = {ZETA: ConvergedValue(2.0, 0.06, 1.0), BETA: ConvergedValue(2.08, 0.06, 1.0)}
    reference: Any = SimpleNamespace(values=values)
    *_, line = limits_table(study, {"low": reference}, [plain, fast])
    assert re.fullmatch(r"\| low \| fast \| 10 \| 2\.08 .* \| \+4\.0% \(\+1\.3\) \| 2\.08 .* \| [+-]0\.0% .*", line)
    assert len(list(limits_table(study, {"low": reference}, [plain]))) == 2
    values[BETA] = ConvergedValue(1.0, 0.0, 1.0)
    constant = completed_at(dict.fromkeys(on_line, 1.0), scored("fast", 10, 1.0, 0.0))
    assert list(limits_table(study, {"low": reference}, [constant]))[-1].endswith("| 1 +- 0 | +0.0% |")


def completed_at(values: Mapping[float, float], one: ScoredConfiguration) -> ScoredConfiguration:
    """The configuration with completed runs: spacing -> zeta and beta."""
    rows = ({"spacing_used": h, **dict.fromkeys(QUANTITIES, value)} for h, value in values.items())
    runs = [CompletedRun(row, Path("nowhere")) for row in rows]
    with_runs = replace(one, runs=runs)
    with_runs.__dict__["cost"] = one.cost
    return with_runs


def test_areas_between_profiles() -> None:
    assert area_between(np.array([1.0, 3.0]), np.array([2.0, 2.0])) == 0.5


def write(folder: Path, old: str = "", new: str = "") -> Path:
    path = folder / "tiny.toml"
    path.write_text(STUDY.replace(old, new) if old else STUDY)
    return path


OTHER_CASE = "[cases.high]\nextends = 'cylinder'\naspect = 1\n[variants.plain]\ncases = ['low']"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("repeats = 2", "repeats = 0", "repeats: Input should be greater than or equal to 1"),
        ('baseline = "plain"', 'baseline = "none"', "there is no variant 'none'"),
        ('["plain", "nine"]', '["plain", "plain"]', "reference needs two different variants"),
        ("[variants.plain]", "[variants.plain]\ncases = ['high']", "variants.plain: there is no case 'high'"),
        ("[variants.plain]", OTHER_CASE, "reference: the case 'high' is not computed with plain"),
        ("title =", "titel =", "titel: Extra inputs are not permitted"),
        ("schema = 1", "schema = ", "tiny.toml:2: not valid TOML: Invalid value"),
        ("aspect = 0.9", "aspect = 0.9\nvariants = ['none']", "cases.low: there is no variant 'none'"),
        ("repeats = 2\ncells = [6,", "repeats = 5\ncells = [5,", "cells must be at least 6, not 5"),
        ("cells = [6, 7, 8]", "cells = []", "cells: Tuple should have at least 1 item"),
        ("cells = [6, 7, 8]", "cells = [6, 1e9]", "cells.1: Input should be less than or equal to 1000"),
    ],
)
def test_an_invalid_study_is_refused_with_its_key(old: str, new: str, message: str, tmp_path: Path) -> None:
    path = write(tmp_path, old, new)
    with pytest.raises((CaseError, UsageError)) as error:
        load_study(str(path))
    assert message in str(error.value) and str(path) in str(error.value)


def test_an_unknown_study_is_refused_with_a_suggestion() -> None:
    with pytest.raises(UsageError, match="defualt: no such study; did you mean 'default'"):
        load_study("defualt")


def test_shipped_studies_have_valid_cases() -> None:
    assert set(shipped_studies()) == {"choices", "default", "quick"}
    for name in shipped_studies():
        runs = {configuration.runs[0] for configuration in configurations_of(load_study(name))}
        assert len({run.plan(Path("x")).folder for run in runs}) == len(runs) > 10


def test_a_case_may_leave_out_the_finest_spacings(tmp_path: Path) -> None:
    study = load_study(str(write(tmp_path, "aspect = 0.9", "aspect = 0.9\nfinest = 7")))
    assert [one.cells for one in configurations_of(study) if one.variant == "plain"] == [6, 7]


def test_a_case_may_list_its_variants(tmp_path: Path) -> None:
    study = load_study(str(write(tmp_path, "aspect = 0.9", "aspect = 0.9\nvariants = ['plain', 'nine']")))
    assert {one.variant for one in configurations_of(study)} == {"plain", "nine"}


def test_the_runs_of_a_configuration_differ_by_a_cell(tmp_path: Path) -> None:
    study = load_study(str(write(tmp_path)))
    for one in configurations_of(study):
        r_i = load_case("lube-cylinder").geometry.r_i
        assert [r_i / run.h for run in one.runs] == pytest.approx([one.cells, one.cells - 1.0])


def test_softness_gives_a_modulus_that_is_never_raised() -> None:
    case = load_case("lube-cylinder")
    soft = variant_values(case, Variant(softness=2e-3))["material.youngs_modulus"]
    assert soft == pytest.approx(2650.0 * 9.81 * 0.9 * 0.097 / 2e-3)
    assert variant_values(case, Variant(softness=1e-6))["material.youngs_modulus"] == case.material.youngs_modulus


@pytest.mark.slow
def test_a_small_study_from_end_to_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    path = write(tmp_path)

    done = invoke("pareto", path, "--jobs", "2")
    assert done.exit_code == 0, (
        done.output
    )  # although the runs with a time step beyond the stability limit diverge, as expected
    out = tmp_path / "pareto" / "tiny"
    rows = list(csv.DictReader((out / "pareto.csv").read_text().splitlines()))
    assert [(row["variant"], row["cells"]) for row in rows[:3]] == [
        ("plain", "6.0"),
        ("plain", "7.0"),
        ("plain", "8.0"),
    ]
    assert all(float(row["core_seconds"]) > 0.0 and row["zeta.front_height p90"] for row in rows[:6])
    assert rows[6]["runs"] == "0" and rows[6]["failed"] == "2" and "lower time.cfl" in rows[6]["message"]
    text = (out / "pareto.md").read_text()
    assert "| low | fast, r_i/h = 6 | 2 of 2 | " in text and "![pareto-low](pareto-low.png)" in text
    assert json.loads((out / "environment.json").read_text())["numba"]
    assert (out / "pareto-low.png").stat().st_size > 20_000
    before = {file: file.stat().st_mtime_ns for file in (out / "runs").rglob("*") if file.is_file()}
    again = invoke("pareto", path, "--report-only", "--quiet")
    assert (again.exit_code, again.output) == (0, "")
    assert len(json.loads(invoke("pareto", path, "--report-only", "--json").stdout)["rows"]) == len(rows)
    assert {file: file.stat().st_mtime_ns for file in (out / "runs").rglob("*") if file.is_file()} == before
    assert (out / "pareto.md").read_text() == text
    write(tmp_path, "cells = [6, 7, 8]", "cells = [3, 4, 5]")
    wrong = invoke("pareto", path)
    assert wrong.exit_code == 2 and "low, plain, r_i/h = 3:" in wrong.output and "at least one cell" in wrong.output


def test_a_chart_names_the_baseline_and_the_best_variants_and_groups_the_others() -> None:
    all_ = [scored(f"choice {n}", 20, 5.0 + n, 0.1) for n in range(30)]
    all_ += [scored("baseline", n, 10.0 * n, 10.0 / n) for n in (10, 20, 40)]
    all_ += [scored("best", n, n, 1.0 / n) for n in (10, 20, 40)]
    named = _named_variants(all_, "baseline", MOST_ENTRIES - 2)
    assert len(named) == MOST_ENTRIES - 2 and {"baseline", "best"} <= set(named)
    assert _named_variants(all_[-6:], "baseline", MOST_ENTRIES - 2) == ["baseline", "best"]
