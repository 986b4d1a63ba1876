"""The Python interface: names, tables in notebooks, functions, and errors as exceptions."""

from __future__ import annotations

import inspect
import json
import re
import runpy
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mpmcol
from mpmcol.cli.measure_text import text_of
from mpmcol.errors import MpmcolError, OutputError, UsageError
from mpmcol.io.html import html_table
from mpmcol.sweep import runner
from mpmcol.sweep.engine import Outcome
from mpmcol.sweep.task import TaskResult
from tests.support.runs import TINY

ROOT = Path(mpmcol.__file__).parents[1]
FUNCTIONS = ("load_case", "measure", "plot", "propagate", "render", "report", "run", "sweep")


def test_dir_lists_what_there_is() -> None:
    assert set(FUNCTIONS) | {"Results", "Case", "errors", "shipped_cases"} <= set(dir(mpmcol))
    assert dir(mpmcol) == sorted(mpmcol.__all__)
    assert all(getattr(mpmcol, name) is not None for name in dir(mpmcol))


@pytest.mark.parametrize("first", ["", "import mpmcol.sweep.runs, mpmcol.measure.front; "])
def test_functions_and_packages_of_one_name(first: str) -> None:
    """In a new process, whatever is imported first."""
    code = f"{first}import mpmcol; from mpmcol.sweep.runs import plan_runs; from mpmcol.measure import measure; "
    code += "assert callable(mpmcol.sweep) and callable(mpmcol.measure)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions_have_signature_and_documentation(name: str) -> None:
    function = getattr(mpmcol, name)
    assert inspect.signature(function).parameters and "Raises:" in function.__doc__


def test_results_are_shown_as_text_and_as_a_table(finished: Path) -> None:
    results = mpmcol.Results(finished)
    assert "done, not at rest" in repr(results) and "(front_height)" in repr(results)
    shown = results._repr_html_()
    for name in ("case", "state", "zeta", "beta", "energy error"):
        assert f"<td>{name}</td>" in shown


NO_VALUE = '{"schema": 1, "status": "done", "zeta": null}'
FAILED = '{"schema": 1, "status": "failed", "ledger": {"residual": null}, "dissipation": {"released": 2.0}}'


@pytest.mark.parametrize("content", [None, "{", "[]", "{}", '{"schema": 1, "status": "stopped"}', NO_VALUE, FAILED])
def test_unfinished_and_damaged_results_are_shown_as_well(finished: Path, tmp_path: Path, content: str | None) -> None:
    shutil.copy(finished / "case.resolved.toml", tmp_path)
    if content is not None:
        (tmp_path / "result.json").write_text(content)
    results = mpmcol.Results(tmp_path)
    assert str(tmp_path) in repr(results) and "<table>" in results._repr_html_()


def test_texts_in_tables_are_escaped() -> None:
    assert html_table(["<b>"], [["a & b", 0.123456, None]]) == (
        "<table><thead><tr><th>&lt;b&gt;</th></tr></thead>"
        "<tbody><tr><td>a &amp; b</td><td>0.1235</td><td></td></tr></tbody></table>"
    )


@pytest.mark.parametrize(
    ("cells", "text"),
    [(20, "9 to 15 deg below that of the material"), (6, "is not studied for this column and grid")],
)
def test_the_angle_of_repose_is_mapped_to_a_friction_angle(finished: Path, cells: int, text: str) -> None:
    """The README of mpmcol/measure has 19.7 and 21.0 degrees for a channel of a = 1 and 30 degrees."""
    found = mpmcol.measure(finished)
    assert found.friction_from_repose is None and "friction from repose" not in text_of(found)  # not at rest
    measurement = replace(found.measurement, repose_angle_deg=19.7)
    shape = replace(found.shape, spacing=found.shape.r_i / cells)
    deposit = replace(found, at_rest=True, measurement=measurement, shape=shape)
    assert deposit.friction_from_repose == pytest.approx(21.0, abs=0.05)
    (line,) = (line for line in text_of(deposit).splitlines() if line.startswith("friction from repose"))
    assert " 21.0 deg; " in line and text in line
    steep = replace(deposit, measurement=replace(measurement, repose_angle_deg=46.0))
    assert steep.friction_from_repose is None


def test_reasons_for_laws_that_are_not_compared_stand_once(finished: Path) -> None:
    found = mpmcol.measure(finished)
    reason = "for a flow without obstacles; here walls stand in its way"
    scores = [
        replace(score, expected=None, error=None, comment=reason + " (unverified)" * (not score.verified))
        for score in found.scores
    ]
    text = text_of(replace(found, scores=scores))
    assert text.count("obstacles") == 1 and f"\nnot compared, {reason}:\n  Lube et al. 2007 (zeta" in text


def test_measure_and_plot_take_results_or_a_folder(finished: Path, tmp_path: Path) -> None:
    by_folder, by_results = mpmcol.measure(str(finished)), mpmcol.measure(mpmcol.Results(finished), -1)
    assert by_folder.measurement.zeta == by_results.measurement.zeta and by_folder.scores
    (path, *_) = mpmcol.plot(finished, times=[], out=tmp_path / "charts")
    assert path.parent == tmp_path / "charts" and path.exists()


