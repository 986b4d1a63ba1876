"""`mpmcol verify`: any changed byte of a completed run is found, and intact files are not reported."""

from __future__ import annotations

import json
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

import mpmcol
from mpmcol.errors import Interrupted
from mpmcol.integrity import verify
from mpmcol.io.lock import locked
from mpmcol.io.names import CHECKPOINT_FILES
from mpmcol.io.snapshot import write_index
from mpmcol.sweep.plan import PLAN_FILE
from tests.support.cli import invoke
from tests.support.runs import TINY


@pytest.fixture
def run(finished: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(finished, tmp_path / "run"))


@pytest.fixture
def killed(run: Path) -> Path:
    """Without result and checksums, as after SIGKILL."""
    for name in ("result.json", "SHA256SUMS"):
        (run / name).unlink()
    return run


def change(path: Path, how: Callable[[h5py.File], None]) -> None:
    with h5py.File(path, "r+") as file:
        how(file)


def damaged(folder: Path) -> dict[str, str]:
    (report,) = verify(folder)
    return {finding.file: finding.what for finding in report.findings if finding.is_damage}


def test_an_unchanged_run_is_intact(run: Path) -> None:
    done = invoke("verify", run)
    assert (done.exit_code, done.output) == (0, f"{run}: intact, 10 files\n")
    invoke("plot", run)
    assert json.loads(invoke("verify", run, "--json").stdout) == {
        "schema": 2,
        "intact": True,
        "folders": [{"folder": str(run), "status": "done", "files": 13, "findings": [], "intact": True}],
    }


def test_every_changed_byte_is_found(run: Path) -> None:
    """At many positions of each file, including the first and the last byte."""
    rng = np.random.default_rng(7)
    for path in [path for path in run.rglob("*") if path.is_file() and path.name not in (".lock", "run.log")]:
        content = path.read_bytes()
        for position in (0, len(content) - 1, *rng.integers(len(content), size=10)):
            changed = bytearray(content)
            changed[position] ^= 1 << rng.integers(8)
            path.write_bytes(changed)
            assert list(damaged(run)) == [path.relative_to(run).as_posix()], position
        path.write_bytes(content)
    assert not damaged(run)


def test_problems_are_reported_with_their_remedy(run: Path) -> None:
    (run / "snapshots/000001.vtkhdf").write_bytes(b"")
    (run / "history.csv").unlink()
    shutil.copy(run / "snapshots/000000.vtkhdf", run / "snapshots/000007.vtkhdf")
    (run / "front.png").write_bytes(b"no picture")
    (run / ".history.csv.12.tmp").touch()
    done = invoke("verify", run)
    again = f"restore it from a copy, or run the case again: mpmcol run {run}/case.resolved.toml --out {run} --fresh"
    assert done.exit_code == 5
    heading, *lines = done.output.splitlines()
    assert heading == f"{run}: DAMAGED, 4 of 12 files"
    assert lines[:3] == [
        f"  history.csv: it is missing; {again}",
        f"  snapshots/000001.vtkhdf: its checksum does not match; {again}",
        "  snapshots/000007.vtkhdf: it does not belong to this run; delete it",
    ]
    assert lines[3].startswith("  front.png: it cannot be read") and lines[3].endswith("plot or render again")
    assert lines[4].startswith("  .history.csv.12.tmp: a temporary file of a process that was killed; delete it")
    assert invoke(*again.partition("mpmcol ")[2].split(), "--quiet").exit_code == 0
    assert not damaged(run)


def test_a_damaged_index_can_be_written_again_as_advised(run: Path) -> None:
    (run / "run.vtkhdf").write_bytes(b"")
    (finding,) = verify(run)[0].findings
    assert finding.file == "run.vtkhdf" and "write_index(Path(" in finding.remedy
    write_index(run)
    assert not damaged(run)


def test_missing_checksums_are_reported(run: Path) -> None:
    (run / "SHA256SUMS").unlink()
    assert list(damaged(run)) == ["SHA256SUMS"]


@pytest.mark.skipif(not shutil.which("sha256sum"), reason="needs sha256sum")
def test_sha256sum_reads_the_checksums(run: Path) -> None:
    subprocess.run(["sha256sum", "--check", "--strict", "SHA256SUMS"], cwd=run, check=True, capture_output=True)


def test_an_unfinished_run_is_checked_by_its_content(killed: Path) -> None:
    report = verify(killed)[0]
    assert report.is_intact and report.status == "unfinished"
    assert "no checkpoint yet" in report.findings[0].what


