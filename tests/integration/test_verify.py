"""mpmcol verify: no changed byte of a run that has ended goes unseen, and what is whole is not blamed."""

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
from tests.support.cli import invoke
from tests.support.runs import TINY


@pytest.fixture
def run(finished: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(finished, tmp_path / "run"))


@pytest.fixture
def killed(run: Path) -> Path:
    """Without a result and without digests, as a signal 9 leaves it."""
    for name in ("result.json", "SHA256SUMS"):
        (run / name).unlink()
    return run


def change(path: Path, how: Callable[[h5py.File], None]) -> None:
    with h5py.File(path, "r+") as file:
        how(file)


def damaged(folder: Path) -> dict[str, str]:
    (report,) = verify(folder)
    return {finding.file: finding.what for finding in report.findings if finding.is_damage}


def test_a_whole_run_is_sound(run: Path) -> None:
    done = invoke("verify", run)
    assert (done.exit_code, done.output) == (0, f"{run}: sound, 10 files\n")
    invoke("plot", run)
    assert json.loads(invoke("verify", run, "--json").stdout) == {
        "schema": 1,
        "sound": True,
        "folders": [{"folder": str(run), "state": "done", "files": 13, "findings": [], "sound": True}],
    }


def test_every_changed_byte_is_found(run: Path) -> None:
    """In each file at many places, the first and the last of them too."""
    rng = np.random.default_rng(7)
    for path in [path for path in run.rglob("*") if path.is_file() and path.name != ".lock"]:
        content = path.read_bytes()
        for place in (0, len(content) - 1, *rng.integers(len(content), size=10)):
            changed = bytearray(content)
            changed[place] ^= 1 << rng.integers(8)
            path.write_bytes(changed)
            assert list(damaged(run)) == [path.relative_to(run).as_posix()], place
        path.write_bytes(content)
    assert not damaged(run)


def test_what_is_wrong_is_told_with_its_remedy(run: Path) -> None:
    (run / "snapshots/000001.vtkhdf").write_bytes(b"")
    (run / "history.csv").unlink()
    shutil.copy(run / "snapshots/000000.vtkhdf", run / "snapshots/000007.vtkhdf")
    (run / "front.png").write_bytes(b"no picture")
    (run / ".history.csv.12.tmp").touch()
    done = invoke("verify", run)
    again = f"copy it back, or run it again: mpmcol run {run}/case.resolved.toml --out {run} --fresh"
    assert done.exit_code == 5
    heading, *lines = done.output.splitlines()
    assert heading == f"{run}: DAMAGED, 4 of 12 files"
    assert lines[:3] == [
        f"  history.csv: it is missing; {again}",
        f"  snapshots/000001.vtkhdf: its bytes are not those that the run wrote; {again}",
        "  snapshots/000007.vtkhdf: it is not of this run; delete it",
    ]
    assert lines[3].startswith("  front.png: it cannot be read") and lines[3].endswith("plot or render again")
    assert lines[4].startswith("  .history.csv.12.tmp: a process was killed while it wrote this; delete it")
    assert invoke(*again.partition("mpmcol ")[2].split(), "--quiet").exit_code == 0
    assert not damaged(run)


def test_a_damaged_index_is_written_again_as_it_is_told(run: Path) -> None:
    (run / "run.vtkhdf").write_bytes(b"")
    (finding,) = verify(run)[0].findings
    assert finding.file == "run.vtkhdf" and "write_index(Path(" in finding.remedy
    write_index(run)
    assert not damaged(run)


def test_without_digests_nothing_can_be_vouched_for(run: Path) -> None:
    (run / "SHA256SUMS").unlink()
    assert list(damaged(run)) == ["SHA256SUMS"]


@pytest.mark.skipif(not shutil.which("sha256sum"), reason="needs sha256sum")
def test_the_digests_are_read_by_others(run: Path) -> None:
    subprocess.run(["sha256sum", "--check", "--strict", "SHA256SUMS"], cwd=run, check=True, capture_output=True)


def test_an_unfinished_run_is_looked_into(killed: Path) -> None:
    report = verify(killed)[0]
    assert report.is_sound and report.state == "unfinished"
    assert "no state yet" in report.findings[0].what


