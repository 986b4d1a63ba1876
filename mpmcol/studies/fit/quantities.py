"""Measurements that a fit can use: quantities of a deposit, their measured values, and how errors of the grid act."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from mpmcol.errors import UsageError
from mpmcol.io.results import Results
from mpmcol.measure import Measurement
from mpmcol.plotting.measured_series import read_points
from mpmcol.studies.fit.course import COURSE, COURSE_UNITS
from mpmcol.units import to_unit

FRONT = "front_height"  # definition of the front
PROFILE = "profile"
STATIONS = 8  # of a profile, equally spaced from its first to its last point
ASSUMED_ERROR = 0.02  # standard error of values without one, relative; of a profile, in its largest height
EXPECTED = 'expected NAME=VALUE or NAME=VALUE+-ERROR, separated by commas, for example "zeta=1.37+-0.05,beta=0.55"'


@dataclass(frozen=True)
class Quantity:
    """A number that every run gives.

    runout, height: exponents r and b with which it follows from runout and height, q ~ (r_f - r_i)^r h_f^b; the
    relative errors of the grid act with them.
    """

    name: str
    unit: str
    meaning: str
    read: Callable[[Measurement], float | None]
    runout: float = 0.0
    height: float = 0.0

    def of(self, measured: Measurement) -> float:
        """Its value in a deposit; NaN if the deposit has none."""
        value = self.read(measured)
        return float("nan") if value is None else float(value)


QUANTITIES = {
    one.name: one
    for one in (
        Quantity("zeta", "", "runout (r_f - r_i) / r_i", lambda deposit: deposit.zeta[FRONT], runout=1.0),
        Quantity("beta", "", "height h_f / h_i", lambda deposit: deposit.beta, height=1.0),
        Quantity(
            "repose", "deg", "repose angle of the deposit", lambda deposit: deposit.repose_angle_deg,
            runout=-0.5, height=0.9,  # tan(repose) ~ h_f / r_f, for r_f of about 2 r_i
        ),
        Quantity("undisturbed_radius", "m", "undisturbed radius", lambda deposit: deposit.undisturbed_radius),
    )
}  # fmt: skip
MEANINGS = {name: quantity.meaning for name, quantity in QUANTITIES.items()} | COURSE
NO_COURSE: Mapping[str, float] = {}


class GridFactors(NamedTuple):
    """Grid-converged over computed runout and height: the known error of a grid."""

    runout: float = 1.0
    height: float = 1.0


class GridErrors(NamedTuple):
    """Relative standard errors by the grid: of corrected runout and height, and as far as others change with them."""

    runout: float
    height: float
    uncorrected_runout: float
    uncorrected_height: float


AS_COMPUTED = GridFactors()
CORRECTED = ("zeta", "beta")  # for the known error of the grid


@dataclass(frozen=True)
class Target:
    """A measured quantity, or the heights of a measured profile at its stations.

    values, errors: (n,) with their standard errors. x: stations (m) of a profile, or empty.
    """

    name: str
    unit: str
    values: np.ndarray
    errors: np.ndarray
    x: np.ndarray
    is_stated: bool = True  # whether the errors are the user's

    @property
    def is_corrected(self) -> bool:
        """Whether computed values are corrected for the error of the grid."""
        return self.name in CORRECTED

    @property
    def has_grid_error(self) -> bool:
        """Whether it is known how the error of the grid acts on it."""
        quantity = QUANTITIES.get(self.name)
        return self.name == PROFILE or (quantity is not None and (quantity.runout, quantity.height) != (0.0, 0.0))

    def of(
        self, measured: Measurement, course: Mapping[str, float] = NO_COURSE, factors: GridFactors = AS_COMPUTED
    ) -> np.ndarray:
        """The same quantity in a computed deposit or, if it is one of COURSE, in the course of the collapse, (n,).

        factors: correct runout and height for the error of the grid. Profile and repose angle have hardly an error on
        coarse grids, which lack the thin end of the deposit only.
        """
        if self.name == PROFILE:
            return np.interp(self.x, measured.profile_x, measured.profile_y, right=0.0)
        if self.name in COURSE:
            return np.array([course.get(self.name, np.nan)])
        factor = {"zeta": factors.runout, "beta": factors.height}.get(self.name, 1.0)
        return np.array([factor * QUANTITIES[self.name].of(measured)])

    def grid_changes(self, measured: Measurement, errors: GridErrors) -> np.ndarray:
        """Its changes (n, 2) by the standard errors of runout and height."""
        return self.grid_modes(measured) * np.array(errors[:2] if self.is_corrected else errors[2:])

    def grid_modes(self, measured: Measurement) -> np.ndarray:
        """Its change (n, 2) per relative error of the runout and of the height."""
        if self.name in COURSE:
            return np.zeros((1, 2))
        if self.name != PROFILE:
            quantity, value = QUANTITIES[self.name], self.of(measured)
            return np.column_stack((quantity.runout * value, quantity.height * value))
        height, step = self.of(measured), measured.profile_x[1] - measured.profile_x[0]
        ahead, behind = (
            np.interp(self.x + shift, measured.profile_x, measured.profile_y, right=0.0) for shift in (step, -step)
        )
        zeta = max(measured.zeta[FRONT], 0.0)
        stretched = zeta / (1.0 + zeta)  # share of the runout in the length of the deposit
        return np.column_stack((-stretched * self.x * (ahead - behind) / (2.0 * step), height))


def parse_targets(text: str) -> list[Target]:
    """Read measured values, for example "zeta=1.37+-0.05,beta=0.55" or "repose=31deg". Raises UsageError."""
    targets: dict[str, Target] = {}
    for part in filter(None, (part.strip() for part in text.split(","))):
        target = _parse(part)
        if target.name in targets:
            raise UsageError(f"--to {part}: {target.name} is given twice")
        targets[target.name] = target
    return list(targets.values())


def targets_of(values: Mapping[str, float | Sequence[float]]) -> list[Target]:
    """Measured values by name, each a number or a number and its standard error. Raises UsageError."""
    targets = []
    for name, given in values.items():
        numbers = np.atleast_1d(np.asarray(given, dtype=float))
        if numbers.shape not in ((1,), (2,)):
            raise UsageError(f"to {name} = {given!r}: expected a number, or a number and its standard error")
        targets.append(_target(name, float(numbers[0]), float(numbers[1]) if len(numbers) > 1 else 0.0, f"to {name}"))
    return targets


def read_profile(path: Path) -> Target:
    """A measured profile, heights over the distance from the wall or axis, from a CSV file as `plot --points` takes it.

    Raises UsageError if the file cannot be read or has several series.
    """
    series = read_points(path)
    if len(series) > 1:
        raise UsageError(f"{path}: {len(series)} series; a fit takes one profile, that of the deposit")
    order = np.argsort(series[0].r)
    r, z = series[0].r[order], series[0].z[order]
    if len(r) < 3 or r[-1] <= 0.0 or z.max() <= 0.0:
        raise UsageError(f"{path}: expected at least three points with distances and heights > 0")
    x = np.linspace(r[0], r[-1], STATIONS)
    heights = np.interp(x, r, z)
    return Target(PROFILE, "m", heights, np.full(STATIONS, ASSUMED_ERROR * z.max()), x, is_stated=False)


def grid_covariance(targets: Sequence[Target], measured: Measurement, errors: GridErrors) -> np.ndarray:
    """Covariance (n, n) of all values from independent errors of runout and height."""
    changes = np.vstack([target.grid_changes(measured, errors) for target in targets])
    return np.asarray(changes @ changes.T)


def unit_of(name: str) -> str:
    """Unit of a quantity; "" without one."""
    return QUANTITIES[name].unit if name in QUANTITIES else COURSE_UNITS.get(name, "")


def scalars_of(measured: Measurement) -> dict[str, float]:
    """All quantities of a deposit."""
    return {name: quantity.of(measured) for name, quantity in QUANTITIES.items()}


def measured_deposit(results: Results) -> Measurement:
    """The final deposit of a run."""
    return results.measure(-1)


def _parse(part: str) -> Target:
    name, equals, text = part.partition("=")
    value, _, error = text.replace("±", "+-").partition("+-")
    if part.isdecimal():
        raise UsageError(f"--to {part}: a name is missing, or the decimal separator is a point; {EXPECTED}")
    if not (equals and value.strip()):
        raise UsageError(f"--to {part}: {EXPECTED}")
    name = name.strip()
    unit = unit_of(name)
    try:
        number, deviation = _number(value, unit), _number(error or "0", unit)
    except ValueError as reason:
        raise UsageError(f"--to {part}: {reason}; {EXPECTED}") from None
    if error and not deviation > 0.0:
        raise UsageError(f"--to {part}: expected a standard error > 0; without one 2 % are assumed")
    return _target(name, number, deviation, f"--to {part}")


def _number(text: str, unit: str) -> float:
    text = text.strip()
    if unit == "deg":
        text = text.removesuffix("deg").removesuffix("°").strip()
        return to_unit(text, "")
    if unit in COURSE_UNITS.values():
        return to_unit(text, "")
    return to_unit(text, unit)


def _target(name: str, value: float, error: float, where: str) -> Target:
    if name not in MEANINGS:
        known = ", ".join(f"{one} ({meaning})" for one, meaning in MEANINGS.items())
        raise UsageError(f"{where}: no quantity {name!r}; expected one of {known}")
    if not (0.0 < value < np.inf and 0.0 <= error < np.inf):
        raise UsageError(f"{where}: expected a value > 0 and an error >= 0")
    deviation = np.array([error or ASSUMED_ERROR * value])
    return Target(name, unit_of(name), np.array([value]), deviation, np.array([]), error > 0.0)
