"""Every name in results is explained, and columns of CSV files have units."""

from __future__ import annotations

import json
import re
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import click
import numpy as np
import pytest

import mpmcol
from mpmcol.case import key_names, load_case
from mpmcol.cli import COMMANDS, accuracy, main, paper, run_summary
from mpmcol.errors import NumericalFailure
from mpmcol.io.columns import explain_name, unit_of, with_unit, without_unit
from mpmcol.io.glossary import HISTORY, MEASURE, RESULT, SLOPES, TABLE
from mpmcol.io.json_glossary import ALL_NAMES, CONTENTS, OUTPUTS
from mpmcol.io.results import Results, read_history
from mpmcol.io.term_glossary import TERMS
from mpmcol.provenance import environment
from mpmcol.studies import judgement
from mpmcol.studies.frame import StudyResult
from mpmcol.studies.paper.report import Comparison, FigureResult
from mpmcol.studies.pareto.certify import ErrorBar
from mpmcol.sweep.engine import Outcome
from mpmcol.sweep.fits import Slope
from mpmcol.sweep.plan import Plan, PlanEntry
from mpmcol.sweep.runs import PlannedRun
from mpmcol.sweep.table import make_rows, read_table, table_text
from mpmcol.sweep.task import TaskResult
from tests.support.cli import csv_row, invoke
from tests.support.json_keys import names_in, unexplained, unexplained_keys
from tests.support.runs import TINY

ENERGIES = ("potential", "kinetic", "elastic", "plastic", "damping", "residual", "grid_kinetic")


@pytest.fixture(scope="module")
def table(finished: Path) -> list[dict[str, Any]]:
    """The row of a finished run in the table of a sweep over its aspect ratio and spacing."""
    case = load_case(finished / "case.resolved.toml")
    inputs = {"geometry.aspect": 1.0, "grid.spacing": case.grid.spacing}
    return make_rows([Outcome(PlannedRun(inputs, case, finished), TaskResult("done", 1))])


def test_every_name_in_a_result_is_explained(finished: Path) -> None:
    summary = json.loads((finished / "result.json").read_text())
    assert unexplained(RESULT, names_in(summary)) == set()
    assert all(explain_name(name) for name in names_in(summary))


def test_every_array_of_a_snapshot_and_every_file_of_a_run_is_explained(finished: Path) -> None:
    names = [*Results(finished).snapshot(-1).arrays, *(path.name for path in finished.iterdir() if path.name[0] != ".")]
    assert {"displacement", "SHA256SUMS", "history.csv", "snapshots"} <= set(names)
    for name in names:
        assert invoke("explain", name).exit_code == 0, name


def test_explain_accepts_keys_with_indices_as_messages_have_them() -> None:
    for key in ("layers.0.material.friction_deg", "walls.1.height", "walls.0"):
        explained, plain = (invoke("explain", name) for name in (key, re.sub(r"\.\d+", "", key)))
        assert explained.exit_code == 0 and explained.stdout == plain.stdout
    assert invoke("explain", "layers.0.colour").exit_code != 0


def test_every_name_of_failures_and_retries_is_explained(tmp_path: Path) -> None:
    """The time step is far beyond the stability limit at first."""
    harsh = load_case("coarse-channel", [*TINY, "time.cfl=2"])
    with pytest.raises(NumericalFailure):
        mpmcol.run(harsh, tmp_path / "failed", threads=1)
    retried = mpmcol.run(harsh, tmp_path / "retried", threads=1, on_instability="retry").summary
    summary = Results(tmp_path / "failed").summary
    assert summary["failure"]["check"] and retried["retries"]
    assert unexplained(RESULT, names_in(summary)) == unexplained(RESULT, names_in(retried)) == set()


def test_every_name_of_a_measurement_is_explained(finished: Path) -> None:
    record = json.loads(invoke("measure", finished, "--json").stdout)
    assert unexplained(MEASURE, names_in(record)) == set()
    text = invoke("measure", finished, "--csv").stdout
    assert unexplained(MEASURE, iter(csv_row(text))) == set()
    assert "front.front_height [m]" in text and "repose_angle_deg," in text and "time [s]" in text


