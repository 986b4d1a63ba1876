"""Samples in which each run has a realization of its own of a random field."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from mpmcol.errors import CaseError
from mpmcol.report.uncertainty import uncertainty_sections
from mpmcol.studies.uncertainty.analysis import analyse
from mpmcol.studies.uncertainty.inputs import parse_inputs
from mpmcol.studies.uncertainty.plan import UncertaintyPlan, plan_study, study_name
from mpmcol.studies.uncertainty.record import as_record, summary_lines
from mpmcol.studies.uncertainty.report import write_report
from mpmcol.studies.uncertainty.sampling import draw_sample
from mpmcol.sweep.axes import Axis
from tests.support.json_keys import names_in, unexplained
from tests.support.uncertain import FRICTION, ended, inputs_of

SEED = "material.seed"
OPTION = f"{SEED}=realizations"


def planned(out: Path, *options: str, case: str = "random-friction", samples: int = 12) -> UncertaintyPlan:
    inputs, seeds, problems = parse_inputs([OPTION, *options])
    return plan_study(case, [], inputs, out, samples=samples, seed=0, seeds=seeds, problems=problems)


def runout(inputs: Mapping[str, Any]) -> dict[str, Any]:
    """A result that depends on the realization and, if it is uncertain, on the friction angle."""
    field = np.random.default_rng(inputs[SEED]).normal(0.0, 0.05)
    return {"zeta": {"front_height": 2.4 + field - 0.05 * (inputs.get(FRICTION, 33.0) - 33.0)}}


def test_each_run_has_a_seed_of_its_own(tmp_path: Path) -> None:
    plan = planned(tmp_path, samples=64)
    seeds = [run.case.material.seed for run in plan.runs]
    assert len(set(seeds)) == 64 and plan.seeds == [SEED]
    assert [run.case.material.seed for run in planned(tmp_path, samples=64).runs] == seeds
    assert len({run.case.time.cfl for run in plan.runs}) == 64  # and its scatter
    assert draw_sample([], 0.5, 64, 1, [SEED]).seeds[SEED] != plan.sample.seeds[SEED]


def test_the_hypercube_of_the_other_inputs_is_the_same() -> None:
    inputs = inputs_of(f"{FRICTION}=normal:33,1.5")
    with_field, without = draw_sample(inputs, 0.5, 16, 0, [SEED]), draw_sample(inputs, 0.5, 16, 0)
    assert (with_field.values, with_field.cfl) == (without.values, without.cfl)


def test_without_other_inputs_there_are_statistics_and_no_shares(tmp_path: Path) -> None:
    plan = planned(tmp_path)
    analysis = analyse(plan, ended(plan, runout), distances=[1.0])
    (zeta,) = analysis.quantities
    assert zeta.statistics.count == 12 and zeta.statistics.standard_deviation > 0.02 and zeta.shares is None
    text = "\n".join(summary_lines(analysis))
    assert "each run has a realization of its own of the random field" in text
    assert "the variance is that of the realizations and of the scatter of the runs" in text
    record = json.loads(json.dumps(as_record(analysis)))
    assert record["realizations"] == [SEED] and record["inputs"] == []
    assert unexplained("uncertainty.json", names_in(record)) == set()


def test_with_another_input_the_realizations_are_in_the_residual(tmp_path: Path) -> None:
    plan = planned(tmp_path, f"{FRICTION}=normal:33,1.5", samples=64)
    analysis = analyse(plan, ended(plan, runout))
    (zeta,) = analysis.quantities
    assert zeta.shares and list(zeta.shares.first_order) == [FRICTION] and zeta.shares.scatter is None
    expected = 0.05**2 / (0.05**2 + (0.05 * 1.5) ** 2)
    assert zeta.shares.residual == pytest.approx(expected, abs=0.12)
    assert "residual: realizations of the field, scatter" in "\n".join(summary_lines(analysis))


def test_the_report_names_the_realizations(tmp_path: Path) -> None:
    plan = planned(tmp_path)
    write_report(analyse(plan, ended(plan, runout)), tmp_path)
    sweep: Any = SimpleNamespace(runs=[SimpleNamespace(folder=run.folder.name) for run in plan.runs])
    (section,) = uncertainty_sections(tmp_path, sweep)
    assert f"{SEED}: each run has a realization of its own" in section.lines


def test_the_default_folder_names_the_seed() -> None:
    assert study_name("random-friction", [], [], seeds=[SEED]) == "random-friction-seed-uncertain"


@pytest.mark.parametrize(
    ("option", "message"),
    [
        (f"{SEED}=normal:3,1", "expected material.seed=realizations, with which each run has a seed of its own"),
        (f"{FRICTION}=realizations", "realizations are for the seed of a random field, material.seed"),
        ("material.sed=realizations", "realizations are for the seed of a random field, material.seed"),
    ],
)
def test_bad_options_are_refused(option: str, message: str) -> None:
    inputs, seeds, (problem,) = parse_inputs([option])
    assert not inputs and not seeds and message in str(problem)


def test_a_seed_is_given_once(tmp_path: Path) -> None:
    (problem,) = parse_inputs([OPTION, OPTION]).problems
    assert f"{SEED} is given twice" in str(problem)
    with pytest.raises(CaseError, match="material.seed is uncertain as well; remove one of them"):
        plan_study("random-friction", [Axis(SEED, ("3",))], [], tmp_path, samples=8, seed=0, seeds=[SEED])


def test_a_material_without_a_field_has_no_realizations(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match="the material has no random field, and no key material.seed"):
        planned(tmp_path, case="coarse-channel")
