"""Advice of `run --accuracy` and `plan`: what it proposes causes no warning that the case does not have."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest

from mpmcol.case import load_case, shipped_cases
from mpmcol.errors import UsageError
from mpmcol.setup.discretization import discretize
from mpmcol.setup.time_step import case_limit
from mpmcol.setup.unfit_settings import kind_of
from mpmcol.studies.definition import Value, as_overrides
from mpmcol.studies.pareto.proposed import completed
from mpmcol.studies.pareto.recommend import options, recommend
from mpmcol.studies.pareto.savings import propose
from mpmcol.studies.pareto.shipped import unstudied
from tests.support.cli import invoke

COLUMNS = ([], ["geometry.aspect=0.5"], ["geometry.aspect=8", "time.cfl=0.6"])


def has_study(name: str) -> bool:
    case = load_case(name)
    return case.geometry.is_rectangle and not unstudied(case)


STUDIED = list(filter(has_study, shipped_cases()))


@pytest.mark.parametrize(
    "override",
    ["geometry.base=granular", "friction.floor=0.3", "layers=[{to=0.03, material={friction_deg=20}}]"],
)
def test_an_accuracy_is_refused_for_what_was_not_studied(override: str) -> None:
    overrides = (override, "geometry.base=rigid") if override.startswith("friction") else (override,)
    with pytest.raises(UsageError, match=f"^.*{override.partition('=')[0]}.*the errors were studied .* only; set grid"):
        recommend("cylinder", ("method.wall_impulse=true", *overrides), 0.1)


def test_an_accuracy_is_refused_on_a_slope() -> None:
    refused = invoke("run", "inclined-channel", "--accuracy", "5%", "--dry-run")
    assert refused.exit_code == 2 and "geometry.slope_deg = 10: the errors were studied on a" in refused.output


def new_warnings(source: str, overrides: Sequence[str], values: dict[str, Value]) -> list[str]:
    """Warnings of a case with proposed values, of kinds that it has not without them."""
    before, after = (discretize(load_case(source, [*overrides, *more])).warnings for more in ([], as_overrides(values)))
    return [text for text in after if kind_of(text) not in {kind_of(known) for known in before}]


@pytest.mark.parametrize("name", STUDIED)
def test_no_configuration_that_an_accuracy_may_choose_causes_a_warning(name: str) -> None:
    overrides = COLUMNS[STUDIED.index(name) % len(COLUMNS)]
    for option in options(name, overrides):
        assert new_warnings(name, overrides, dict(option.values)) == [], str(option)


@pytest.mark.parametrize("accuracy", [0.1, 0.3])
@pytest.mark.parametrize(
    ("name", "overrides"), [*zip(("lube-channel", "lube-quarter", "cylinder"), COLUMNS, strict=True)]
)
def test_no_single_change_of_a_plan_causes_a_warning(name: str, overrides: list[str], accuracy: float) -> None:
    for proposal in propose(name, overrides, accuracy):
        assert new_warnings(name, overrides, dict(proposal.values)) == [], proposal.name


def test_the_case_of_a_plan_passes_the_check_without_a_note(tmp_path: Path) -> None:
    planned = invoke("plan", "lube-channel", "--accuracy", "40%", "--apply", tmp_path / "new.toml")
    assert planned.exit_code == 0, planned.output
    checked = invoke("check", tmp_path / "new.toml")
    assert checked.exit_code == 0 and "note:" not in checked.output


def test_a_time_step_beyond_the_limit_is_reduced() -> None:
    """Points begin closer to the axis with 16 points per cell, where a single particle is stiffer."""
    values = completed("cylinder", (), {"grid.points_per_cell": 16})
    assert values is not None and values["time.cfl"] == 0.43
    assert case_limit(load_case("cylinder", as_overrides(values)))[0] >= values["time.cfl"]
    assert "time.cfl" not in (completed("cylinder", ["time.cfl=0.3"], {"grid.points_per_cell": 16}) or {})


def test_the_base_has_whole_cells() -> None:
    values = completed("lube-channel", (), {"grid.spacing": 0.009})
    assert values == {"grid.spacing": 0.009, "geometry.base_thickness": pytest.approx(0.018)}


def test_values_that_the_case_cannot_have_are_not_proposed() -> None:
    assert completed("lube-channel", (), {"grid.spacing": 0.03}) is None  # thicker than the base
    assert completed("lube-channel", ["geometry.aspect=0.3"], {"grid.spacing": 0.006}) is None  # 4.5 cells high


def test_a_column_too_flat_for_every_configuration_is_refused() -> None:
    with pytest.raises(UsageError, match=r"too few cells for this column.*set grid\.spacing"):
        recommend("lube-channel", ["geometry.aspect=0.02", "grid.spacing=0.0002"], 0.5)
