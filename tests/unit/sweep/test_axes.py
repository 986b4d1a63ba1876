"""Values of an axis of a sweep, parsed from text."""

from __future__ import annotations

import pytest

from mpmcol.sweep.axes import parse_values


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("0.5:7", [0.5 * i for i in range(1, 15)]),
        ("0.5:7:0.25", [0.25 * i for i in range(2, 29)]),
        ("0.5:7/14", [0.5 * i for i in range(1, 15)]),
        ("1:2/3", [1, 1.5, 2]),
        ("0.55,0.9,1.7:3:0.1", [0.55, 0.9, 1.7, 1.8, 1.9, 2, 2.1, 2.2, 2.3, 2.4, 2.5, 2.6, 2.7, 2.8, 2.9, 3]),
        ("0.1:0.3:0.1", [0.1, 0.2, 0.3]),  # 0.1 + 2 * 0.1 is not 0.3 in binary
        ("-1:1:1", [-1, 0, 1]),
        ("1e-3:5e-3:1e-3", [0.001, 0.002, 0.003, 0.004, 0.005]),
    ],
)
def test_ranges_include_both_ends(text: str, values: list[float]) -> None:
    assert [float(value) for value in parse_values(text)] == values


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("plane, axisymmetric", ("plane", "axisymmetric")),
        ("2 mm,4 mm", ("2 mm", "4 mm")),
        ("true,false", ("true", "false")),
        ("inf,0.5", ("inf", "0.5")),
        ("4,9", ("4", "9")),  # integers stay integers: 4.0 is invalid for points_per_cell
        ("4:16:12", ("4", "16")),
        ("1,1.0,0.5:1", ("1", "0.5")),  # repeated values are dropped
        ("[0.1, 0.2],[0.3]", ("[0.1, 0.2]", "[0.3]")),
        ('"a, b: c",d', ('"a, b: c"', "d")),
        ("{ damping = 0.1, law = 'elastic' }", ("{ damping = 0.1, law = 'elastic' }",)),
    ],
)
def test_values_keep_the_text_of_a_case_file(text: str, values: tuple[str, ...]) -> None:
    assert parse_values(text) == values


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "a value is missing"),
        ("1,,2", "a value is missing"),
        ("7:0.5", "7:0.5: the end of a range must be greater than its start"),
        ("1:1", "the end of a range must be greater than its start"),
        ("1:1e999", "the end of a range must be greater than its start"),
        ("1-3", "1-3: expected LOW:HIGH"),
        ("1;3", "1;3: expected LOW:HIGH"),
        ("1:x", "1:x: expected LOW:HIGH, LOW:HIGH:STEP or LOW:HIGH/COUNT"),
        ("1:2:3:4", "expected LOW:HIGH"),
        ("1:2:0", "the step must be > 0"),
        ("1:2:-1", "the step must be > 0"),
        ("1:2/1", "a range has at least 2 values"),
        ("0.5:7:0.4", "not a whole number of steps of 0.4; give 0.5:6.9:0.4 or 0.5:7/17"),
        ("0.001:0.005", "give a smaller step or a count, for example 0.001:0.005/5"),
        ("0:1:1e-9", "1,000,000,001 values are too many"),
        ("0:1/99999999999999999999999", "values are too many"),
        ("0:1/6000,2:3/6000", "12,000 values are too many"),
    ],
)
def test_invalid_values_are_reported(text: str, message: str) -> None:
    with pytest.raises(ValueError) as raised:
        parse_values(text)
    assert message in str(raised.value)


def test_all_problems_are_reported_at_once() -> None:
    with pytest.raises(ValueError, match="7:0.5: .*; 1:x: "):
        parse_values("7:0.5,3,1:x")
