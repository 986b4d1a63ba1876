"""Invalid input ends in a message with its location: small random samples, and cases found by larger ones."""

from __future__ import annotations

import time
from functools import partial
from pathlib import Path

import pytest

from mpmcol.case import load_case
from mpmcol.case.values import leaf_values
from mpmcol.errors import CaseError
from mpmcol.studies.pareto.study import load_study
from mpmcol.units import LARGEST, SMALLEST, to_unit
from tests.soak.trials import case_values, command_lines, mutated_files
from tests.support.bad_input import failure_in_reading, find_failure
from tests.support.cli import invoke

pytestmark = pytest.mark.usefixtures("in_empty_folder")

DEEP, LONG = 30_000, 30_000
PARSED_OPTIONS = ("--checkpoint", "--max-wall", "--accuracy")


def refusal(text: str) -> str:
    """The message of `load_case` for an invalid file; it must take little time and memory."""
    path = Path("my.toml")
    path.write_text(text)
    assert find_failure(lambda: failure_in_reading(path)) is None
    with pytest.raises(CaseError) as refused:
        load_case(path)
    return str(refused.value)


# --- small random samples


@pytest.mark.parametrize(("trials", "count"), [(mutated_files, 600), (case_values, 500), (command_lines, 60)])
def test_a_small_sample(trials, count: int, tmp_path: Path) -> None:
    wrong = {}
    for seed in range(count):
        folder = tmp_path / str(seed)
        folder.mkdir()
        if found := trials.trial(seed, folder):
            wrong[seed] = found
    assert wrong == {}


def test_find_failure_reports_errors_memory_and_time() -> None:
    """Without this test, a `find_failure` that accepts everything would go unnoticed."""
    assert find_failure(lambda: f"{1 / 0}").splitlines()[-1] == "ZeroDivisionError: division by zero"
    assert "MemoryError" in find_failure(lambda: str(len(bytearray(2**31))))
    assert "takes 0." in find_failure(_slowly, longest=0.1)


def _slowly() -> None:
    end = time.process_time() + 0.2
    while time.process_time() < end:
        pass


# --- cases found by large samples


@pytest.mark.parametrize("name", ["a", '"a"', "'a'", r'"\""'])
@pytest.mark.parametrize("shape", ["[{}]", "{} = 1", "q = {{ {} = 1 }}"])
def test_keys_with_many_parts_take_little_memory(name: str, shape: str) -> None:
    assert "my.toml:2: a key has too many parts" in refusal("\n" + shape.format(".".join([name] * DEEP)))


@pytest.mark.parametrize("depth", [21, 100, 330, DEEP])
@pytest.mark.parametrize("ends", [("[", "]"), ("{a=", "}")])
def test_deep_nesting_is_reported_with_its_line(depth: int, ends: tuple[str, str]) -> None:
    text = f"a = 1\nb = {ends[0] * depth}1{ends[1] * depth}\n"
    assert "my.toml:2: arrays or tables are nested too deeply" in refusal(text)


def test_a_long_integer_is_reported_with_its_line() -> None:
    for digits in ("9" * 20, "9" * 5000, "0x" + "f" * 20):
        assert "my.toml:3: integer with more than 64 bits" in refusal(f"a = 1\n[q]\nb = {digits}\n")


@pytest.mark.parametrize("item", ["k{} = 1\n", "[t{}]\n", "[grid.t{}]\n"])
def test_many_problems_take_little_time(item: str) -> None:
    assert "1000 problems or more" in refusal("".join(map(item.format, range(10_000))))


def test_many_unknown_keys_hide_no_invalid_value() -> None:
    keys = "".join(f"k{k} = 1\n" for k in range(2000))
    assert "1000 problems or more" in refusal(f"[grid]\n{keys}[[stages.collapse.damping]]\n")


def test_many_invalid_items_take_little_time() -> None:
    assert "1000 problems or more" in refusal(f"[output]\ntimes = [{'[],' * LONG}]")


@pytest.mark.parametrize("text", ["1" * LONG + " m m", "1" + " " * LONG + "m m", "." * LONG, " " * LONG + "x"])
def test_long_texts_are_not_numbers(text: str) -> None:
    def convert() -> None:
        with pytest.raises(ValueError, match="not a number with a unit"):
            to_unit(text, "m")

    assert find_failure(convert) is None
    given = (
        ["sweep", "--aspect", f"{text}:2"],
        *(["run", "coarse-channel", option, text] for option in PARSED_OPTIONS),
    )
    for arguments in given:
        codes: list[int] = []
        assert find_failure(partial(_note_code, codes, arguments)) is None
        assert set(codes) == {2}, arguments[:-1]