@pytest.mark.parametrize(
    "number, change_it, what",
    [
        (1, lambda f: f["VTKHDF/PointData/stress"].write_direct(np.full((264, 6), np.nan, "f4")),
         "numbers in stress are not finite"),
        (2, lambda f: f["mpmcol/time"].write_direct(np.array(-1.0)), "is before that of the one before"),
        (0, lambda f: f["VTKHDF/PointData/id"].write_direct(np.zeros(264, "i4")), "missing or twice in it"),
        (3, lambda f: f["VTKHDF/PointData"].move("id", "no"), "it lacks 'id'"),
    ],
)  # fmt: skip
def test_in_it_snapshots_that_cannot_be_true_are_found(
    killed: Path, number: int, change_it: Callable, what: str
) -> None:
    name = f"snapshots/{number:06d}.vtkhdf"
    change(killed / name, change_it)
    found = damaged(killed)
    assert list(found) == [name] and what in found[name]


def test_in_it_other_files_that_cannot_be_true_are_found(killed: Path) -> None:
    history = (killed / "history.csv").read_text().splitlines(keepends=True)
    (killed / "history.csv").write_text("".join([*history[:-2], *history[:-3:-1]]))
    (killed / "case.resolved.toml").write_text("[geometry]\n")
    (killed / "run.vtkhdf.series").write_text('{"files": [{"name": "snapshots/000009.vtkhdf", "time": 0}]}')
    found = damaged(killed)
    assert found["history.csv"] == "its times do not increase"
    assert found["case.resolved.toml"].startswith("it is no case: ")
    assert "names other snapshots than there are" in found["run.vtkhdf"]


def test_states_are_checked_by_their_own_digests(tmp_path: Path) -> None:
    case = mpmcol.load_case("quickstart", TINY)
    with pytest.raises(Interrupted):
        mpmcol.run(case, tmp_path, max_wall=0.0)
    assert invoke("verify", tmp_path).output.startswith(f"{tmp_path}: sound, 8 files, of a run that was stopped;")
    state = tmp_path / CHECKPOINT_FILES[1]
    state.write_bytes(state.read_bytes()[:-1])
    assert "the same command begins anew" in invoke("verify", tmp_path).output
    mpmcol.run(case, tmp_path)
    assert verify(tmp_path)[0].state == "done" and not damaged(tmp_path)


def test_a_run_that_goes_on_is_left_alone(killed: Path) -> None:
    with locked(killed):
        done = invoke("verify", killed)
    assert done.exit_code == 0 and "not checked\n  .lock: a run is writing here; verify it when" in done.output


def test_folders_above_runs_are_gone_through(run: Path, finished: Path) -> None:
    shutil.copytree(finished, run.parent / "deeper" / "other")
    (run.parent / "table.csv").write_text("a,b\n1,2\n3\n")
    done = invoke("verify", run.parent)
    told = "it cannot be read (ValueError: its rows differ in length); delete it; the command that made it"
    assert done.exit_code == 5 and f"{run.parent}: DAMAGED, 1 of 1 file\n  table.csv: {told}" in done.output
    assert done.output.count(": sound, 10 files") == 2


def test_a_folder_without_runs_is_refused(tmp_path: Path) -> None:
    for folder in (tmp_path, tmp_path / "gone"):
        done = invoke("verify", folder)
        assert done.exit_code == 5 and "no run in it; expected the folder of a run" in done.output


def test_of_an_unfinished_run_states_vouch_for_snapshots(tmp_path: Path) -> None:
    class Killed(Exception):
        pass

    def kill(stage: str, share: float) -> None:
        if stage == "collapse" and share > 0.7:
            raise Killed

    with pytest.raises(Killed):
        mpmcol.run(mpmcol.load_case("quickstart", TINY), tmp_path, checkpoint_seconds=0.0, progress=kill)
    assert verify(tmp_path)[0].state == "unfinished" and not damaged(tmp_path)
    path = tmp_path / "snapshots/000001.vtkhdf"
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)
    assert list(damaged(tmp_path)) == ["snapshots/000001.vtkhdf"]
