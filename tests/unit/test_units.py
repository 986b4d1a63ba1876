"""Quantities: units, bounds, and invalid values."""

from __future__ import annotations

import math

import pytest
from pydantic import ValidationError

from mpmcol.units import FACTORS, Table, option, pressure_text, quantity, to_unit


class Sample(Table):
    length: float = quantity("a length", "m", gt=0)
    angle: float = quantity("an angle", "deg", 33.0, ge=0, lt=90)
    speed: float = quantity("a speed", "m/s", math.inf, gt=0, allow_inf=True)
    share: float = quantity("a share", "", 1.0, ge=0, le=1)
    depth: float | None = quantity("an optional length", "m", None, gt=0)
    friction: float | None = quantity("a coefficient", "", None, ge=0, le=10, is_tangent=True)
    flag: bool = option("a flag", True)


def message(**values: object) -> str:
    with pytest.raises(ValidationError) as raised:
        Sample.model_validate({"length": 1.0, **values})
    return "; ".join(error["msg"] for error in raised.value.errors())


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("2 mm", "m", 0.002),
        ("2mm", "m", 0.002),
        (" -1.5e1 cm ", "m", -0.15),
        ("300 ms", "s", 0.3),
        ("10 MPa", "Pa", 1e7),
        ("1.7 kPa", "Pa", 1700.0),
        ("0.2 GPa", "Pa", 2e8),
        ("2.65 g/cm3", "kg/m3", 2650.0),
        ("33 deg", "deg", 33.0),
        ("50 cm/s", "m/s", 0.5),
        ("9.81 m/s2", "m/s2", 9.81),
        ("95 %", "", 0.95),
        ("7", "m", 7.0),
    ],
)
def test_a_string_with_a_unit_is_converted(text: str, unit: str, value: float) -> None:
    assert to_unit(text, unit) == value


def test_radians_and_degrees_are_converted() -> None:
    assert to_unit("1 rad", "deg") == pytest.approx(57.29577951308232, rel=1e-14)
    assert to_unit("180 deg", "rad") == pytest.approx(math.pi, rel=1e-14)


@pytest.mark.parametrize("unit", FACTORS)
def test_a_unit_converts_to_itself_exactly(unit: str) -> None:
    assert to_unit(f"0.1 {unit}", unit) == 0.1


@pytest.mark.parametrize(
    ("text", "unit", "reason"),
    [
        ("2 deg", "m", '"deg" cannot be converted'),
        ("2 furlong", "m", r'unknown unit "furlong" \(known: m, mm, cm\)'),
        ("2 m m", "m", "not a number"),
        ("two", "m", "not a number"),
        ("", "m", "not a number"),
        ("nan m", "m", "not a number"),
        ("2 Mm", "m", "unknown unit"),
        ("16 kN/m3", "kg/m3", '"kN/m3" is a unit weight; the density is that over g: "1631 kg/m3"'),
        ("16 kN/m3", "Pa", "unknown unit"),
    ],
)
def test_an_invalid_string_is_reported_with_the_reason(text: str, unit: str, reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        to_unit(text, unit)


def test_integers_floats_and_strings_are_accepted() -> None:
    sample = Sample.model_validate({"length": 2, "angle": "0.5 rad", "speed": "20 mm/s", "depth": "1 mm"})
    assert (sample.length, sample.speed, sample.depth) == (2.0, 0.02, 0.001)
    assert isinstance(sample.length, float)
    assert sample.angle == pytest.approx(28.64788975654116)


@pytest.mark.parametrize("value", [True, [1.0], {}, math.nan, math.inf, -math.inf, 0, -1, 10**400, "inf m"])
def test_an_invalid_length_is_reported_with_what_was_expected(value: object) -> None:
    assert "expected a number > 0, in m" in message(length=value)


def test_none_is_accepted_for_optional_keys_only() -> None:
    assert "valid number" in message(length=None)
    assert Sample(length=1, depth=None).depth is None


@pytest.mark.parametrize(("value", "fits"), [(0, True), (89.999, True), (90, False), (-1e-9, False)])
def test_declared_bounds_are_checked(value: float, fits: bool) -> None:
    if fits:
        assert Sample(length=1, angle=value).angle == value
    else:
        assert message(angle=value) == "expected a number >= 0 and < 90, in deg"


def test_an_angle_stands_for_its_tangent_where_a_coefficient_is_expected() -> None:
    values = {"22 deg": 0.40402622583515, "0.5 rad": math.tan(0.5), "0.4": 0.4, "40 %": 0.4}
    for text, value in values.items():
        assert Sample.model_validate({"length": 1, "friction": text}).friction == pytest.approx(value, rel=1e-13)
    expected = 'expected a number >= 0 and <= 10, or an angle such as "22 deg"'
    assert message(friction="89 deg") == message(friction=-1) == expected
    assert message(friction="2 mm") == f'"mm" cannot be converted to rad (known: deg, °, rad); {expected}'


def test_infinity_is_accepted_only_where_allowed() -> None:
    assert Sample(length=1, speed=math.inf).speed == math.inf
    assert message(speed=math.nan) == "expected a number > 0, or inf, in m/s"
    assert message(speed=-math.inf) == "expected a number > 0, or inf, in m/s"


def test_bounds_apply_after_conversion() -> None:
    assert Sample.model_validate({"length": 1, "share": "100 %"}).share == 1.0
    assert message(share="101 %") == "expected a number >= 0 and <= 1"


def test_unknown_keys_and_assignment_are_errors() -> None:
    with pytest.raises(ValidationError, match="Extra inputs"):
        Sample.model_validate({"length": 1, "lenght": 1})
    with pytest.raises(ValidationError, match="frozen"):
        Sample(length=1).length = 2.0


def test_stresses_are_in_kpa_from_one_kpa_on() -> None:
    assert [pressure_text(value) for value in (0.0, 50.0, 999.0, 1e3, 12345.6)] == [
        "0 Pa", "50 Pa", "999 Pa", "1 kPa", "12.35 kPa",
    ]  # fmt: skip


def test_a_number_is_not_a_boolean() -> None:
    assert "boolean" in message(flag=1)
