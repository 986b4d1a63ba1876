"""Commands on case files, the help, and errors: exit codes, stdout and stderr, never a traceback."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

import mpmcol
from mpmcol.case import load_case, shipped_cases
from mpmcol.cli import COMMANDS, GROUPS, main
from tests.support.cli import invoke

pytestmark = pytest.mark.usefixtures("in_empty_folder")

ROOT = Path(mpmcol.__file__).parents[1]


def test_check_of_a_valid_case() -> None:
    result = invoke("check", "lube-channel", "--set", "geometry.aspect=5")
    assert result.exit_code == 0
    assert result.stdout.startswith("lube-channel: no problems.")
    assert "a = 5" in result.stdout and "elastic base of 0.02 m" in result.stdout and result.stderr == ""
    assert "rigid floor" in invoke("check", "quickstart").stdout
    assert re.search(r"\nabout [\d,]+ steps of [\d,]+ material points; ", result.stdout)


def test_check_notes_values_rounded_to_the_grid() -> None:
    result = invoke("check", "coarse-channel", "--set", "grid.spacing=0.0031")
    assert result.exit_code == 0
    count = result.stdout.count("\nnote: ")
    assert count > 1 and result.stdout.startswith(f"coarse-channel: no problems, {count} notes. ")
    assert "h = 0.00310345 m" in result.stdout
    assert "note: grid.spacing became 0.00310345 m" in result.stdout
    resolved = invoke("check", "coarse-channel", "--set", "grid.spacing=0.0031", "--resolved")
    assert "note: grid.spacing became" in resolved.stderr and "note:" not in resolved.stdout


def test_check_refuses_a_domain_that_is_too_small_for_its_column() -> None:
    radius = load_case("coarse-channel").geometry.r_i
    result = invoke("check", "coarse-channel", "--set", f"geometry.domain_length={1.01 * radius}")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "too small for the column, 0.09 m: its last 5 cells are not usable" in result.stderr
    length = result.stderr.partition(" set ")[2].partition(" m")[0]
    result = invoke("check", "coarse-channel", "--set", f"geometry.domain_length={length}")
    assert result.exit_code == 0 and "domain_length" not in result.output


def test_check_of_an_empty_name() -> None:
    result = invoke("check", "")
    assert result.exit_code == 2
    assert "expected the path of a case file or the name of a shipped case" in result.stderr


def test_a_name_without_its_extension_is_corrected() -> None:
    Path("folder").mkdir()
    Path("folder/mine.toml").write_text(invoke("init", "coarse-channel").stdout)
    Path("folder/child.toml").write_text('extends = "mine"\n')
    assert 'did you mean "mine.toml"?' in invoke("check", "folder/child.toml").stderr
    assert 'did you mean "folder/mine.toml"?' in invoke("check", "folder/mine").stderr
    assert 'did you mean "folder/mine.toml"?' in invoke("check", r"folder\mine.toml").stderr
    assert 'did you mean "folder/mine.toml"?' in invoke("check", "folder/mine.yaml").stderr
    assert 'did you mean "folder/child.toml" or "folder/mine.toml"?' in invoke("check", "folder").stderr


def test_check_of_an_invalid_case_exits_with_2() -> None:
    Path("my.toml").write_text("[grid]\nspacng = 1\n")
    result = invoke("check", "my.toml")
    assert (result.exit_code, result.stdout) == (2, "")
    assert 'my.toml:2: [grid] unknown key "spacng"' in result.stderr
    assert "problems; nothing was run." in result.stderr.strip().split("\n")[-1]
    assert "Traceback" not in result.output


def test_check_prints_only_the_resolved_case_on_stdout() -> None:
    result = invoke("check", "coarse-channel", "--resolved")
    Path("resolved.toml").write_text(result.stdout)
    assert load_case("resolved.toml") == load_case("coarse-channel")
    assert "no problems" in result.stderr


def test_cases_lists_name_and_title() -> None:
    lines = invoke("cases").stdout.splitlines()
    assert [line.split()[0] for line in lines] == list(shipped_cases())
    assert all(load_case(line.split()[0]).title in line for line in lines)


@pytest.mark.parametrize("name", shipped_cases())
def test_init_prints_a_complete_file(name: str) -> None:
    result = invoke("init", name)
    Path("my.toml").write_text(result.stdout)
    assert load_case("my.toml") == load_case(name)


def test_init_of_an_unknown_case_suggests_the_nearest() -> None:
    result = invoke("init", "quikstart")
    assert (result.exit_code, result.stdout) == (2, "")
    assert 'Did you mean "quickstart"?' in result.stderr


def test_explain() -> None:
    assert "a number > 0, in m; required" in invoke("explain", "grid.spacing").stdout
    assert "[geometry]" in invoke("explain").stdout
    result = invoke("explain", "grid.spacng")
    assert (result.exit_code, result.stdout) == (2, "")
    assert 'Did you mean "grid.spacing"?' in result.stderr


def test_check_names_the_line_of_a_column_that_is_too_soft() -> None:
    Path("soft.toml").write_text('schema = 1\nextends = "channel"\n[material]\nyoungs_modulus = "1 kPa"\n')
    result = invoke("check", "soft.toml")
    assert result.exit_code == 2 and result.stderr.startswith("soft.toml:4: material.youngs_modulus = 1000 Pa: the ela")
    assert "more than a third" in result.stderr and "set 3.2e+06 Pa or more" in result.stderr
    result = invoke("check", "soft.toml", "--set", "geometry.gravity=981")
    assert result.stderr.startswith("--set geometry.gravity=981: geometry.gravity = 981 m/s2 is 100 times")


WALLS = """[method]
wall_impulse = true
[geometry]
base = "rigid"
{}
[[walls]]
name = "a"
from = 0.3
to = 0.4
height = 0.1
[[walls]]
name = "b"
from = {}
to = {}
height = 0.1"""


@pytest.mark.parametrize(
    ("text", "line", "message", "remedy"),
    [
        ("[grid]\nspacing = 1e-9", 4, "grid.spacing = 1e-09 m: ", "increase grid.spacing"),
        ("[geometry]\ndomain_length = 0.1", 4, "geometry.domain_length = 0.1 m is too small", "or omit it"),
        (WALLS.format("", 0.405, 0.45), 13, "walls a and b are 1 cell of 0.005 m apart", "move one of them"),
        (WALLS.format("domain_length = 0.5", 0.45, 0.6), 13, "wall b: from = 0.45 m, to = 0.6 m: outside", "move the"),
        (
            "[geometry]\noutline = [[0, 0], [1, 0], [0.1, 0.01], [0, 0.1]]\n[grid]\nspacing = 0.02",
            4,
            "geometry.outline is thinner",
            "omit",
        ),
    ],
)
def test_check_names_the_line_of_what_cannot_be_run(text: str, line: int, message: str, remedy: str) -> None:
    Path("unfit.toml").write_text(f'schema = 1\nextends = "coarse-channel"\n{text}\n')
    result = invoke("check", "unfit.toml")
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr.startswith(f"unfit.toml:{line}: {message}")
    assert remedy in result.stderr.partition("^ ")[2]
    assert invoke("run", "unfit.toml", "--out", "runs/unfit").stderr == result.stderr
    assert not list(Path("runs/unfit").glob("[!.]*"))


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("repose", ("repose_angle_deg", "friction_from_repose_deg")),
        ("angle of repose", ("repose_angle_deg",)),
        ("dilatancy angle", ("material.dilatancy_deg", "base_material.dilatancy_peak_deg")),
    ],
)
def test_explain_finds_words_of_names_and_meanings(text: str, found: tuple[str, ...]) -> None:
    result = invoke("explain", text)
    assert result.exit_code == 0 and all(f"\n  {name}\n" in result.stdout for name in found)
    assert "grid.spacing" not in result.stdout


def test_explain_of_an_unknown_word_names_the_nearest_name_in_results() -> None:
    result = invoke("explain", "zetta")
    assert result.exit_code == 2 and 'there is no key or name "zetta". Did you mean "zeta"?' in result.stderr


def test_explain_finds_percentiles_without_their_number_and_adds_the_key_of_the_case() -> None:
    number, friction = (invoke("explain", name).stdout for name in ("I", "mu"))
    assert "flow.I_p5" in number and "flow.I_median" in number and "flow.I_p95" in number and "mu_" not in number
    assert "flow.mu_p95" in friction and "material.friction_deg" in friction and "mu_s" in friction
    assert "pressure_p99" in invoke("explain", "pressure").stdout


def test_schema_is_json() -> None:
    assert json.loads(invoke("schema").stdout)["title"] == "mpmcol case"


def test_an_unknown_command_suggests_the_nearest() -> None:
    result = invoke("chek", "coarse-channel")
    assert result.exit_code == 2
    assert 'Did you mean "check"?' in result.stderr


def test_version() -> None:
    assert invoke("--version").stdout == f"mpmcol, version {mpmcol.__version__}\n"


def test_every_command_exists_and_help_lists_it_with_its_summary() -> None:
    listed = invoke("--help").stdout
    for name in COMMANDS:
        command = main.get_command(click.Context(main), name)
        assert isinstance(command, click.Command) and command.help
        assert re.search(rf"^  {name} +{re.escape(command.help.splitlines()[0])}$", listed, re.MULTILINE), name
    assert re.findall(r"^(\w.*):$", listed, re.MULTILINE) == ["Options", *GROUPS]


@pytest.mark.parametrize("name", COMMANDS)
def test_every_option_has_a_help_text(name: str) -> None:
    command = main.get_command(click.Context(main), name)
    assert isinstance(command, click.Command)
    for option in command.params:
        assert isinstance(option, click.Argument) or option.help, option.name


def break_case_loading(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object) -> None:
        raise ZeroDivisionError("no such luck")

    monkeypatch.setattr("mpmcol.case.load_case", broken)


def test_a_bug_writes_a_crash_report(monkeypatch: pytest.MonkeyPatch) -> None:
    break_case_loading(monkeypatch)
    result = invoke("check", "coarse-channel")
    assert result.exit_code == 1
    report = Path("crash-report.txt")
    assert str(report.resolve()) in result.stderr and "Traceback" not in result.stderr
    for part in ("ZeroDivisionError: no such luck", "Traceback", "numpy ", "Python 3"):
        assert part in report.read_text()


def test_crash_report_goes_to_the_temporary_folder_if_it_must(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    break_case_loading(monkeypatch)
    Path("crash-report.txt").mkdir()
    other = tmp_path / "elsewhere"
    other.mkdir()
    monkeypatch.setattr("tempfile.gettempdir", lambda: str(other))
    assert invoke("check", "coarse-channel").exit_code == 1
    assert "ZeroDivisionError" in (other / "crash-report.txt").read_text()


@pytest.mark.parametrize("no_color", ["1", ""])
def test_no_color_is_honoured(monkeypatch: pytest.MonkeyPatch, no_color: str) -> None:
    @click.command()
    def coloured() -> None:
        click.secho("text", fg="red")

    monkeypatch.setattr(main, "get_command", lambda ctx, name: coloured)
    monkeypatch.setenv("NO_COLOR", no_color)
    result = CliRunner().invoke(main, ["check"], color=True)
    assert ("\x1b" in result.stdout) == (no_color == "")


def test_help_imports_no_large_packages() -> None:
    code = "import sys; from mpmcol.cli import *; [main.get_command(None, name) for name in COMMANDS]"
    done = subprocess.run(
        [sys.executable, "-c", f"{code}; print(*sys.modules)"], capture_output=True, text=True, cwd=ROOT
    )
    assert done.returncode == 0, done.stderr
    heavy = {"numba", "pydantic", "numpy", "h5py", "pyvista", "matplotlib"}
    assert heavy & set(done.stdout.split()) == set()


@pytest.mark.parametrize(
    ("setting", "hint"),
    [
        ("aspect=2", 'did you mean "geometry.aspect"?'),
        ("friction_deg=30", 'did you mean "material.friction_deg"?'),
        ("spacing=0.004", 'did you mean "grid.spacing"?'),
    ],
)
def test_an_override_without_its_table_is_completed(setting: str, hint: str) -> None:
    assert hint in invoke("check", "coarse-channel", "--set", setting).stderr


def test_a_key_without_its_table_is_moved() -> None:
    Path("short.toml").write_text('schema = 1\nextends = "channel"\nfriction_deg = 30\n')
    assert "move this key to [material]" in invoke("check", "short.toml").stderr


def test_keys_of_an_array_that_the_case_does_not_have_are_refused() -> None:
    problem = invoke("check", "coarse-channel", "--set", "walls.0.height=1").stderr
    assert "the case has no walls whose keys could be set" in problem and "write [[walls]] in its file" in problem


def test_an_empty_folder_name_is_refused() -> None:
    result = invoke("run", "coarse-channel", "--out", "")
    assert result.exit_code == 2 and "'--out': expected a path, not an empty text" in result.stderr
