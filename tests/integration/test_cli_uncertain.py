"""`mpmcol sweep --uncertain` and `mpmcol.propagate` with small, short runs: files, repetition, contradictions."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

import mpmcol
from mpmcol.errors import CaseError, UsageError
from mpmcol.sweep.table import read_table
from tests.support.cli import invoke, set_options
from tests.support.runs import TINY
from tests.support.uncertain import FRICTION

pytestmark = pytest.mark.usefixtures("in_empty_folder")
OPTIONS = ("--uncertain", f"{FRICTION}=normal:33,1.5", "--samples", "6", "--passes", "105 mm")
SWEEP = ("sweep", "coarse-channel", *set_options(TINY), *OPTIONS)


def modified(folder: Path) -> dict[str, int]:
    return {str(path): path.stat().st_mtime_ns for path in folder.rglob("*") if path.is_file()}


def test_files_of_an_uncertain_sweep_and_its_repetition() -> None:
    first = invoke(*SWEEP, "--report")
    (out,) = Path("sweeps").iterdir()
    assert first.exit_code == 0, first.output
    assert "6 of 6 runs of a Latin hypercube (seed 0) are done; 6 still moved at the end" in first.stdout
    assert "front_height passes 0.105 m from the wall or axis in " in first.stdout
    assert f"in {out}: uncertainty.json, uncertainty.csv, uncertainty.png, table.csv" in first.stdout
    rows = read_table(out / "table.csv")
    zeta = [float(row["zeta.front_height"]) for row in rows]
    page = (out / "report.html").read_text()
    assert "<h2>Uncertainty</h2>" in page and f"{FRICTION} = normal:33,1.5" in page
    before = modified(out)
    again = invoke(*SWEEP, "--json")
    assert again.exit_code == 0 and "6 already finished: nothing to run" in again.stderr
    assert modified(out) == before
    record = json.loads(again.stdout)
    assert record["quantities"][0]["mean"] == pytest.approx(sum(zeta) / 6)
    assert record["runs"] == [row["folder"] for row in rows]
    assert record["passes"][0]["met"] == sum(float(row["front.front_height"]) > 0.105 for row in rows)
    other = invoke(*SWEEP, "--seed", "1", "--dry-run", "--json")
    assert {run["folder"] for run in json.loads(other.stdout)["runs"]}.isdisjoint(record["runs"])
    (out / "table.csv").unlink()
    unfinished = sorted(out.glob("friction*/result.json"))[0]
    unfinished.unlink()  # as if the run had been killed
    resumed = invoke(*SWEEP)
    assert resumed.exit_code == 0 and "6 runs, 5 already finished" in resumed.stderr
    assert resumed.stderr.count(" done (") == 1 and json.loads((out / "uncertainty.json").read_text())["done"] == 6


def test_the_python_function_finds_the_runs_of_the_command() -> None:
    values = {key: float(text) for key, _, text in (one.partition("=") for one in TINY)}
    done = invoke(*SWEEP, "--out", "out", "--quiet")
    assert (done.exit_code, done.output) == (0, "")
    before = modified(Path("out"))
    notes: list[str] = []
    found = mpmcol.propagate(
        "coarse-channel", {FRICTION: "normal:33,1.5"}, values,
        samples=6, passes=[0.105], out="out", notify=notes.append,
    )  # fmt: skip
    on_plan, on_results = notes
    assert on_plan == "note: geometry.base_thickness became 0.015 m (-25.00%), 1 whole cell"
    assert "the column still moved at the time limit" in on_results
    assert modified(Path("out")) == before
    assert len(found.runs) == 6 and found.quantity("beta").statistics.count == 6
    assert repr(found) == "<UncertaintyResults 'out': 6 of 6 runs done>" and "<td>beta</td>" in found._repr_html_()
    with pytest.raises(UsageError, match="no quantity 'gamma'"):
        found.quantity("gamma")
    with pytest.raises(UsageError, match="no uncertain input"):
        mpmcol.propagate("coarse-channel", {})
    with pytest.raises(CaseError, match="sample 1 of 6"):
        mpmcol.propagate(mpmcol.load_case("coarse-channel"), {FRICTION: "uniform:90,91"}, samples=6)


def test_commands_and_a_forecast_run_nothing() -> None:
    printed = invoke(*SWEEP, "--engine", "commands", "--out", "out")
    assert printed.exit_code == 0 and printed.stdout.count("mpmcol run ") == 6
    forecast = invoke(*SWEEP, "--dry-run")
    assert forecast.exit_code == 0 and "nothing was run" in forecast.stdout and not Path("sweeps").exists()
    assert "beyond the domain" not in forecast.stderr
    assert "300 m: beyond the domain" in invoke(*SWEEP, "--dry-run", "--passes", "300").stderr


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--uncertain", f"{FRICTION}=normal:33"), "expected normal:MEAN,SD with 2 numbers, found 1"),
        (("--uncertain", f"{FRICTION}=normal:33,20"), f"sample 5 of 64, {FRICTION} = -"),
        ((*OPTIONS, "--zip"), "--zip combines given values, and --uncertain draws them"),
        ((*OPTIONS, "--aspect", "1,2"), "--set geometry.aspect=1,2: expected one value beside uncertain keys"),
        ((*OPTIONS, "--set", f"{FRICTION}=30"), f"{FRICTION} is uncertain as well"),
        ((*OPTIONS, "--engine", "commands", "--json"), "--json prints results"),
        ((*OPTIONS, "--passes", "-1"), "expected a number > 0 in m"),
        ((*OPTIONS, "--passes", "3 kg"), "expected a number > 0 in m"),
        ((*OPTIONS, "--samples", "4"), "4 is not in the range 5<=x<=10000"),
        (("--aspect", "1,2", "--samples", "8"), "--samples, --seed and --passes require --uncertain"),
    ],
)
def test_bad_options_are_refused_before_anything_runs(options: tuple[str, ...], message: str) -> None:
    refused = invoke("sweep", "coarse-channel", *options)
    assert (refused.exit_code, refused.stdout) == (2, "") and message in refused.stderr
    assert not list(Path().iterdir())


def spoil_record(out: Path) -> None:
    path = out / "uncertainty.json"
    path.write_text(path.read_text().replace('"first_order"', '"first"'))


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (spoil_record, "uncertainty.json is damaged ('first_order'); delete it and repeat the `mpmcol sweep` command"),
        (lambda out: (out / "uncertainty.png").unlink(), "uncertainty.png is missing"),
    ],
)
def test_a_damaged_analysis_is_not_reported(spoil: Callable[[Path], None], message: str) -> None:
    assert invoke(*SWEEP, "--out", "out", "--quiet").exit_code == 0
    spoil(Path("out"))
    refused = invoke("report", "out")
    assert refused.exit_code == 5 and message in refused.stderr


def test_the_analysis_of_an_earlier_sweep_is_not_reported() -> None:
    assert invoke(*SWEEP, "--out", "out", "--quiet").exit_code == 0
    other = invoke(
        "sweep", "coarse-channel", *set_options(TINY), "--aspect", "1", "--out", "out", "--quiet", "--report"
    )
    assert other.exit_code == 0, other.output
    assert "<h2>Uncertainty</h2>" not in (Path("out") / "report.html").read_text()
