"""Power-law fits of runout and height over the aspect ratio, on each side of the transitions of the published laws."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from math import inf
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from mpmcol.experiments import Experiment
from mpmcol.io.atomic import atomic_write
from mpmcol.measure import FRONTS
from mpmcol.sweep.table import FINER_GRIDS, csv_text

SLOPES_FILE = "slopes.csv"
QUANTITIES = (*(f"zeta.{front}" for front in FRONTS), f"zeta.{FINER_GRIDS}", "beta", f"beta.{FINER_GRIDS}")
CONFIDENCE = 0.95
FEWEST = 2  # runs in a fit


@dataclass(frozen=True)
class PowerFit:
    """y = prefactor x**exponent; the uncertainty of a fit through two points is None."""

    prefactor: float
    exponent: float
    standard_error: float | None  # of the exponent
    half_width: float | None  # of its 95 % interval


@dataclass(frozen=True)
class Slope:
    """A quantity fitted over aspect ratios lo <= a < hi, and the exponent of the experiment's law there."""

    series: str  # values of the other keys that vary; "" if none does
    quantity: str
    lo: float
    hi: float
    count: int  # runs
    prefactor: float
    exponent: float
    standard_error: float | None
    half_width: float | None
    law: str
    law_exponent: float | None

    @property
    def front(self) -> str:
        """Definition of the front; "" for a quantity without one."""
        return self.quantity.partition(".")[2]

    def __str__(self) -> str:
        width = "" if self.half_width is None else f" +- {self.half_width:.2f}"
        law = "" if self.law_exponent is None else f", law {self.law_exponent:.2f}"
        where = f"{self.count} runs in {self.lo:g} <= a < {self.hi:g}"
        return f"{self.quantity} ~ a^{self.exponent:.2f}{width} ({where}{law})"


def fit_power(x: ArrayLike, y: ArrayLike) -> PowerFit:
    """Least-squares line through log y over log x, both (n,) and above 0, n >= 2, not all x equal.

    The 95 % interval of the exponent is that of Student's t distribution with n - 2 degrees of freedom. It assumes
    normally distributed errors of equal variance in the logarithms and excludes systematic errors.
    """
    u, w = np.log(np.asarray(x, dtype=float)), np.log(np.asarray(y, dtype=float))
    spread = float(np.sum((u - u.mean()) ** 2))
    exponent = float(np.sum((u - u.mean()) * (w - w.mean())) / spread)
    residual = w - w.mean() - exponent * (u - u.mean())
    prefactor, freedom = float(np.exp(w.mean() - exponent * u.mean())), len(u) - 2
    if freedom == 0:
        return PowerFit(prefactor, exponent, None, None)
    error = float(np.sqrt(np.sum(residual**2) / freedom / spread))
    return PowerFit(prefactor, exponent, error, error * student_t(freedom))


def student_t(freedom: int) -> float:
    """Half the width of the 95 % interval of Student's t distribution, in standard errors."""
    from scipy.special import stdtrit  # here, since it takes long to import

    return float(stdtrit(freedom, (1.0 + CONFIDENCE) / 2.0))


def fit_slopes(rows: Sequence[Mapping[str, Any]], experiment: Experiment, series: str = "") -> list[Slope]:
    """Fit every quantity over the aspect ratio, in each range of the experiment's law, or over all rows without a law.

    Rows that are not at rest and values that are not positive are excluded.
    """
    rest = [row for row in rows if row.get("at_rest")]
    known = [quantity for quantity in QUANTITIES if all(quantity in row for row in rest)]
    return [slope for quantity in known for slope in _slopes(rest, quantity, experiment, series)]


def write_slopes(out: Path, slopes: Sequence[Slope]) -> Path:
    """Write slopes.csv."""
    atomic_write(out / SLOPES_FILE, csv_text([asdict(slope) for slope in slopes]).encode())
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
