"""The values of an axis, from their text."""

from __future__ import annotations

import pytest

from mpmcol.sweep.ranges import parse_values


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
def test_numbers_end_where_they_are_told_to(text: str, values: list[float]) -> None:
    assert [float(value) for value in parse_values(text)] == values


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("plane, axisymmetric", ("plane", "axisymmetric")),
        ("2 mm,4 mm", ("2 mm", "4 mm")),
        ("true,false", ("true", "false")),
        ("inf,0.5", ("inf", "0.5")),
        ("4,9", ("4", "9")),  # whole numbers stay whole: points_per_cell takes no 4.0
        ("4:16:12", ("4", "16")),
        ("1,1.0,0.5:1", ("1", "0.5")),  # every value once
        ("[0.1, 0.2],[0.3]", ("[0.1, 0.2]", "[0.3]")),
        ('"a, b: c",d', ('"a, b: c"', "d")),
        ("{ damping = 0.1, law = 'elastic' }", ("{ damping = 0.1, law = 'elastic' }",)),
    ],
)
def test_values_as_a_case_file_has_them(text: str, values: tuple[str, ...]) -> None:
    assert parse_values(text) == values


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        ("", "a value is missing"),
        ("1,,2", "a value is missing"),
        ("7:0.5", "7:0.5: a range must rise"),
        ("1:1", "a range must rise"),
        ("1:1e999", "a range must rise"),
        ("1:x", "1:x: expected LO:HI, LO:HI:STEP or LO:HI/COUNT"),
        ("1:2:3:4", "expected LO:HI"),
        ("1:2:0", "the step must be above 0"),
        ("1:2:-1", "the step must be above 0"),
        ("1:2/1", "a range has at least 2 values"),
        ("0.5:7:0.4", "not a whole number of steps of 0.4 long; give 0.5:6.9:0.4 or 0.5:7/17"),
        ("0.001:0.005", "give a smaller step or a count, such as 0.001:0.005/5"),
        ("0:1:1e-9", "1,000,000,001 values are too many"),
        ("0:1/99999999999999999999999", "values are too many"),
        ("0:1/6000,2:3/6000", "12,000 values are too many"),
    ],
)
def test_what_is_wrong_is_told(text: str, wrong: str) -> None:
    with pytest.raises(ValueError) as raised:
        parse_values(text)
    assert wrong in str(raised.value)


def test_all_that_is_wrong_is_told_at_once() -> None:
    with pytest.raises(ValueError, match="7:0.5: .*; 1:x: "):
        parse_values("7:0.5,3,1:x")
