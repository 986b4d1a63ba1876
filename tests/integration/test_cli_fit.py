"""`mpmcol fit` with runs: files, JSON, a fit that is killed and resumed, refused input, the same from Python."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import mpmcol
from mpmcol.io.run_status import read_status
from tests.support.cli import invoke
from tests.support.processes import wait_until
from tests.support.runs import TINY

FRICTION = "material.friction_deg"
MEASURED = "zeta=0.5,beta=0.97+-0.01"
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
    return out


def test_a_fit_writes_values_runs_case_and_charts(fitted: Path) -> None:
    record = json.loads((fitted / "fit.json").read_text())
    (unknown,) = record["unknowns"]
    assert 20.0 <= unknown["value"] <= 44.0 and unknown["standard_error"] > 0.0
    assert sum(part**2 for part in unknown["parts"].values()) == pytest.approx(unknown["standard_error"] ** 2)
    case = mpmcol.load_case(fitted / "fitted.toml")
    assert case.material.friction_deg == pytest.approx(unknown["value"], rel=1e-5)
    assert case.grid.spacing == 0.015
    rows = (fitted / "evaluations.csv").read_text().splitlines()
    assert rows[0].startswith("level,folder,material.friction_deg,zeta,beta,repose [deg]")
    assert len(rows) - 1 == record["runs"] == len(list((fitted / "runs").glob("*/result.json")))
    assert all((fitted / name).stat().st_size > 10_000 for name in ("fit.png", "profile.png"))


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
        "coarse-channel", {"zeta": 0.5, "beta": (0.97, 0.01)}, {FRICTION: (20, 44)}, out=fitted,
        overrides=[TINY[0], TINY[2]], jobs=1, threads=1, notify=remarks.append,
    )  # fmt: skip
    assert times == {path: path.stat().st_mtime_ns for path in (fitted / "runs").glob("*/result.json")}
    assert found.values[0].value == json.loads((fitted / "fit.json").read_text())["unknowns"][0]["value"]
    assert FRICTION in repr(found) and FRICTION in found._repr_html_() and "still moved" in remarks[-1]


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
