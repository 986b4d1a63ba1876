"""Fitted values of the unknowns, with standard errors, their parts by cause, and intervals."""

from __future__ import annotations

from dataclasses import dataclass

from mpmcol.studies.fit import Fit
from mpmcol.studies.fit.search import CAUSES

NOT_KNOWN = "not known"


@dataclass(frozen=True)
class FittedValue:
    """An unknown with its value, standard error, the parts of that by cause, and interval of 90 %.

    error, parts, interval: None if the error exceeds the range, or if no values reproduce the measurements. A part is
    None if it is not known. interval: within the range; of a value at an `end` ("low" or "high") of its range it is
    one-sided, with 95 %.
    """

    key: str
    unit: str
    low: float
    high: float
    value: float
    error: float | None
    parts: dict[str, float | None] | None
    interval: tuple[float, float] | None
    end: str | None
    is_reproduced: bool

    def __str__(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        if self.error is None or self.parts is None:
            reason = "not determined" if self.is_reproduced else "the nearest value, without a standard error"
            return f"{self.key} = {self.value:.4g}{unit}, {reason}"
        parts = ", ".join(
            f"{cause} {NOT_KNOWN if part is None else format(part, '.2g')}" for cause, part in self.parts.items()
        )
        return f"{self.key} = {self.value:.4g} +- {self.error:.2g}{unit} (standard error; {self._interval()}; {parts})"

    def _interval(self) -> str:
        low, high = self.interval or (self.low, self.high)
        if (low, high) == (self.low, self.high):
            return "90 %: the whole range"
        if self.end:
            return f"95 %, one-sided: {f'at most {high:.4g}' if self.end == 'low' else f'at least {low:.4g}'}"
        cut = ", cut to the range" if low == self.low or high == self.high else ""
        return f"90 %: {low:.4g} to {high:.4g}{cut}"


def fitted_values(fit: Fit) -> list[FittedValue]:
    """The unknowns, with the standard errors that the agreement with the measurements allows."""
    return [_fitted_value(fit, k) for k in range(len(fit.unknowns))]


def _fitted_value(fit: Fit, k: int) -> FittedValue:
    found, agreement, unknown = fit.solution.precision, fit.agreement, fit.unknowns[k]
    width, low, high = unknown.high - unknown.low, unknown.low, unknown.high
    value = low + float(fit.solution.shares[k]) * width
    end = ("low" if value < 0.5 * (low + high) else "high") if agreement.at_end[k] else None
    error, interval = None, None
    parts: dict[str, float | None] | None = None
    if found is not None and agreement.has_errors and agreement.scale * found.errors[k] < 1.0:
        factor = width * agreement.scale
        error = float(factor * found.errors[k])
        parts = {cause: float(factor * found.part(cause)[k]) for cause in CAUSES}
        parts["grid"] = parts["grid"] if fit.is_grid_known else None
        half = agreement.quantile * error
        interval = max(value - half, low), min(value + half, high)
    return FittedValue(
        unknown.key, unknown.unit, low, high, value, error, parts, interval, end, agreement.is_reproduced
    )
