"""Vertical cuts in cohesive soil stand and fall at the heights of limit analysis.

A cut of height H stands up to rho g H / c = 3.83 tan(45 deg + phi/2) by the best slip surfaces, and without tensile
strength up to 2 tan(45 deg + phi/2) (Drucker 1953); it falls from 4 tan(45 deg + phi/2), the plane wedge, and without
tensile strength from 2.67 of that on, the wedge below a crack (Terzaghi 1943).
"""

from __future__ import annotations

from math import radians, tan
from pathlib import Path

import pytest

import mpmcol

WEIGHT = 1800.0 * 9.81 * 1.0  # rho g H of the case, Pa


def runout(phi: float, number: float, tension: bool, folder: Path) -> float:
    """zeta of a cut with rho g H / c = number tan(45 deg + phi/2), on a coarse grid."""
    cohesion = WEIGHT / (number * tan(radians(45.0 + 0.5 * phi)))
    overrides = [f"material.friction_deg={phi}", f"material.cohesion={cohesion}", "grid.spacing=0.0625"]
    overrides += ["stages.collapse.max_time_factor=6", "output.snapshots=1"]
    if tension:
        keys = f"friction_deg={phi}, cohesion={cohesion}"
        elastic = "density=1800.0, youngs_modulus=5e6, poissons_ratio=0.3"
        overrides[:2] = [f"material={{law='mohr-coulomb', {elastic}, {keys}}}"]
    return mpmcol.run(mpmcol.load_case("cohesive-column", overrides), folder).measure().zeta["front_height"]


SLOW = [pytest.param(phi, marks=pytest.mark.slow) for phi in (20.0, 25.0, 33.0)]


@pytest.mark.parametrize("phi", [0.0, 30.0, *SLOW])
@pytest.mark.parametrize(("tension", "stands", "falls"), [(True, 3.83, 4.0), (False, 2.0, 2.67)])
def test_a_cut_stands_below_and_falls_above_its_critical_height(
    phi: float, tension: bool, stands: float, falls: float, tmp_path: Path
) -> None:
    assert runout(phi, 0.9 * stands, tension, tmp_path / "stands") < 0.01
    assert runout(phi, 1.1 * falls, tension, tmp_path / "falls") > 0.05


def test_a_strong_column_stays_for_a_second(tmp_path: Path) -> None:
    """Without motion, with the weight above on the lowest points; it has tensile strength, so no crack opens."""
    values = ["material.cohesion=20 kPa", "material.tension=34 kPa", "grid.spacing=0.0625", "output.snapshots=1"]
    values += ["stages.collapse.end=time", "stages.collapse.max_time_factor=3.2"]  # 1.02 s
    last = mpmcol.run(mpmcol.load_case("cohesive-column", values), tmp_path / "run").snapshot(-1)
    assert last.time > 1.0
    assert last.displacement_magnitude.max() < 0.01 * 0.0625
    lowest = last.x[:, 1] < 0.03
    assert -last.arrays["stress"][lowest, 1].mean() == pytest.approx(WEIGHT * (1.0 - 0.25 * 0.0625), rel=0.02)
