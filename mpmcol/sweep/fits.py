"""Power laws fitted to runout and height over the aspect ratio, on each side of the published laws' transitions."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from functools import cache
from math import inf
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from mpmcol.experiments import Experiment
from mpmcol.io.atomic import atomic_write
from mpmcol.measure import FRONTS

SLOPES_FILE = "slopes.csv"
QUANTITIES = (*(f"zeta.{front}" for front in FRONTS), "beta")
CONFIDENCE = 0.95
FEWEST = 2
_ANGLES = 200_001  # of the quadrature of Student's distribution


@dataclass(frozen=True)
class PowerFit:
    """y = prefactor x**exponent; without uncertainty, None, where two points leave none to be seen."""

    prefactor: float
    exponent: float
    standard_error: float | None  # of the exponent
    half_width: float | None  # of its 95 % interval


@dataclass(frozen=True)
class Slope:
    """A quantity fitted over aspect ratios lo <= a < hi, and what the experiment's law has there."""

    series: str  # what else was varied; "" if nothing
    quantity: str
    lo: float
    hi: float
    count: int  # points
    prefactor: float
    exponent: float
    standard_error: float | None
    half_width: float | None
    law: str
    law_exponent: float | None

    @property
    def front(self) -> str:
        """The front's definition, "" for a quantity that has none."""
        return self.quantity.partition(".")[2]

    def __str__(self) -> str:
        width = "" if self.half_width is None else f" +- {self.half_width:.2f}"
        law = "" if self.law_exponent is None else f", law {self.law_exponent:.2f}"
        where = f"{self.count} points in {self.lo:g} <= a < {self.hi:g}"
        return f"{self.quantity} ~ a^{self.exponent:.2f}{width} ({where}{law})"


def fit_power(x: ArrayLike, y: ArrayLike) -> PowerFit:
    """Least-squares line through log y over log x, both (n,) and above 0, n >= 2, not all x equal.

    The 95 % interval of the exponent is Student's with n - 2 degrees of freedom: it holds if the logarithms scatter
    normally and alike, and tells nothing of an error that all points share.
    """
    u, w = np.log(np.asarray(x, dtype=float)), np.log(np.asarray(y, dtype=float))
    spread = float(np.sum((u - u.mean()) ** 2))
    exponent = float(np.sum((u - u.mean()) * (w - w.mean())) / spread)
    residual = w - w.mean() - exponent * (u - u.mean())
    prefactor, freedom = float(np.exp(w.mean() - exponent * u.mean())), len(u) - 2
    if freedom == 0:
        return PowerFit(prefactor, exponent, None, None)
    error = float(np.sqrt(np.sum(residual**2) / freedom / spread))
    return PowerFit(prefactor, exponent, error, error * student(freedom))


@cache
def student(freedom: int) -> float:
    """Half the width of the 95 % interval of Student's distribution, in standard errors.

    With t = sqrt(n) tan(angle) its density is cos(angle)**(n - 1), which is summed here.
    """
    angle = np.linspace(-np.pi / 2.0, np.pi / 2.0, _ANGLES)
    density = np.cos(angle) ** (freedom - 1)
    total = np.concatenate([[0.0], np.cumsum(density[1:] + density[:-1])])
    return float(np.sqrt(freedom) * np.tan(np.interp((1.0 + CONFIDENCE) / 2.0, total / total[-1], angle)))


def fit_slopes(rows: Sequence[Mapping[str, Any]], experiment: Experiment, series: str = "") -> list[Slope]:
    """Every quantity over the aspect ratio, in each range of the experiment's law, or over all without a law.

    Points that did not come to rest are left out, and so are values that have no logarithm.
    """
    rest = [row for row in rows if row.get("at_rest")]
    return [slope for quantity in QUANTITIES for slope in _slopes(rest, quantity, experiment, series)]


def slopes_text(slopes: Sequence[Slope]) -> str:
    """The slopes as CSV."""
    text = io.StringIO()
    writer = csv.DictWriter(text, [field.name for field in fields(Slope)], lineterminator="\n")
    writer.writeheader()
    writer.writerows(asdict(slope) for slope in slopes)
    return text.getvalue()


def write_slopes(out: Path, slopes: Sequence[Slope]) -> Path:
    """Write slopes.csv whole."""
    atomic_write(out / SLOPES_FILE, slopes_text(slopes).encode())
    return out / SLOPES_FILE


def _slopes(rows: list[Mapping[str, Any]], quantity: str, experiment: Experiment, series: str) -> Iterator[Slope]:
    law = experiment.law(quantity.partition(".")[0])
    ranges: list[tuple[float, float, float | None]] = [(0.0, inf, None)]
    if law and law.pieces:
        ranges = [(piece.lo, piece.hi, piece.exponent) for piece in law.pieces]
    for lo, hi, exponent in ranges:
        found = [(row["a"], row[quantity]) for row in rows if lo <= row["a"] < hi and (row[quantity] or 0.0) > 0.0]
        if len({a for a, _ in found}) < FEWEST:
            continue
        fit = fit_power(*zip(*found, strict=True))
        yield Slope(series, quantity, lo, hi, len(found), **asdict(fit), law=experiment.name, law_exponent=exponent)