def test_every_name_of_a_granular_bed_is_explained_and_measured_as_the_run_did(tmp_path: Path) -> None:
    coarse = [*TINY, "grid.spacing=0.015", "geometry.base_thickness=0.03", "base_material.friction_deg=25"]
    results = mpmcol.run(load_case("granular-bed", coarse), tmp_path / "run", threads=1)
    record = json.loads(invoke("measure", results.folder, "--json").stdout)
    assert unexplained(RESULT, names_in(results.summary)) == unexplained(MEASURE, names_in(record)) == set()
    row = csv_row(invoke("measure", results.folder, "--csv").stdout)
    assert record["erosion"] == results.summary["erosion"] == asdict(results.erosion)
    assert float(row["erosion.deposit_front"]) == pytest.approx(record["erosion"]["deposit_front"], rel=1e-5)
    (tabled,) = make_rows([Outcome(PlannedRun({}, results.case, results.folder), TaskResult("done", 1))])
    assert tabled["erosion.surface_drop"] == record["erosion"]["surface_drop"]
    assert unit_of(TABLE, "erosion.surface_drop") == "m"
    surface, shape = record["surface_over_bed"], results.shape
    assert sum(surface["y"]) * shape.spacing == pytest.approx(shape.r_i * shape.h_i, rel=1e-5)  # float32 masses
    assert "surface over that of the bed" in invoke("measure", results.folder).stdout


def test_every_column_of_the_history_is_explained_and_has_its_unit(finished: Path) -> None:
    columns = (finished / "history.csv").read_text().partition("\n")[0].split(",")
    assert unexplained(HISTORY, map(without_unit, columns)) == set()
    assert {f"{name} [J/m]" for name in ENERGIES} < set(columns)  # plane strain
    assert {"time [s]", "front_height [m]", "step", "J_min"} < set(columns)


def test_a_history_of_an_earlier_version_can_be_read(finished: Path, tmp_path: Path) -> None:
    """Its columns have no units."""
    header, rows = (finished / "history.csv").read_text().split("\n", 1)
    (tmp_path / "history.csv").write_text(",".join(map(without_unit, header.split(","))) + "\n" + rows)
    old, new = read_history(tmp_path / "history.csv"), read_history(finished / "history.csv")
    assert list(old) == list(new) and all(np.array_equal(old[name], new[name]) for name in old)


def test_every_column_of_a_sweep_is_explained_and_has_its_unit(table: list[dict[str, Any]], tmp_path: Path) -> None:
    assert unexplained(TABLE, iter(table[0])) <= set(key_names())
    (tmp_path / "table.csv").write_text(table_text(table))
    columns = (tmp_path / "table.csv").read_text().partition("\n")[0].split(",")
    expected = {"geometry.aspect", "grid.spacing [m]", "zeta.front_height", "height [m]", "seconds [s]"}
    assert expected < set(columns)
    (row,) = read_table(tmp_path / "table.csv")
    assert list(row) == list(table[0]) and float(row["height"]) == table[0]["height"]


def test_every_column_of_the_slopes_is_explained() -> None:
    assert unexplained(SLOPES, (field.name for field in fields(Slope))) == set()


def test_every_command_with_json_output_has_its_keys_in_the_glossary() -> None:
    """The other tests of a command compare its keys with them: `invoke` does."""
    with_json = {name for name in COMMANDS if "--json" in options_of(main.get_command(click.Context(main), name))}
    explained = {name.partition(" ")[0] for name in (*OUTPUTS, *CONTENTS) if name.endswith("--json")}
    assert with_json == explained


def options_of(command: click.Command | None) -> list[str]:
    assert command is not None
    return [option for parameter in command.params for option in parameter.opts]


@pytest.mark.parametrize(
    "command",
    [
        ("status", "RUN"),
        ("verify", "RUN"),
        ("measure", "RUN"),
        ("plan", "quickstart", "--accuracy", "10%"),
        ("run", "coarse-channel", "--dry-run"),
        ("sweep", "coarse-channel", "--aspect", "1,2", "--dry-run"),
    ],
)
def test_every_key_of_json_output_is_explained(finished: Path, command: tuple[str, ...]) -> None:
    done = invoke(*(finished if word == "RUN" else word for word in command), "--json")
    assert done.exit_code == 0 and {*names_in(json.loads(done.stdout))}, done.output


def test_a_key_without_an_entry_is_found() -> None:
    assert unexplained_keys(["status", "x", "--json"], {"counts": {"done": 1}, "runs": [{"age": 1.0}]}) == {"runs.age"}


def test_every_key_of_error_bars_is_explained(finished: Path) -> None:
    bar = ErrorBar("zeta.front_height", {10.0: 2.5, 20.0: 2.6, 28.0: 2.7}, 2.8, 0.1, 0.2, 0.05)
    record = accuracy._record(bar, Results(finished))
    assert record["law"] and unexplained_keys(["run"], {"error_bars": {bar.quantity: record}}) == set()


