"""`mpmcol fit` with runs: files, JSON, a fit that is killed and resumed, refused input, the same from Python."""

from __future__ import annotations

import json
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from matplotlib.figure import Figure

import mpmcol
from mpmcol.io.results import Results
from mpmcol.io.run_status import read_status
from mpmcol.studies.fit import carry_out_fit, chart
from mpmcol.studies.fit.quantities import parse_targets
from mpmcol.studies.fit.unknowns import parse_unknowns
from mpmcol.studies.fit.values import fitted_values
from tests.support.cli import invoke
from tests.support.json_keys import unexplained_keys
from tests.support.processes import wait_until
from tests.support.runs import TINY

FRICTION = "material.friction_deg"
MEASURED = "zeta=0.2,beta=0.99+-0.01"
COMMAND = [
    "fit", "coarse-channel", "--to", MEASURED, "--vary", f"{FRICTION}=20:44", "--jobs", "1", "--threads", "1",
    *(word for value in TINY[:1] + TINY[2:] for word in ("--set", value)),
]  # fmt: skip


@pytest.fixture(scope="module")
def fitted(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("fits") / "whole"
    done = invoke(*COMMAND, "--out", str(out))
    assert done.exit_code == 0, done.output
    assert f"{FRICTION} = " in done.stdout and "+-" in done.stdout and "still moved" in done.stdout
    assert "grid not known" in done.stdout and "zeta: measured 0.2 +- 0.004, computed 0." in done.stdout
    return out


def test_a_fit_writes_values_runs_case_and_charts(fitted: Path) -> None:
    record = json.loads((fitted / "fit.json").read_text())
    (unknown,) = record["unknowns"]
    assert 20.0 <= unknown["value"] <= 44.0 and unknown["standard_error"] > 0.0
    parts = unknown["parts"]
    assert parts["grid"] is None  # not studied for this case
    assert parts["measurement"] ** 2 + parts["scatter"] ** 2 == pytest.approx(unknown["standard_error"] ** 2)
    assert unknown["low"] <= unknown["interval"][0] < unknown["value"] < unknown["interval"][1] <= unknown["high"]
    assert record["converged"] is True
    for target in record["targets"]:
        difference = (target["fitted"][0] - target["measured"][0]) / target["error_of_difference"][0]
        assert target["difference"] == [pytest.approx(difference)]
        assert f"| {target['name']} | {target['measured'][0]:.4g} | " in (fitted / "fit.md").read_text()
    case = mpmcol.load_case(fitted / "fitted.toml")
    assert case.material.friction_deg == pytest.approx(unknown["value"], rel=1e-5)
    assert case.grid.spacing == 0.015
    rows = (fitted / "evaluations.csv").read_text().splitlines()
    assert rows[0].startswith("level,folder,material.friction_deg,zeta,beta,repose [deg]")
    assert len(rows) - 1 == record["runs"] == len(list((fitted / "runs").glob("*/result.json")))
    assert rows[0].endswith("zeta_at_1,zeta_at_2,beta_at_1,beta_at_2,stop_time [sqrt(h_i/g)]")
    assert all((fitted / name).stat().st_size > 10_000 for name in ("fit.png", "profile.png"))


def test_a_misfit_without_a_degree_of_freedom_is_reported(fitted: Path) -> None:
    """No friction angle in the range gives four times the runout. The first runs are those of the other fit."""
    command = [*COMMAND[:3], "zeta=2.2+-0.05", *COMMAND[4:], "--out", str(fitted.parent / "missed")]
    shutil.copytree(fitted / "runs", fitted.parent / "missed" / "runs")
    done = invoke(*command)
    assert done.exit_code == 0, done.output
    assert done.stdout.startswith("no values in the ranges reproduce the measurements: zeta is 0.")
    assert "below the measured 2.2" in done.stdout and f"{FRICTION} = 20 deg, the nearest value, without" in done.stdout
    record = json.loads((fitted.parent / "missed" / "fit.json").read_text())
    (unknown,), (target,) = record["unknowns"], record["targets"]
    assert record["reproduced"] is False and target["reproduced"] is False and target["difference"][0] < -2.0
    assert unknown["standard_error"] is unknown["interval"] is unknown["parts"] is None and unknown["end"] == "low"
    assert "# no values in the ranges reproduce" in (fitted.parent / "missed" / "fitted.toml").read_text()


def test_the_chart_of_the_profile_names_the_run_that_it_shows(fitted: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn: list[Figure] = []
    monkeypatch.setattr(chart, "save_figure", lambda figure, path, svg: [drawn.append(figure)])
    targets, overrides = parse_targets(MEASURED), [TINY[0], TINY[2]]
    unknowns = parse_unknowns([f"{FRICTION}=20:44"], "coarse-channel", overrides)
    fit = carry_out_fit("coarse-channel", overrides, unknowns, targets, fitted, jobs=1, threads=1)
    chart.profile_chart(fit, fitted / "profile.png")
    (axes,) = drawn[0].axes
    labels = [str(line.get_label()) for line in axes.lines]
    captions = [text.get_text() for text in axes.texts]
    shares = [float(one.shares[0]) for one in fit.solution.evaluations]
    share = min(shares, key=lambda one: abs(one - float(fit.solution.shares[0])))
    assert f"run nearest to the answer: friction_deg {unknowns[0].at(share):.4g} deg" in labels
    (answer,) = (
        text for text in captions if text.startswith(f"answer: friction_deg {fitted_values(fit)[0].value:.4g} ")
    )
    assert " +- " in answer and answer.endswith(" deg; lines as computed")
    runout, height = ([float(xy[0]) for xy in bar.lines[0].get_data()] for bar in axes.containers)
    shape, zeta, beta = Results(fit.solution.last.folders[0]).shape, *(target.values[0] for target in targets[:2])
    assert runout == pytest.approx([1e3 * shape.r_i * (1.0 + zeta), 0.0])
    assert height == pytest.approx([0.0, 1e3 * shape.h_i * beta])
    title = "Fit: Channel on a coarse grid, a = 1"
    assert axes.get_title() == title
    chart.response_chart(fit, fitted / "fit.png")
    assert drawn[1].get_suptitle() == title
    assert [panel.get_xlabel() for panel in drawn[1].axes][-1] == f"{FRICTION} (deg)"


def test_the_help_states_the_assumed_error() -> None:
    text = " ".join(invoke("fit", "--help").output.split())
    assert "Without an error 2 % are assumed" in text and "assumed: 2 % of the largest" in text


def test_a_fit_has_a_report(fitted: Path) -> None:
    done = invoke("report", str(fitted))
    page = (fitted / "report.html").read_text()
    assert done.exit_code == 0 and "Fit: Channel" in page and page.count("<img") == 2 and FRICTION in page


def test_repeated_runs_differ_in_spacing_and_time_step(fitted: Path) -> None:
    first, second = (
        mpmcol.Results(next((fitted / "runs").glob(f"level1-friction_deg-32-{number}-*"))).case for number in (1, 2)
    )
    assert first.grid.spacing > second.grid.spacing and first.time.cfl > second.time.cfl


def test_a_fit_that_is_killed_resumes_with_equal_results(fitted: Path, tmp_path: Path) -> None:
    out = tmp_path / "fit"
    process = subprocess.Popen([sys.executable, "-m", "mpmcol", *COMMAND, "--out", str(out)], stderr=subprocess.DEVNULL)
    wait_until(lambda: len(list(out.glob("runs/*/result.json"))) >= 2)
    process.send_signal(signal.SIGKILL)
    process.wait()
    ended = {path.parent: path.stat().st_mtime_ns for path in out.glob("runs/*/result.json")}
    resumed = invoke(*COMMAND, "--out", str(out), "--json")
    assert resumed.exit_code == 0, resumed.output
    assert all((folder / "result.json").stat().st_mtime_ns == time for folder, time in ended.items())
    whole, again = json.loads((fitted / "fit.json").read_text()), json.loads(resumed.stdout)
    for record in (whole, again):
        del record["folder"], record["core_seconds"]
    assert whole == again


def test_python_gives_the_same_and_repeats_nothing(fitted: Path) -> None:
    times = {path: path.stat().st_mtime_ns for path in (fitted / "runs").glob("*/result.json")}
    remarks: list[str] = []
    found = mpmcol.fit(
        "coarse-channel", {"zeta": 0.2, "beta": (0.99, 0.01)}, {FRICTION: (20, 44)}, out=fitted,
        overrides=[TINY[0], TINY[2]], jobs=1, threads=1, notify=remarks.append,
    )  # fmt: skip
    assert times == {path: path.stat().st_mtime_ns for path in (fitted / "runs").glob("*/result.json")}
    assert found.values[0].value == json.loads((fitted / "fit.json").read_text())["unknowns"][0]["value"]
    assert FRICTION in repr(found) and FRICTION in found._repr_html_() and "still moved" in remarks[-1]
    with pytest.warns(UserWarning, match="still moved"):
        mpmcol.fit(
            "coarse-channel", {"zeta": 0.2, "beta": (0.99, 0.01)}, {FRICTION: (20, 44)}, out=fitted,
            overrides=[TINY[0], TINY[2]], jobs=1, threads=1,
        )  # fmt: skip
    assert "zeta: measured 0.2" in repr(found) and "zeta: measured 0.2" in found._repr_html_()
    assert found.agreement.comparisons[0].differences.tolist() == found.record["targets"][0]["difference"]


def test_fresh_repeats_all_runs(fitted: Path) -> None:
    before = {path: path.stat().st_mtime_ns for path in (fitted / "runs").glob("*/result.json")}
    assert invoke(*COMMAND, "--out", str(fitted), "--fresh", "--quiet").exit_code == 0
    assert all(path.stat().st_mtime_ns > time for path, time in before.items())
    assert all(read_status(path.parent).name == "done" for path in before)


def test_a_folder_that_holds_something_else_is_refused(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    done = invoke(*COMMAND, "--out", str(tmp_path))
    assert (
        done.exit_code == 2
        and "holds no fit" in done.stderr
        and [one.name for one in tmp_path.iterdir()] == ["notes.txt"]
    )


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--to", "zeta=1"), "no unknown; give --vary"),
        (("--vary", f"{FRICTION}=20:30"), "nothing measured; give --to"),
        (("--to", "zeta=1", "--vary", f"{FRICTION}=20:30", "--vary", "material.cohesion=1:2"), "cannot follow from 1"),
        (("--profile", "missing.csv", "--vary", f"{FRICTION}=20:30"), "missing.csv: cannot be read"),
        (("--to", "zeta=1", "--vary", "geometry.aspct=1:2"), "geometry.aspect"),
        (
            ("--to", "zeta=1", "--vary", "material.youngs_modulus=1e6:2e6", "--accuracy", "20%"),
            "youngs_modulus is set by --accuracy",
        ),
    ],
)
def test_what_cannot_be_fitted_is_refused(tmp_path: Path, arguments: tuple[str, ...], message: str) -> None:
    done = invoke("fit", "channel", "--out", str(tmp_path / "fit"), *arguments)
    assert done.exit_code == 2 and message in done.stderr and not (tmp_path / "fit").exists()


def test_a_dry_run_lists_the_first_runs_and_writes_nothing(tmp_path: Path) -> None:
    forecast = invoke(*COMMAND, "--out", str(tmp_path / "out"), "--dry-run", "--json")
    assert forecast.exit_code == 0 and not (tmp_path / "out").exists()
    record = json.loads(forecast.stdout)
    assert [run["inputs"][FRICTION] for run in record["runs"]] == [32.0, 32.0, 20.0, 20.0, 44.0, 44.0]
    assert unexplained_keys(["fit", "--dry-run"], record) == set()
    assert "level1: the grid of the case" in forecast.stderr
