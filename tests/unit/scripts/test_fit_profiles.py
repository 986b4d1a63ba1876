"""Measured profiles of the examples of fits are those of the published records."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mpmcol.experiments import EXPERIMENTS
from mpmcol.plotting.measured_series import read_points

PROFILES = Path(__file__).parents[3] / "scripts/fit"


def test_the_surface_of_the_channel_is_the_universal_one_with_the_published_length_and_height() -> None:
    (series,) = read_points(PROFILES / "lube.csv")
    (profile,) = EXPERIMENTS["lube-2007"].profiles
    r_i, a = 0.09, 3.0
    zeta, beta = (EXPERIMENTS["lube-2007"].expected(quantity, a) for quantity in ("zeta", "beta"))
    assert zeta and beta
    assert series.r == pytest.approx(np.array(profile.x) * (1.0 + zeta[0]) * r_i, abs=1e-4)
    assert series.z == pytest.approx(np.array(profile.y) * beta[0] * a * r_i, abs=1e-4)
    assert np.trapezoid(series.z, series.r) / (a * r_i**2) == pytest.approx(1.07, abs=0.005)


def test_the_surface_of_the_rods_is_the_published_one() -> None:
    (series,) = read_points(PROFILES / "rods.csv")
    (profile,) = [one for one in EXPERIMENTS["bui-2008"].profiles if one.name == "free surface"]
    assert series.r == pytest.approx(profile.x) and series.z == pytest.approx(profile.y)
