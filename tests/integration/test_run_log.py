"""run.log, progress without a terminal, and `mpmcol status --follow`."""

from __future__ import annotations

import re
import shutil
import threading
from pathlib import Path

import pytest

import mpmcol
from mpmcol.cli import follow
from mpmcol.io.lock import locked
from mpmcol.io.run_log import ProgressLines, run_log
from mpmcol.io.run_status import resumed_at
from tests.support.cli import invoke, set_options
from tests.support.runs import TINY

LINE = re.compile(r"\d{4}-\d\d-\d\d \d\d:\d\d:\d\d (INFO|WARNING|ERROR) +\S")


def test_a_run_logs_its_stages_progress_and_warnings(finished: Path) -> None:
    lines = (finished / "run.log").read_text().splitlines()
    assert all(LINE.match(line) for line in lines), lines
    text = "\n".join(lines)
    for part in ("mpmcol 0.", "INFO    equilibrate", "INFO    release", "INFO    collapse 50 %", "INFO    done"):
        assert part in text
    assert re.search("WARNING the column still moved at the time limit", text)
    assert len(text) < 10_000
    assert invoke("verify", finished).exit_code == 0


def test_progress_without_a_terminal_is_lines_of_text(tmp_path: Path) -> None:
    done = invoke("run", "coarse-channel", *set_options(TINY), "--out", tmp_path / "run", "--json")
    assert done.exit_code == 0, done.output
    assert "\r" not in done.stderr and "\x1b" not in done.stderr
    assert re.search(r"^collapse 50 %, about \d+ s left$", done.stderr, re.MULTILINE)
    assert done.stdout.startswith("{") and done.stdout.count("\n") == 1
    quiet = invoke("run", "coarse-channel", *set_options(TINY), "--out", tmp_path / "run", "--fresh", "--quiet")
    assert (quiet.exit_code, quiet.output) == (0, "")
    assert (tmp_path / "run" / "run.log").read_text().count("INFO    done") == 1  # --fresh begins a new log


def test_a_resumed_run_appends_to_its_log(tmp_path: Path) -> None:
    case = mpmcol.load_case("coarse-channel", TINY)
    with pytest.raises(mpmcol.errors.Interrupted):
        mpmcol.run(case, tmp_path / "run", max_wall=1e-6)
    log = tmp_path / "run" / "run.log"
    first = log.read_text()
    assert re.search("ERROR   stopped by the wall-clock limit at step", first)
    mpmcol.run(case, tmp_path / "run")
    assert log.read_text().startswith(first)
    assert re.search("INFO    resuming from step.*INFO    done", log.read_text().removeprefix(first), re.DOTALL)
    assert invoke("verify", tmp_path / "run").exit_code == 0


def test_one_line_for_each_stage_and_each_ten_per_cent() -> None:
    lines: list[str] = []
    progress = ProgressLines(lines.append)
    for stage in ("load: preparing kernels", "load", "flow"):
        for fraction in (0.0, 0.05, 0.1, 0.15, 0.35, 0.99, 1.0):
            progress(stage, fraction * (stage != "load: preparing kernels"))
    assert [line.partition(",")[0] for line in lines] == [
        "load: preparing kernels", "load 10 %", "load 30 %", "load 90 %", "flow", "flow 10 %", "flow 30 %", "flow 90 %"
    ]  # fmt: skip


def test_the_time_left_of_a_resumed_stage_follows_from_the_speed_since_then(monkeypatch: pytest.MonkeyPatch) -> None:
    """Half of the stage was done before: a tenth of it in 4 s leaves 16 s."""
    clock = iter([0.0, 100.0, 104.0, 108.0])
    monkeypatch.setattr("mpmcol.io.run_log.time.monotonic", lambda: next(clock))
    lines: list[str] = []
    progress = ProgressLines(lines.append)
    for fraction in (0.5, 0.6, 0.7):
        progress("flow", fraction)
    assert lines == ["flow", "flow 60 %, about 16 s left", "flow 70 %, about 12 s left"]


def test_the_first_fraction_of_a_resumed_run_is_that_of_its_checkpoint(tmp_path: Path) -> None:
    case = mpmcol.load_case("coarse-channel", TINY)
    seen: list[float] = []

    def collapse(stage: str, fraction: float) -> None:
        if stage == "collapse":
            seen.append(fraction)
            if fraction > 0.5:
                raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        mpmcol.run(case, tmp_path / "run", checkpoint_seconds=0.0, progress=collapse)
    assert seen[0] == 0.0
    reached, seen[:] = seen[-1], []
    with pytest.raises(KeyboardInterrupt):
        mpmcol.run(case, tmp_path / "run", progress=collapse)
    assert 0.4 < seen[0] <= reached
    end = mpmcol.run(case, tmp_path / "run").summary["time"]  # the limit of this collapse
    assert resumed_at(tmp_path / "run") == pytest.approx(seen[0] * end, rel=0.01)
    assert mpmcol.load_case(tmp_path / "run" / "case.resolved.toml") == case


def test_a_log_that_cannot_be_written_does_not_end_the_run(tmp_path: Path) -> None:
    (tmp_path / "run.log").symlink_to("/dev/full")
    if not Path("/dev/full").exists():
        pytest.skip("needs /dev/full")
    with run_log() as log:
        log.message("early")
        log.open(tmp_path)
        log.message("later")


STATES = [("done", 0, "1 done"), ("failed", 3, "1 failed"), ("stopped", 75, "1 stopped"), (None, 1, "1 unfinished")]


@pytest.mark.parametrize(("state", "code", "text"), STATES)
def test_follow_exits_with_the_code_of_the_state(
    finished: Path, tmp_path: Path, state: str | None, code: int, text: str
) -> None:
    folder = shutil.copytree(finished, tmp_path / "run")
    result = folder / "result.json"
    result.write_text(result.read_text().replace('"status": "done"', f'"status": "{state}"', 1))
    if state is None:
        result.unlink()
    followed = invoke("status", folder, "--follow")
    assert followed.exit_code == code and text in followed.stdout
    assert invoke("status", folder).exit_code == 0


def test_follow_waits_for_the_end_of_a_run(finished: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(follow, "INTERVAL", 0.01)
    folder = shutil.copytree(finished, tmp_path / "run")
    (folder / "result.json").rename(tmp_path / "result.json")
    begun, end = threading.Event(), threading.Event()

    def other() -> None:
        with locked(folder):
            begun.set()
            end.wait(60.0)
            (tmp_path / "result.json").rename(folder / "result.json")

    thread = threading.Thread(target=other)
    thread.start()
    begun.wait(60.0)
    readings: list[str] = []
    active = follow._active

    def spy(*arguments: object):
        for runs in active(*arguments):
            readings.append(runs[0].status.name)
            if len(readings) == 3:
                end.set()
            yield runs

    monkeypatch.setattr(follow, "_active", spy)
    followed = invoke("status", folder, "--follow", "--json")
    thread.join()
    assert followed.exit_code == 0 and readings[:3] == ["running"] * 3 and readings[-1] == "done"
    assert followed.stdout.startswith('{"schema"') and followed.stdout.count("\n") == 1
    assert "\r" not in followed.stderr and "100 %: 1 of 1 runs" in followed.stderr
