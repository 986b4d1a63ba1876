"""Distributions of uncertain keys, as given by the text of an option such as "normal:33,1.5"."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import isfinite, log
from typing import Any

from mpmcol.units import Number, tangent, to_unit

EXPECTED = (
    "expected normal:MEAN,SD, lognormal:MEDIAN,FACTOR, uniform:LOW,HIGH or triangular:LOW,MODE,HIGH, "
    "for example normal:33,1.5"
)


@dataclass(frozen=True)
class Kind:
    """A kind of distribution.

    parameters: their names. units: of each one "value" (a value of the key), "difference" (of two values) or "factor".
    condition, rule: whether the parameters are valid, and that in words. freeze: makes the SciPy distribution.
    """

    parameters: tuple[str, ...]
    units: tuple[str, ...]
    condition: Callable[..., bool]
    rule: str
    freeze: Callable[..., Any]


def _normal(mean: float, deviation: float) -> Any:
    from scipy.stats import norm  # in functions, since it takes long to import

    return norm(mean, deviation)


def _lognormal(median: float, factor: float) -> Any:
    from scipy.stats import lognorm

    return lognorm(log(factor), scale=median)


def _uniform(low: float, high: float) -> Any:
    from scipy.stats import uniform

    return uniform(low, high - low)


def _triangular(low: float, mode: float, high: float) -> Any:
    from scipy.stats import triang

    return triang((mode - low) / (high - low), low, high - low)


KINDS = {
    "normal": Kind(("MEAN", "SD"), ("value", "difference"), lambda mean, sd: sd > 0.0, "SD > 0", _normal),
    "lognormal": Kind(
        ("MEDIAN", "FACTOR"),
        ("value", "factor"),
        lambda median, factor: median > 0.0 and factor > 1.0,
        "MEDIAN > 0 and FACTOR > 1 (68 % of the values are within MEDIAN/FACTOR to MEDIAN*FACTOR)",
        _lognormal,
    ),
    "uniform": Kind(("LOW", "HIGH"), ("value", "value"), lambda low, high: low < high, "LOW < HIGH", _uniform),
    "triangular": Kind(
        ("LOW", "MODE", "HIGH"),
        ("value", "value", "value"),
        lambda low, mode, high: low <= mode <= high and low < high,
        "LOW <= MODE <= HIGH and LOW < HIGH",
        _triangular,
    ),
}


@dataclass(frozen=True)
class Distribution:
    """A distribution of the values of a key, in the unit of the key."""

    kind: str  # a key of KINDS
    parameters: tuple[float, ...]

    def __str__(self) -> str:
        return f"{self.kind}:{','.join(f'{value:g}' for value in self.parameters)}"

    @property
    def frozen(self) -> Any:
        """The frozen distribution of scipy.stats."""
        return KINDS[self.kind].freeze(*self.parameters)

    @property
    def mean(self) -> float:
        """Its mean."""
        return float(self.frozen.mean())

    @property
    def standard_deviation(self) -> float:
        """Its standard deviation."""
        return float(self.frozen.std())

    def standardised(self, values: Any) -> Any:
        """Values minus mean over standard deviation; of a lognormal distribution, those of the logarithms."""
        import numpy as np

        if self.kind == "lognormal":
            median, factor = self.parameters
            return np.log(np.asarray(values) / median) / log(factor)
        return (np.asarray(values) - self.mean) / self.standard_deviation

    @property
    def standard(self) -> Any:
        """The frozen distribution of the standardised values."""
        if self.kind in ("normal", "lognormal"):
            return _normal(0.0, 1.0)
        return KINDS[self.kind].freeze(*map(float, self.standardised(self.parameters)))


def parse_distribution(text: str, number: Number) -> Distribution:
    """Read a text such as "normal:33,1.5" or "uniform:2 mm,3 mm" for a key.

    Args:
        number: unit and bounds of the key; parameters without a unit are in it. A factor has no unit.

    Raises:
        ValueError: with what was expected.
    """
    name, colon, rest = text.partition(":")
    kind = KINDS.get(name.strip())
    if not colon or kind is None:
        raise ValueError(EXPECTED)
    form = f"{name.strip()}:{','.join(kind.parameters)}"
    parts = rest.split(",")
    if len(parts) != len(kind.parameters):
        raise ValueError(f"expected {form} with {len(kind.parameters)} numbers, found {len(parts)}")
    values = tuple(
        _number(part, unit, number, f"{form}: {parameter}")
        for part, parameter, unit in zip(parts, kind.parameters, kind.units, strict=True)
    )
    if not kind.condition(*values):
        raise ValueError(f"expected {form} with {kind.rule}")
    return Distribution(name.strip(), values)


def _number(text: str, unit: str, number: Number, name: str) -> float:
    try:
        value = _converters(number)[unit](text.strip())
    except ValueError as error:
        raise ValueError(f'{name} = "{text.strip()}": {error}') from None
    if not isfinite(value):
        raise ValueError(f'{name} = "{text.strip()}": expected a finite number')
    return value


def _converters(number: Number) -> dict[str, Callable[[str], float]]:
    """How each kind of parameter is read; a difference of tangents cannot be given as an angle."""
    return {
        "value": tangent if number.is_tangent else lambda text: to_unit(text, number.unit),
        "difference": lambda text: to_unit(text, number.unit),
        "factor": lambda text: to_unit(text, ""),
    }
