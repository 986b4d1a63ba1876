"""The same option means the same in all commands, and finished work is shown, not repeated."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path
from types import SimpleNamespace

import click
import pytest

from mpmcol.cli import COMMANDS, main
from mpmcol.cli.options import DURATION
from mpmcol.setup import cores
from tests.support.cli import invoke, set_options
from tests.support.runs import TINY

CASES = Path(__file__).parents[2] / "cases"
SHARED = ("--set", "--aspect", "--accuracy", "--fresh", "--jobs", "--threads", "--dry-run")
OWN_FORM = {("bench", "--threads"), ("render", "--out"), ("report", "--out")}  # a list of numbers; files


def options(name: str) -> dict[str, click.Option]:
    command = main.get_command(click.Context(main), name)
    assert isinstance(command, click.Command)
    return {option.opts[-1]: option for option in command.params if isinstance(option, click.Option)}


def commands_with(option: str) -> list[str]:
    return [name for name in COMMANDS if option in options(name) and (name, option) not in OWN_FORM]


@pytest.mark.parametrize("option", SHARED)
def test_a_shared_option_has_one_form_and_one_help_text(option: str) -> None:
    found = [options(name)[option] for name in commands_with(option)]
    assert len(found) > 1
    assert len({(one.help, one.metavar, one.is_flag, one.multiple, repr(one.type)) for one in found}) == 1


def test_json_is_a_flag_and_out_a_folder_everywhere() -> None:
    assert all(options(name)["--json"].is_flag for name in commands_with("--json"))
    assert {options(name)["--out"].metavar for name in commands_with("--out")} == {"DIR"}


def test_commands_that_run_simulations_share_their_options() -> None:
    for name in ("run", "sweep", "fit", "paper", "validate", "stability", "pareto"):
        assert {"--out", "--fresh", "--jobs", "--json", "--quiet"} <= set(options(name)), name
    for name in ("run", "sweep", "fit", "check", "plan"):
        assert {"--set", "--aspect"} <= set(options(name)), name


@pytest.mark.parametrize("name", [None, *COMMANDS])
def test_no_line_of_the_help_is_cut_or_longer_than_80_columns(name: str | None) -> None:
    lines = invoke(*([name] if name else []), "--help").stdout.splitlines()
    assert max(map(len, lines)) <= 80
    assert not [line for line in lines if line.endswith("...") and not line.startswith("Usage:")]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("run", "coarse-channel", "--aspect", "1,2"), "mpmcol sweep runs several"),
        (("check", "coarse-channel", "--aspect", "2", "--set", "geometry.aspect=3"), "are the same value"),
        (("run", "coarse-channel", "--jobs", "2"), "--jobs applies to several runs"),
        (("measure", str(Path(__file__).parent), "--json", "--csv"), "two forms of the same result"),
        (("run", "coarse-channel", "--aspect", "2", "--aspect", "3"), "is given 2 times: 2, 3; give one value"),
        (("check", "coarse-channel", "--set", "time.cfl=0.4", "--set", "time.cfl=0.3"), "time.cfl is given twice"),
        (("run", "coarse-channel", "--aspect", "abc"), "'--aspect': 'abc': not a number with a unit"),
        (("run", "coarse-channel", "--fresh", "--force-resume"), "give one of them"),
        (("run", "coarse-channel", "--requeue-code", "0"), "0 has another meaning"),
        (("run", "channel", "--accuracy", "5"), "did you mean 5%?"),
        (
            ("run", "cylinder", "--accuracy", "20%", "--set", "grid.spacing=0.02", "--dry-run"),
            "remove --set grid.spacing=0.02, or --accuracy",
        ),
        (("sweep", "--aspect", "1", "--dry-run", "--engine", "commands"), "remove --engine commands"),
        (("pareto", str(CASES / "channel.toml")), "channel.toml is a case file; expected the TOML file of a study"),
        (("stability", "--map", str(CASES / "channel.toml")), "expected the TOML file of a map"),
        (("explain", "quickstart"), "quickstart is a shipped case, not a key; mpmcol init quickstart prints it"),
        (("init", str(CASES / "channel.toml")), "is a file already"),
        (("bench", "--per-axis", "4"), "expected at most 3 with all three models"),
        (("bench", "--model", "plane", "--per-axis", "5"), "expected at most 4"),
        (("bench", "--against", "missing.json"), "missing.json: cannot be read: No such file"),
        (("fit", "channel", "--to", "zeta=1.3+-0", "--vary", "material.friction_deg=20:40"), "standard error > 0"),
        (("run", "coarse-channel", "--max-wall", "1:00"), "2h, 1.5d or 01:30:00"),
    ],
)
def test_contradictions_are_refused(arguments: tuple[str, ...], message: str) -> None:
    result = invoke(*arguments)
    assert (result.exit_code, result.stdout) == (2, "") and message in result.stderr


def test_aspect_sets_the_aspect_ratio() -> None:
    assert "a = 2.5" in invoke("check", "coarse-channel", "--aspect", "2.5").stdout


@pytest.fixture
def repeated(finished: Path, tmp_path: Path) -> Path:
    """A copy of a finished run, in a folder whose name has a space."""
    return shutil.copytree(finished, tmp_path / "my run")


def test_a_finished_run_is_shown_and_not_repeated(repeated: Path) -> None:
    before = {path: path.stat().st_mtime_ns for path in repeated.rglob("*")}
    command = ("run", "coarse-channel", *set_options(TINY), "--out", repeated)
    shown = invoke(*command)
    assert shown.exit_code == 0, shown.output
    assert "zeta, front_height" in shown.stdout and "runout " in shown.stdout  # table and judgement
    assert f"next: mpmcol plot '{repeated}', mpmcol render '{repeated}'" in shown.stdout
    assert "holds the finished run of this case: nothing to compute" in shown.stderr
    record = invoke(*command, "--json")
    assert record.exit_code == 0 and json.loads(record.stdout) == json.loads((repeated / "result.json").read_text())
    assert {path: path.stat().st_mtime_ns for path in repeated.rglob("*")} == before


@pytest.mark.parametrize("changed", ["time.cfl=0.4", "output.snapshots=4"])
def test_a_finished_run_of_another_case_is_kept(repeated: Path, changed: str) -> None:
    refused = invoke("run", "coarse-channel", *set_options((*TINY, changed)), "--out", repeated)
    assert (refused.exit_code, refused.stdout) == (2, "")
    key, _, value = changed.partition("=")
    assert re.search(rf"another case:\n  {key}: .* in the finished run, {value} in this case\n", refused.stderr)
    assert "use --fresh to replace it, or --out for another folder" in refused.stderr


def test_a_finished_run_of_another_version_is_noted(repeated: Path) -> None:
    path = repeated / "result.json"
    record = json.loads(path.read_text())
    record["versions"]["mpmcol"] = "0.0.1+00000000"
    path.write_text(json.dumps(record))
    shown = invoke("run", "coarse-channel", *set_options(TINY), "--out", repeated)
    assert shown.exit_code == 0 and "note: computed by mpmcol 0.0.1+00000000" in shown.stderr


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ((), "coarse-channel"),
        (("--aspect", "3"), "coarse-channel-a3"),
        (("--set", "grid.spacing=15 mm", "--set", "method.transfer=apic"), "coarse-channel-spacing15mm-transfer-apic"),
        (("--set", "material.friction_deg=30.5"), "coarse-channel-friction30.5deg"),
    ],
)
def test_the_default_folder_is_named_by_what_it_holds(
    arguments: tuple[str, ...], name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    started: list[Path] = []

    def stop(case: object, folder: Path, **_: object) -> None:
        started.append(folder)
        raise KeyboardInterrupt

    monkeypatch.setattr("mpmcol.simulation.run.run", stop)
    invoke("run", "coarse-channel", *arguments)
    assert started == [Path("runs") / name]


@pytest.mark.parametrize("extra", [(), ("--dry-run",)])
def test_more_threads_than_cores_are_noted(
    extra: tuple[str, ...], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(cores, "available_cores", lambda: 1)
    done = invoke("run", "coarse-channel", *set_options(TINY), "--threads", 2, "--out", str(tmp_path / "r"), *extra)
    assert done.exit_code == 0 and "note: 2 threads on 1 core: no faster than 1; omit --threads" in done.stderr


@pytest.mark.parametrize(
    ("text", "seconds"), [("90", 90.0), ("1.5d", 129600.0), ("01:30:05", 5405.0), ("2-00:00:01", 172801.0)]
)
def test_durations(text: str, seconds: float) -> None:
    assert DURATION.convert(text, None, None) == seconds


@pytest.mark.parametrize("text", ["0", "00:00:00", "1:00", "1:2:3", "-1s", "1h30m", "nan", "1-2"])
def test_other_durations_are_refused(text: str) -> None:
    with pytest.raises(click.BadParameter, match="expected a time > 0"):
        DURATION.convert(text, None, None)


@pytest.mark.parametrize("command", [("run", "coarse-channel"), ("sweep", "coarse-channel", "--aspect", "1")])
@pytest.mark.parametrize("name", ["file", "file/run", "a" * 300])
def test_a_dry_run_refuses_a_folder_that_cannot_be(command: tuple[str, ...], name: str, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    refused = invoke(*command, "--dry-run", "--out", tmp_path / name)
    assert refused.exit_code == 5 and "cannot be written" in refused.stderr


def test_a_dry_run_notes_results_larger_than_the_disk(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shutil, "disk_usage", lambda path: SimpleNamespace(free=1000))
    assert "note: the results need about" in invoke("run", "coarse-channel", *set_options(TINY), "--dry-run").stdout


def test_a_dry_run_refuses_the_folder_of_another_run_and_notes_a_finished_one(repeated: Path, tmp_path: Path) -> None:
    command = ("run", "coarse-channel", *set_options(TINY), "--dry-run", "--out")
    assert "holds the finished run of this case" in invoke(*command, repeated).stderr
    other = invoke(*command, repeated, "--set", "time.cfl=0.4")
    assert other.exit_code == 2 and "holds a finished run of another case" in other.stderr
    assert invoke(*command, repeated, "--set", "time.cfl=0.4", "--fresh").exit_code == 0
    (tmp_path / "notes.txt").touch()
    assert "is not empty and holds no run" in invoke(*command, tmp_path).stderr