def test_every_key_of_a_comparison_with_the_paper_is_explained() -> None:
    figure = FigureResult([], [Comparison("zeta", 0.1, 0.2)])
    record = paper._record(StudyResult([], {"fig6": figure}, [Path("fig6.csv")]))
    assert unexplained_keys(["paper"], record) == set()


def test_every_key_of_json_files_of_sweeps_and_studies_is_explained() -> None:
    plan = asdict(Plan("", "", 1, 1, (PlanEntry("a", {"geometry.aspect": 1.0}, 1.0, 1.0),)))
    assert unexplained("sweep.json", names_in({"schema": 1, **plan})) == set()
    assert unexplained("environment.json", names_in(environment())) == set()


@pytest.mark.parametrize(
    ("name", "parts"),
    [
        ("zeta", ["(r_f - r_i) / r_i", "Eq. 37", "result.json", "table.csv"]),
        ("front_height", ["front.front_height", "unit m", "history.csv"]),
        ("zeta.front_height.mean", ["runout"]),
        ("repose_angle_deg", ["20 % of the height", "unit deg"]),
        ("state_sha256", ["checksum"]),
        ("kinetic_energy", ["ledger.kinetic, kinetic", "per metre of width", "per radian"]),
        ("error.lube-2004.zeta.front_max", ["relative error"]),
        ("seconds_left", ["unit s", "status --json"]),
        ("error_bars", ["zero spacing", "error_bars.json"]),
        ("accuracy", ["statement of accuracy", "accuracy.json"]),
        ("finer_grids", ["what finer grids would give", "run --json"]),
        ("from_order", ["lowest and highest order"]),
        ("findings", ["problems", "verify --json"]),
        ("time", ["[time]", "time.cfl", "time since release", "unit s"]),
        ("worst J", ["worst_J", "volume ratio"]),
        ("energy residual", ["the output of mpmcol run", "per metre of width"]),
        ("agrees within the scatter", ["at most its scatter"]),
    ],
)
def test_names_are_explained_by_the_command(name: str, parts: list[str]) -> None:
    explained = invoke("explain", name)
    assert explained.exit_code == 0 and all(part in explained.stdout for part in parts)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("base_friction", "Friction with floor and walls is given in the table friction"),
        ("friction_deg", 'Did you mean "material.friction_deg"?'),
        ("", None),
        ("nonsense", 'there is no key or name "nonsense". (mpmcol explain'),
    ],
)
def test_keys_of_a_case_come_before_words_of_names(name: str, message: str | None) -> None:
    explained = invoke("explain", name)
    assert message in explained.stderr if message else "grid.spacing" in explained.stdout
    assert explained.exit_code == (2 if message else 0)


def test_terms_are_those_that_a_run_prints() -> None:
    """Terms of the glossary occur in the modules that print summary and judgement."""
    printed = "".join(Path(module.__file__ or "").read_text() for module in (judgement, run_summary))
    assert {term for term in TERMS if term not in printed} == set()


def test_all_names_are_listed() -> None:
    listed = invoke("explain", "results").stdout
    assert all(f"\n  {name}\n    " in listed for names in ALL_NAMES.values() for name in names)
    assert "grid.spacing" in invoke("explain").stdout and "state_sha256" not in invoke("explain").stdout


def test_a_unit_is_not_repeated() -> None:
    named = {with_unit(*column) for column in (("time", "s"), ("angle_deg", "deg"), ("a", "1"), ("status", ""))}
    assert named == {"time [s]", "angle_deg", "a", "status"} and {*map(without_unit, named)} == {
        "time", "angle_deg", "a", "status",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("model", "unit"), [("plane", "J/m"), ("axisymmetric", "J/rad"), ("quarter", "J"), ("full", "J")]
)
def test_energies_are_per_metre_per_radian_or_whole(model: str, unit: str) -> None:
    assert unit_of(HISTORY, "kinetic", model) == unit
    assert unit_of(HISTORY, "height", model) == "m"


def test_the_unit_of_energies_is_in_the_result_and_in_the_text(finished: Path) -> None:
    assert Results(finished).summary["energy_unit"] == "J per metre of width"
    measured = invoke("measure", finished).stdout
    assert any(
        line.startswith("energy released") and line.endswith("J per metre of width") for line in measured.splitlines()
    )