def test_a_report_takes_results_and_folders(finished: Path, tmp_path: Path) -> None:
    path = mpmcol.report(mpmcol.Results(finished), out=tmp_path / "one.html")
    assert path.read_text().count("Judgement") > 0
    with pytest.raises(UsageError, match="given twice"):
        mpmcol.report(finished, str(finished), out=tmp_path / "two.html")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"color": "speed"}, "color = 'speed': expected one of displacement, velocity"),
        ({"size": (0, 0)}, "size = (0, 0): expected width and height in pixels, each 200 to 8000"),
        ({"size": (1280,)}, "size = (1280,): expected width and height"),
    ],
)
def test_images_that_cannot_be_drawn_are_refused(finished: Path, arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(UsageError, match=re.escape(message)):
        mpmcol.render(finished, **arguments)


def test_a_finished_run_is_returned(finished: Path) -> None:
    messages: list[str] = []
    results = mpmcol.run(mpmcol.load_case("coarse-channel", TINY), finished, notify=messages.append)
    assert results.status == "done" and "nothing to compute" in messages[0]


@pytest.fixture
def outcomes(finished: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Runs of sweeps are copies of a finished run, except the last of several, which diverges; their names."""
    names: list[str] = []

    def execute(runs, *_, **__):
        for run in runs:
            names.append(run.name)
            failed = len(runs) > 1 and run is runs[-1]
            if not failed and not run.folder.exists():
                shutil.copytree(finished, run.folder)
            yield Outcome(run, TaskResult("failed", 1, 3, "too fast") if failed else TaskResult("done", 1))

    monkeypatch.setattr(runner, "execute_runs", execute)
    return names


def test_a_sweep_returns_its_table(outcomes: list[str], tmp_path: Path) -> None:
    case = mpmcol.load_case("coarse-channel", TINY)
    values = {"material.friction_deg": "30:32:2", "time.cfl": 0.4}
    found = mpmcol.sweep(case, values, aspect=[1, 2.0], out=tmp_path, notify=[].append)
    assert outcomes == [f"a{a}-friction{phi}deg" for a in (1, 2) for phi in (30, 32)]
    assert [row["status"] for row in found.rows] == ["done"] * 3 + ["failed"] and len(found.runs) == 3
    assert found.column("geometry.aspect").tolist() == [1.0, 1.0, 2.0, 2.0]
    assert found.column("beta")[0] == found.runs[0].summary["beta"] and found.column("beta")[3] != 0.0
    assert "3 of 4 runs done" in repr(found) and "<td>a1-friction30deg</td>" in found._repr_html_()
    assert json.loads((tmp_path / "sweep.json").read_text())["runs"][0]["inputs"]["time.cfl"] == 0.4


def test_notes_of_a_sweep_are_warnings(outcomes: list[str], tmp_path: Path) -> None:
    with pytest.warns(UserWarning) as caught:
        mpmcol.sweep("coarse-channel", {"grid.spacing": 0.015}, out=tmp_path / "sweep")
    on_plan, on_result = (str(warning.message) for warning in caught)
    assert "base_thickness became 0.015 m" in on_plan and "the column still moved at the time limit" in on_result
    assert outcomes == ["spacing15mm"]


def fit(**arguments: Any) -> None:
    """A fit of the friction angle with some arguments replaced."""
    given: dict[str, Any] = {"to": {"zeta": [1.4, 0.1]}, "vary": {"material.friction_deg": (np.float64(20), 45)}}
    mpmcol.fit("coarse-channel", **(given | arguments))


@pytest.mark.parametrize(
    ("call", "kind", "message"),
    [
        (lambda: mpmcol.sweep("coarse-channel"), UsageError, "no key to vary"),
        (lambda: mpmcol.sweep("coarse-channel", aspect="3:1"), UsageError, "geometry.aspect: 3:1: the end of a range"),
        (lambda: mpmcol.sweep("coarse-channel", aspect=1, accuracy=5), UsageError, "between 0 and 1, for example 0.05"),
        (lambda: mpmcol.sweep("coarse-channel", {"grid.spacng": [1]}), MpmcolError, 'did you mean "spacing"'),
        (lambda: mpmcol.sweep("coarse-channel", {"grid.spacing": []}), UsageError, "grid.spacing: no value"),
        (
            lambda: mpmcol.sweep("coarse-channel", aspect=1, jobs=-1),
            UsageError,
            "jobs = -1: expected an integer from 1",
        ),
        (lambda: mpmcol.sweep("coarse-channel", aspect=1, threads=0), UsageError, "threads = 0: expected an integer"),
        (lambda: mpmcol.report(), UsageError, "no folder given"),
        (lambda: fit(to={"zeta": [1.0, 0.1, 3.0]}), UsageError, "to zeta = [1.0, 0.1, 3.0]: expected a number, or a"),
        (lambda: fit(vary={"material.friction_deg": (20, 30, 45)}), UsageError, "expected the two ends of a range"),
        (lambda: fit(accuracy=10), UsageError, "accuracy = 10: expected a relative error between 0 and 1"),
        (lambda: fit(repeats=0), UsageError, "repeats = 0: expected an integer from 2 to 20"),
        (
            lambda: mpmcol.run("quickstart", "nowhere"),
            UsageError,
            "case = 'quickstart': expected a case of mpmcol.load_case",
        ),
        (lambda: mpmcol.measure("nowhere"), OutputError, "expected the results folder of a run"),
        (lambda: mpmcol.plot("nowhere"), OutputError, "expected the results folder of a run"),
        (lambda: mpmcol.render("nowhere"), OutputError, "expected the results folder of a run"),
    ],
)
def test_problems_are_exceptions_of_mpmcol(call, kind: type[Exception], message: str) -> None:
    with pytest.raises(kind) as raised:
        call()
    assert message.lower() in str(raised.value).lower()


def test_the_example_of_a_notebook(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(ROOT / "scripts" / "example_notebook.py"))
    printed = capsys.readouterr().out
    assert "2 of 2 runs done" in printed and "expected a number > 0, in m" in printed
    assert {path.name for path in Path("example").iterdir()} == {"quickstart", "charts", "sweep"}
