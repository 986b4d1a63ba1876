"""Results folders in which a file is missing, damaged or changed: every command that reads them reports it alike."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from mpmcol.errors import Interrupted
from mpmcol.io.checksums import write_checksums
from mpmcol.io.results import Results
from mpmcol.simulation.run import run as simulate
from tests.support.cli import invoke
from tests.support.runs import TINY, small_case

READERS = ("measure", "plot", "report")


@pytest.fixture
def run(finished: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(finished, tmp_path / "run"))


def change_result(run: Path, change: Callable[[dict], object]) -> None:
    result = json.loads((run / "result.json").read_text())
    change(result)
    (run / "result.json").write_text(json.dumps(result))


def edit_case(run: Path, old: str, new: str) -> None:
    case = run / "case.resolved.toml"
    assert case.read_text().count(old) == 1
    case.write_text(case.read_text().replace(old, new))


# ------------------------------------------------------------------------------------------- missing snapshots


def test_an_earlier_state_is_not_taken_for_the_deposit(run: Path) -> None:
    change_result(run, lambda result: result.update(at_rest=True))
    last = len(Results(run).snapshots) - 1
    assert "the final deposit" in invoke("measure", run, "--snapshot", last).stdout
    path = run / f"snapshots/{last:06d}.vtkhdf"
    path.unlink()
    for command in ("measure", "render"):
        refused = invoke(command, run)
        assert (
            refused.exit_code == 5 and f"{path}: snapshot {last} is missing; restore it from a copy" in refused.stderr
        )
    reported = invoke("report", run)
    assert reported.exit_code == 5 and str(path) in reported.stderr and not (run / "report.html").exists()
    plotted = invoke("plot", run)
    assert plotted.exit_code == 0 and f"note: {path} is missing and omitted" in plotted.stderr
    earlier = invoke("measure", run, "--snapshot", last - 1)
    assert earlier.exit_code == 0 and "not the final deposit" in earlier.stdout


def test_a_missing_snapshot_does_not_change_the_index_of_the_others(run: Path) -> None:
    second = Results(run).snapshot(2).time
    (run / "snapshots/000001.vtkhdf").unlink()
    assert Results(run).snapshot(2).time == second
    assert invoke("measure", run).exit_code == 0
    assert "snapshot 1 is missing" in invoke("measure", run, "--snapshot", 1).stderr


@pytest.mark.parametrize("index", [4, -5, 99])
def test_measure_and_render_refuse_an_index_alike(run: Path, index: int) -> None:
    measured, rendered = (invoke(command, run, "--snapshot", index) for command in ("measure", "render"))
    assert (measured.exit_code, rendered.exit_code) == (2, 2) and measured.stderr == rendered.stderr
    assert f"there is no snapshot {index}; expected 0 to 3, or -1 for the last" in measured.stderr


# ------------------------------------------------------------------------------------------------- result.json


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        ("{}", "it lacks schema and status"),
        ('{"schema": 1}', "it lacks status"),
        ('{"schema": 9, "status": "done"}', "its schema is 9, expected 1: written by another version of mpmcol"),
        ('{"schema": 1, "status": "over"}', "its status is 'over', expected one of done, failed, stopped"),
        ("[]", "it is not a result"),
        ("{", "it cannot be read: it is not JSON"),
        ("[" * 100_000, "it cannot be read: it is not JSON"),
    ],
)
def test_a_result_that_is_none_is_refused_by_all(run: Path, content: str, problem: str) -> None:
    (run / "result.json").write_text(content)
    message = f"{run / 'result.json'}: {problem}; run the case again with --fresh\n"
    assert [invoke(command, run).stderr for command in READERS] == [message] * 3
    assert [invoke(command, run).exit_code for command in READERS] == [5] * 3
    status = invoke("status", run)
    assert f"damaged   result.json: {problem}\n" in status.stdout
    assert "the result is damaged: run the case again with --fresh" in status.stdout
    assert invoke("status", run, "--follow").exit_code == 5


def test_a_damaged_result_is_replaced_as_status_says(run: Path, tmp_path: Path) -> None:
    """A single run with --fresh, a stopped run and a sweep by the same command."""
    (run / "result.json").write_text("{}")
    command = ("run", run / "case.resolved.toml", "--out", run, "--quiet")
    refused = invoke(*command)
    assert refused.exit_code == 5 and "it lacks schema and status; run the case again with --fresh" in refused.stderr
    assert invoke(*command, "--fresh").exit_code == 0 and Results(run).status == "done"


def test_a_stopped_run_with_a_damaged_result_resumes_as_status_says(tmp_path: Path) -> None:
    case = small_case("plane")
    with pytest.raises(Interrupted):
        simulate(case, tmp_path, max_wall=0.0)
    (tmp_path / "result.json").write_text("{}")
    assert "; repeat the command to complete the missing ones\n" in invoke("status", tmp_path).stdout
    assert simulate(case, tmp_path).status == "done"


def test_a_sweep_replaces_a_damaged_run_as_status_says(tmp_path: Path) -> None:
    out = tmp_path / "sweep"
    command = ("sweep", "coarse-channel", *(f"--set={value}" for value in TINY), "--aspect", "1", "--out", out)
    assert invoke(*command, "--quiet").exit_code == 0
    (folder,) = (path.parent for path in out.glob("*/result.json"))
    (folder / "result.json").write_text("{}")
    status = invoke("status", out).stdout
    assert "1 damaged" in status and "repeat the command to complete the missing ones and to replace the" in status
    assert invoke(*command, "--quiet").exit_code == 0 and Results(folder).status == "done"
    assert Results(folder).case.geometry.a == 1.0


# ------------------------------------------------------------------------------------------ case.resolved.toml


def test_results_of_a_case_that_was_changed_are_refused(run: Path) -> None:
    expected = Results(run).summary["case_hash"]
    edit_case(run, "friction_deg = 33.0\ndilatancy_deg = 0.0\ncohesion = 0.0\n", "friction_deg = 20.0\n")
    for command in (*READERS, "run"):
        source = ("coarse-channel", *(f"--set={value}" for value in TINY), "--out") if command == "run" else ()
        refused = invoke(command, *source, run)
        assert refused.exit_code == 5, command
        assert f"{run / 'case.resolved.toml'}: this is not the case that was simulated" in refused.stderr
        assert f"expected {expected} as in result.json; restore the file from a copy, or run the case" in refused.stderr


def test_results_of_the_same_simulation_are_read(run: Path) -> None:
    """With another title, which does not matter, and results that have no hash."""
    edit_case(run, 'title = "', 'title = "Another ')
    assert invoke("measure", run).exit_code == 0
    edit_case(run, "cfl = 0.5", "cfl = 0.4")
    assert invoke("measure", run).exit_code == 5
    change_result(run, lambda result: result.pop("case_hash"))
    assert invoke("measure", run).exit_code == 0


def test_a_hash_of_another_version_is_accepted_if_the_file_is_unchanged(run: Path) -> None:
    change_result(run, lambda result: result.update(case_hash="0" * 12))
    assert invoke("measure", run).exit_code == 0
    write_checksums(run, {"case.resolved.toml": "0" * 64})
    assert invoke("measure", run).exit_code == 5


def test_the_case_of_a_resumed_run_is_the_simulated_one(tmp_path: Path) -> None:
    case = small_case("plane")
    with pytest.raises(Interrupted):
        simulate(case, tmp_path, max_wall=0.0)
    assert Results(tmp_path).case == case
    results = simulate(case, tmp_path)
    assert results.summary["resumed"] and Results(tmp_path).case == case


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        (b"[geometry]\nradius = \n", "case.resolved.toml:2: not valid TOML"),
        (b"[geometry]\nradius = 1.0\n", "case.resolved.toml:1: [geometry] model is missing"),
        (b"\xff", "case.resolved.toml:1: not valid UTF-8"),
        (b"", "case.resolved.toml: "),
    ],
)
def test_a_damaged_case_is_a_damaged_file(run: Path, content: bytes, problem: str) -> None:
    (run / "case.resolved.toml").write_bytes(content)
    for command in (*READERS, "status"):
        refused = invoke(command, run)
        assert refused.exit_code == 5 and problem in refused.stderr and refused.stderr.count("\n") == 1, command
        assert refused.stderr.endswith("restore it from a copy, or run the case again with --fresh\n")
        assert "nothing was run" not in refused.stderr


# -------------------------------------------------------------------------------------------------- mpmcol verify


def test_verify_reports_a_result_that_was_removed(run: Path) -> None:
    (run / "result.json").unlink()
    done = invoke("verify", run)
    assert done.exit_code == 5 and "  result.json: it is missing; restore it from a copy" in done.stdout
    assert done.stdout.startswith(f"{run}: DAMAGED, 1 of 9 files\n") and "no checkpoint yet" not in done.stdout


@pytest.mark.parametrize("also", ["run.log", "SHA256SUMS"])
def test_verify_accepts_what_a_process_that_was_killed_leaves(run: Path, also: str) -> None:
    """A new run removes the log, the result and the checksums in this order; without them a run has not ended."""
    for name in ("result.json", also):
        (run / name).unlink()
    done = invoke("verify", run)
    assert done.exit_code == 0 and ": intact, " in done.stdout and "of an unfinished run" in done.stdout


def test_verify_accepts_a_stopped_run_without_its_result(tmp_path: Path) -> None:
    """A process that was killed while it resumed the run or wrote its result."""
    with pytest.raises(Interrupted):
        simulate(small_case("plane"), tmp_path, max_wall=0.0)
    (tmp_path / "result.json").unlink()
    assert (tmp_path / "SHA256SUMS").exists()
    done = invoke("verify", tmp_path)
    assert done.exit_code == 0 and ", of an unfinished run; repeat its command to resume" in done.stdout


@pytest.mark.parametrize("content", [b"xx", b"\xff\xfe", b"a  b\nc\n", b""])
def test_verify_reports_a_damaged_list_of_checksums_in_words(run: Path, content: bytes) -> None:
    (run / "SHA256SUMS").write_bytes(content)
    done = invoke("verify", run)
    wrong = "SHA256SUMS: it is damaged (the checksum in its last line is missing or does not match)"
    assert done.exit_code == 5 and wrong in done.stdout


# ------------------------------------------------------------------------------------------------- missing folders


@pytest.mark.parametrize(("command", "kinds"), [
    ("measure", "a run"), ("plot", "a run"), ("render", "a run"),
    ("status", "a run, a sweep or a study"), ("verify", "a run, a sweep or a study"),
])  # fmt: skip
def test_commands_name_what_they_take(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: str, kinds: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("runs/quickstart").mkdir(parents=True)
    refused = invoke(command, "quickstart").stderr
    assert f"expected the results folder of {kinds}. Did you mean {Path('runs/quickstart')}?\n" in refused


def test_a_folder_that_never_existed_is_not_gone(tmp_path: Path) -> None:
    refused = invoke("plan", "coarse-channel", "--accuracy", "5%", "--apply", tmp_path / "none/new.toml")
    assert refused.exit_code == 5
    assert f"there is no folder {tmp_path / 'none'}; create it, or choose another one" in refused.stderr
