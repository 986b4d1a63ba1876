"""Failing disks, damaged files and changed clocks: no loss of data is left unreported."""

from __future__ import annotations

import os
import random
import re
import time
from pathlib import Path
from typing import Any

import pytest

import mpmcol
from mpmcol.integrity import verify
from mpmcol.io.checkpoint import write_checkpoint
from mpmcol.io.names import CHECKSUM_FILE, RESULT_FILE
from mpmcol.io.results import Results
from mpmcol.simulation import checkpointer, restart
from tests.soak.trials import damaged_files, failing_disks, power_loss
from tests.support.cli import invoke, set_options
from tests.support.faulty_disk import Disk, PowerLost
from tests.support.runs import TINY, assert_equal_runs


class Killed(Exception):
    """Raised in place of the end of the process."""


@pytest.fixture
def killed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A run killed after the first checkpoint that lists two snapshots; the previous checkpoint lists one."""

    def write(folder: Path, checkpoint: Any) -> None:
        write_checkpoint(folder, checkpoint)
        if len(checkpoint.values["recorder"]["snapshots"]) == 2:
            raise Killed

    monkeypatch.setattr(checkpointer, "write_checkpoint", write)
    with pytest.raises(Killed):
        mpmcol.run(mpmcol.load_case("coarse-channel", TINY), tmp_path / "run", checkpoint_seconds=0.0)
    monkeypatch.undo()
    return tmp_path / "run"


def resume(folder: Path, *more: str) -> Any:
    return invoke("run", "coarse-channel", *set_options(TINY), "--out", folder, *more)


@pytest.mark.parametrize("how", ["flip", "truncate", "remove"])
def test_with_a_damaged_snapshot_a_run_resumes_from_the_checkpoint_before_it(killed: Path, how: str) -> None:
    snapshot = killed / "snapshots" / "000001.vtkhdf"
    content = snapshot.read_bytes()
    if how == "remove":
        snapshot.unlink()
    else:
        snapshot.write_bytes(content[:-1] if how == "truncate" else content[:-1] + bytes([content[-1] ^ 1]))
    done = resume(killed)
    assert done.exit_code == 0, done.output
    assert re.search(
        r"000001.vtkhdf is damaged or missing; the checkpoint of step \d+ needs it\nresuming from step", done.output
    )
    assert snapshot.read_bytes() == content and not [f for r in verify(killed) for f in r.findings]


def test_with_a_damaged_snapshot_before_all_checkpoints_a_run_is_refused_with_the_remedy(killed: Path) -> None:
    snapshot = killed / "snapshots" / "000000.vtkhdf"
    content = snapshot.read_bytes()
    snapshot.write_bytes(content[:1000])
    refused = resume(killed)
    assert refused.exit_code == 5 and "restore it from a copy, or use --fresh to restart from scratch" in refused.output
    snapshot.write_bytes(content)  # the refusal has changed nothing
    assert "resuming from step" in resume(killed).output


def test_snapshots_after_the_checkpoint_are_written_again_or_removed(killed: Path) -> None:
    """A run resumed with fewer snapshots must not be measured on a snapshot that it did not write."""
    for name in ("000002", "000003", "000009"):
        (killed / "snapshots" / f"{name}.vtkhdf").write_bytes(b"of an abandoned run")
    fewer = set_options((*TINY, "output.snapshots=1"))
    done = invoke("run", "coarse-channel", *fewer, "--out", killed, "--force-resume")
    assert done.exit_code == 0 and len(Results(killed).snapshots) == 3
    assert not [finding for report in verify(killed) for finding in report.findings]


def test_a_checkpoint_of_another_format_is_refused(killed: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(restart, "FORMAT", 1)
    refused = resume(killed)
    assert (
        refused.exit_code == 2
        and "in the format of another version; use --fresh to restart from scratch" in refused.output
    )


def test_a_refused_case_with_other_points_changes_nothing(killed: Path) -> None:
    before = {path: path.read_bytes() for path in killed.rglob("*") if path.is_file()}
    assert resume(killed, "--force-resume", "--set", "grid.points_per_cell=9").exit_code == 2
    assert before == {path: path.read_bytes() for path in killed.rglob("*") if path.is_file()}


def test_a_result_of_unknown_status_is_not_replaced(tmp_path: Path) -> None:
    assert resume(tmp_path).exit_code == 0
    result = tmp_path / "result.json"
    result.write_text(result.read_text().replace('"done"', '"dong"'))
    refused = resume(tmp_path)
    assert refused.exit_code == 5 and "its status is 'dong', expected one of done, " in refused.output
    assert resume(tmp_path, "--fresh").exit_code == 0


def test_the_result_of_a_stopped_run_is_removed_when_it_resumes(tmp_path: Path) -> None:
    assert resume(tmp_path, "--max-wall", "0.001s").exit_code == 75
    disk = Disk(tmp_path)
    disk.callback_at, seen = 10, []
    disk.callback = lambda: seen.append(sorted(path.name for path in tmp_path.iterdir()))  # type: ignore[assignment]
    with disk.inserted():
        assert resume(tmp_path).exit_code == 0
    assert not {RESULT_FILE, CHECKSUM_FILE} & set(seen[0])


# ------------------------------------------------------------------------------------ random trials, a few of each


@pytest.mark.parametrize("seed", random.Random(11).sample(range(power_loss.COUNT), 6))
def test_loss_of_power_at_any_moment(seed: int, tmp_path: Path) -> None:
    assert power_loss.trial(seed, tmp_path) is None


@pytest.mark.parametrize("seed", random.Random(12).sample(range(failing_disks.COUNT), 6))
def test_any_failing_disk(seed: int, tmp_path: Path) -> None:
    assert failing_disks.trial(seed, tmp_path) is None


@pytest.mark.parametrize("seed", random.Random(13).sample(range(damaged_files.COUNT), 25))
def test_any_damage(seed: int, tmp_path: Path) -> None:
    assert damaged_files.trial(seed, tmp_path) is None


def test_the_simulated_disk_loses_what_was_not_synced(tmp_path: Path) -> None:
    """Otherwise the trials above could not fail."""
    disk = Disk(tmp_path)
    disk.power_fails_at, disk.undoes_renames = 3, True
    (tmp_path / "b").write_bytes(b"old")
    with pytest.raises(PowerLost), disk.inserted():
        descriptor = os.open(tmp_path / "a", os.O_WRONLY | os.O_CREAT)
        os.write(descriptor, b"0123456789")
        os.close(descriptor)
        os.replace(tmp_path / "a", tmp_path / "b")
        assert (tmp_path / "b").read_bytes() == b"0123456789"
        os.unlink(tmp_path / "b")
    assert (tmp_path / "b").read_bytes() == b"old"


# ------------------------------------------------------------------------------------------- changed clocks


def test_a_clock_set_forward_and_back_changes_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    case, draw, written = mpmcol.load_case("coarse-channel", TINY), random.Random(3), []

    def count(folder: Path, checkpoint: Any) -> None:
        written.append(checkpoint)

    mpmcol.run(case, tmp_path / "plain", threads=1)
    monkeypatch.setattr(time, "time", lambda: draw.uniform(-1e9, 1e10))
    monkeypatch.setattr(checkpointer, "write_checkpoint", count)
    mpmcol.run(case, tmp_path / "set", threads=1, max_wall=600.0)
    assert not written
    assert_equal_runs(tmp_path / "plain", tmp_path / "set")
    mpmcol.run(case, tmp_path / "again", threads=1, checkpoint_seconds=0.0)
    assert len(written) > 10


def test_the_system_clock_is_used_for_the_age_of_files_only() -> None:
    package = Path(mpmcol.__file__).parent
    users = {
        path.relative_to(package).as_posix() for path in package.rglob("*.py") if "time.time()" in path.read_text()
    }
    assert users == {"mpm/jit.py", "io/run_status.py"}