@pytest.mark.parametrize(
    "number, change_it, what",
    [
        (1, lambda f: f["VTKHDF/PointData/stress"].write_direct(np.full((264, 6), np.nan, "f4")),
         "values of stress are not finite"),
        (2, lambda f: f["mpmcol/time"].write_direct(np.array(-1.0)), "precedes that of the previous snapshot"),
        (0, lambda f: f["VTKHDF/PointData/id"].write_direct(np.zeros(264, "i4")), "missing or duplicate particle ids"),
        (3, lambda f: f["VTKHDF/PointData"].move("id", "no"), "it lacks 'id'"),
    ],
)  # fmt: skip
def test_inconsistent_snapshots_of_an_unfinished_run_are_found(
    killed: Path, number: int, change_it: Callable, what: str
) -> None:
    name = f"snapshots/{number:06d}.vtkhdf"
    change(killed / name, change_it)
    found = damaged(killed)
    assert list(found) == [name] and what in found[name]


def test_other_inconsistent_files_of_an_unfinished_run_are_found(killed: Path) -> None:
    history = (killed / "history.csv").read_text().splitlines(keepends=True)
    (killed / "history.csv").write_text("".join([*history[:-2], *history[:-3:-1]]))
    (killed / "case.resolved.toml").write_text("[geometry]\n")
    (killed / "run.vtkhdf.series").write_text('{"files": [{"name": "snapshots/000009.vtkhdf", "time": 0}]}')
    found = damaged(killed)
    assert found["history.csv"] == "its times do not increase"
    assert found["case.resolved.toml"].startswith("it is not a valid case: ")
    assert "lists other snapshots than the folder holds" in found["run.vtkhdf"]


def test_checkpoints_are_checked_by_their_own_checksums(tmp_path: Path) -> None:
    case = mpmcol.load_case("coarse-channel", TINY)
    with pytest.raises(Interrupted):
        mpmcol.run(case, tmp_path, max_wall=0.0)
    assert invoke("verify", tmp_path).output.startswith(f"{tmp_path}: intact, 8 files, of a run that was stopped;")
    checkpoint = tmp_path / CHECKPOINT_FILES[1]
    checkpoint.write_bytes(checkpoint.read_bytes()[:-1])
    assert "restarts from scratch" in invoke("verify", tmp_path).output
    mpmcol.run(case, tmp_path)
    assert verify(tmp_path)[0].status == "done" and not damaged(tmp_path)


def test_a_running_run_is_not_checked(killed: Path) -> None:
    with locked(killed):
        done = invoke("verify", killed)
    assert done.exit_code == 0 and "not checked\n  .lock: a run is writing here; verify it after" in done.output


def test_all_runs_below_a_folder_are_checked(run: Path, finished: Path) -> None:
    shutil.copytree(finished, run.parent / "deeper" / "other")
    (run.parent / "table.csv").write_text("a,b\n1,2\n3\n")
    assert invoke("verify", run.parent).exit_code == 0  # a file of the user beside runs
    (run.parent / PLAN_FILE).write_text("{}")
    done = invoke("verify", run.parent)
    problem = "it cannot be read (ValueError: rows differ in length); delete it, and repeat the command that wrote it"
    assert done.exit_code == 5 and f"{run.parent}: DAMAGED, 1 of 2 files\n  table.csv: {problem}" in done.output
    assert done.output.count(": intact, 10 files") == 2


def test_a_folder_without_runs_is_refused(tmp_path: Path) -> None:
    for folder, message in ((tmp_path, "no run found"), (tmp_path / "gone", "no such folder")):
        done = invoke("verify", folder)
        assert done.exit_code == 5 and message in done.output and "folder of a run" in done.output


def test_checkpoints_reveal_changed_snapshots_of_an_unfinished_run(tmp_path: Path) -> None:
    class Killed(Exception):
        pass

    def kill(stage: str, share: float) -> None:
        if stage == "collapse" and share > 0.7:
            raise Killed

    with pytest.raises(Killed):
        mpmcol.run(mpmcol.load_case("coarse-channel", TINY), tmp_path, checkpoint_seconds=0.0, progress=kill)
    assert verify(tmp_path)[0].status == "unfinished" and not damaged(tmp_path)
    path = tmp_path / "snapshots/000001.vtkhdf"
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)
    assert list(damaged(tmp_path)) == ["snapshots/000001.vtkhdf"]
