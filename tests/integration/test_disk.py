"""What a failing disk, a damaged file and a clock that is set do to a run: never a loss that is not told."""

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
from mpmcol.simulation import restart
from tests.soak import damage, disks, writes
from tests.support.cli import invoke, set_options
from tests.support.faulty_disk import Disk, PowerLost
from tests.support.runs import TINY, assert_equal_runs


class Killed(Exception):
    """The end of a process, as far as a test can tell."""


@pytest.fixture
def killed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A run killed just after the first state that knows two snapshots; the state before knows one."""

    def write(folder: Path, state: Any) -> None:
        write_checkpoint(folder, state)
        if len(state.values["recorder"]["snapshots"]) == 2:
            raise Killed

    monkeypatch.setattr(restart, "write_checkpoint", write)
    with pytest.raises(Killed):
        mpmcol.run(mpmcol.load_case("quickstart", TINY), tmp_path / "run", checkpoint_seconds=0.0)
    monkeypatch.undo()
    return tmp_path / "run"


def resume(folder: Path, *more: str) -> Any:
    return invoke("run", "quickstart", *set_options(TINY), "--out", folder, *more)


@pytest.mark.parametrize("how", ["flip", "truncate", "remove"])
def test_with_a_damaged_snapshot_it_goes_on_from_the_state_before_it(killed: Path, how: str) -> None:
    snapshot = killed / "snapshots" / "000001.vtkhdf"
    content = snapshot.read_bytes()
    if how == "remove":
        snapshot.unlink()
    else:
        snapshot.write_bytes(content[:-1] if how == "truncate" else content[:-1] + bytes([content[-1] ^ 1]))
    done = resume(killed)
    assert done.exit_code == 0, done.output
    assert re.search(r"000001.vtkhdf is damaged or missing, and step \d+ needs it\ngoing on from step", done.output)
    assert snapshot.read_bytes() == content and not [f for r in verify(killed) for f in r.findings]


def test_with_a_damaged_snapshot_before_all_states_it_is_refused_with_the_remedy(killed: Path) -> None:
    snapshot = killed / "snapshots" / "000000.vtkhdf"
    content = snapshot.read_bytes()
    snapshot.write_bytes(content[:1000])
    refused = resume(killed)
    assert refused.exit_code == 5 and "copy it back, or begin anew with --fresh" in refused.output
    snapshot.write_bytes(content)  # nothing was lost by the refusal
    assert "going on from step" in resume(killed).output


def test_snapshots_after_the_state_are_taken_again_or_gone(killed: Path) -> None:
    """A run that goes on with fewer snapshots must not be measured on one that it did not take."""
    for name in ("000002", "000003", "000009"):
        (killed / "snapshots" / f"{name}.vtkhdf").write_bytes(b"of a course that was given up")
    done = resume(killed, "--force-resume", "--set", "output.snapshots=1")
    assert done.exit_code == 0 and len(Results(killed).snapshots) == 3
    assert not [finding for report in verify(killed) for finding in report.findings]


def test_a_state_of_another_format_is_refused(killed: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(restart, "FORMAT", 1)
    refused = resume(killed)
    assert refused.exit_code == 2 and "of another version's format; --fresh begins anew" in refused.output


def test_a_case_with_other_points_changes_nothing(killed: Path) -> None:
    before = {path: path.read_bytes() for path in killed.rglob("*") if path.is_file()}
    assert resume(killed, "--force-resume", "--set", "grid.points_per_cell=9").exit_code == 2
    assert before == {path: path.read_bytes() for path in killed.rglob("*") if path.is_file()}


def test_a_result_that_says_nothing_known_is_not_taken_for_an_unfinished_run(tmp_path: Path) -> None:
    assert resume(tmp_path).exit_code == 0
    result = tmp_path / "result.json"
    result.write_text(result.read_text().replace('"done"', '"dong"'))
    refused = resume(tmp_path)
    assert refused.exit_code == 5 and "its status is 'dong'; --fresh replaces the run" in refused.output
    assert resume(tmp_path, "--fresh").exit_code == 0


def test_what_told_the_end_is_gone_once_a_stopped_run_goes_on(tmp_path: Path) -> None:
    assert resume(tmp_path, "--max-wall", "0.001s").exit_code == 75
    disk = Disk(tmp_path)
    disk.then_at, seen = 10, []
    disk.then = lambda: seen.append(sorted(path.name for path in tmp_path.iterdir()))  # type: ignore[assignment]
    with disk.inserted():
        assert resume(tmp_path).exit_code == 0
    assert not {RESULT_FILE, CHECKSUM_FILE} & set(seen[0])


# ------------------------------------------------------------------------------------ small draws of promises


@pytest.mark.parametrize("seed", random.Random(11).sample(range(writes.COUNT), 6))
def test_any_moment_of_a_loss_of_power(seed: int, tmp_path: Path) -> None:
    assert writes.trial(seed, tmp_path) is None


@pytest.mark.parametrize("seed", random.Random(12).sample(range(disks.COUNT), 6))
def test_any_failing_disk(seed: int, tmp_path: Path) -> None:
    assert disks.trial(seed, tmp_path) is None


@pytest.mark.parametrize("seed", random.Random(13).sample(range(damage.COUNT), 25))
def test_any_damage(seed: int, tmp_path: Path) -> None:
    assert damage.trial(seed, tmp_path) is None


def test_what_was_not_forced_to_the_disk_is_lost(tmp_path: Path) -> None:
    """The failing disk can tell a program that relies on luck."""
    disk = Disk(tmp_path)
    disk.dies_at, disk.forgets_renames = 3, True
    (tmp_path / "b").write_bytes(b"old")
    with pytest.raises(PowerLost), disk.inserted():
        descriptor = os.open(tmp_path / "a", os.O_WRONLY | os.O_CREAT)
        os.write(descriptor, b"0123456789")
        os.close(descriptor)
        os.replace(tmp_path / "a", tmp_path / "b")
        assert (tmp_path / "b").read_bytes() == b"0123456789"
        os.unlink(tmp_path / "b")
    assert (tmp_path / "b").read_bytes() == b"old"


# ------------------------------------------------------------------------------------------- clocks that are set


def test_a_clock_that_is_set_forth_and_back_changes_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    case, draw, states = mpmcol.load_case("quickstart", TINY), random.Random(3), []

    def count(folder: Path, state: Any) -> None:
        states.append(state)

    mpmcol.run(case, tmp_path / "plain", threads=1)
    monkeypatch.setattr(time, "time", lambda: draw.uniform(-1e9, 1e10))
    monkeypatch.setattr(restart, "write_checkpoint", count)
    mpmcol.run(case, tmp_path / "set", threads=1, max_wall=600.0)
    assert not states
    assert_equal_runs(tmp_path / "plain", tmp_path / "set")
    mpmcol.run(case, tmp_path / "again", threads=1, checkpoint_seconds=0.0)
    assert len(states) > 10


def test_only_the_age_of_files_is_told_by_a_clock_that_may_be_set() -> None:
    package = Path(mpmcol.__file__).parent
    users = {
        path.relative_to(package).as_posix() for path in package.rglob("*.py") if "time.time()" in path.read_text()
    }
    assert users == {"mpm/jit.py", "io/run_status.py"}