def _note_code(codes: list[int], arguments: list[str]) -> None:
    codes.append(invoke(*arguments).exit_code)


def test_numbers_beyond_any_quantity_are_refused() -> None:
    """Their products would overflow: E = 1e308 would give a time step of zero and a run that never ends."""
    for value in ("1e308", "1e31", "1e-31", "5e-324"):
        problem = only_problem(f"material.youngs_modulus={value}")
        assert "magnitude not between 1e-30 and 1e+30; expected a number > 0, in Pa" in problem
    for value in (LARGEST, SMALLEST):
        assert leaf_values(load_case("coarse-channel", [f"material.density={value}"]))["material.density"] == value
    assert load_case("coarse-channel", ["stages.gate_speed=inf"]).stages.gate_speed == float("inf")


def test_friction_angles_near_90_degrees_are_refused() -> None:
    for angle in ("89.9999999999", "89.1"):
        assert "and <= 89, in deg" in only_problem(f"material.friction_deg={angle}")


def only_problem(override: str) -> str:
    with pytest.raises(CaseError) as refused:
        load_case("coarse-channel", [override])
    (problem,) = refused.value.problems
    return str(problem)


@pytest.mark.parametrize("text", ["a = " + "[" * DEEP, "a = " + "9" * 5000, "a = \0", ".".join(["a"] * DEEP) + " = 1"])
def test_studies_are_parsed_like_cases(text: str) -> None:
    Path("my.toml").write_text(text)

    def load() -> None:
        with pytest.raises(CaseError, match="my.toml:1: "):
            load_study("my.toml")

    assert find_failure(load) is None


FIT = ("fit", "quickstart", "--to", "zeta=1", "--vary", "material.friction_deg=20:40", "--dry-run")


@pytest.mark.parametrize(
    "command",
    [
        ("run",), ("check",), ("plan",), ("sweep", "--aspect", "1,2"), ("pareto",), ("stability", "--map"),
        ("check", "quickstart", "--set", "geometry.outline=large"), (*FIT, "--profile"), ("bench", "--against"),
    ],
    ids=" ".join,
)  # fmt: skip
def test_no_file_of_a_user_is_read_without_limit(command: tuple[str, ...]) -> None:
    """It may be a device that has no end."""
    with Path("large").open("wb") as file:
        file.truncate(20_000_000)
    assert "larger than" in invoke(*command, *([] if "large" in command[-1] else ["large"])).stderr


def test_measurements_are_not_read_without_limit(finished: Path) -> None:
    with Path("large").open("wb") as file:
        file.truncate(20_000_000)
    assert "larger than" in invoke("plot", str(finished), "--points", "large").stderr


def test_an_unknown_study_is_refused() -> None:
    assert "no such study" in invoke("pareto", "x" * 5000).stderr


@pytest.mark.parametrize("command", ["status", "measure", "plot", "render", "run", "sweep"])
def test_a_path_that_the_system_rejects_is_reported(command: str) -> None:
    path = "x" * 5000
    if command in ("run", "sweep"):
        result = invoke(command, "coarse-channel", "--out", path, *(("--aspect", "1") if command == "sweep" else ()))
    else:
        result = invoke(command, path)
    assert result.exit_code == 5 and "File name too long" in result.stderr and len(result.stderr) < 6000


@pytest.mark.parametrize(
    "arguments",
    [
        ("render", "run", "--size", "9" * 5000 + "x300"),
        ("bench", "--points", "9" * 5000),
        ("bench", "--threads", "1," + "9" * 5000),
        ("bench", "--points", "9" * 12),  # more than the memory
        ("run", "coarse-channel", "--threads", "100000"),
        ("sweep", "--aspect", "1,2", "--threads", "100000"),
        ("sweep", "--aspect", "1,2", "--jobs", "9" * 30),
        ("check", "coarse-channel", "--set", "title=\udcff"),
    ],
)
def test_counts_out_of_bounds_are_refused(arguments: tuple[str, ...]) -> None:
    result = invoke(*arguments)
    assert result.exit_code == 2 and len(result.stderr) < 1000, result.output


def test_file_names_may_have_any_encoding() -> None:
    Path("\udcff.toml").write_text('extends = "coarse-channel"\n')
    result = invoke("check", "\udcff.toml")
    assert result.exit_code == 0 and result.stdout.startswith(r"\udcff.toml: no problems")
