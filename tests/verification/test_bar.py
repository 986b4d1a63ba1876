"""Axial vibration of an elastic bar (`mpmcol.failure_modes.problems.bar`): period and energy of each transfer."""

from __future__ import annotations

import pytest

from mpmcol.failure_modes.problems.bar import PERIOD, vibration
from mpmcol.mpm.settings import Scheme


@pytest.mark.parametrize("cfl", [0.1, 0.5])
def test_period_is_within_a_tenth_of_a_percent(cfl: float) -> None:
    assert vibration("taylor-flip", cfl).period == pytest.approx(PERIOD, rel=1e-3)


@pytest.mark.parametrize(
    ("transfer", "cfl", "energy", "tolerance"),
    [
        ("flip", 0.1, 0.9989, 0.0004),
        ("taylor-flip", 0.1, 0.9995, 0.0002),
        ("pic", 0.1, 6e-5, 0.5e-5),
        ("flip", 0.5, 0.9958, 0.0004),
        ("taylor-flip", 0.5, 0.9986, 0.0002),
        ("pic", 0.5, 0.142, 0.001),
    ],
)
def test_energy_after_ten_periods(transfer: str, cfl: float, energy: float, tolerance: float) -> None:
    """Reference values: an independent one-dimensional code with the same bar and time steps."""
    assert vibration(transfer, cfl).energy == pytest.approx(energy, abs=tolerance)


@pytest.mark.parametrize(
    ("order", "energy"),
    [("usl", 0.9986), pytest.param("musl", 0.9986, marks=pytest.mark.slow), ("usf", 1.0005)],
)
def test_usf_gains_energy_and_usl_loses_energy(order: str, energy: float) -> None:
    """As Bardenhagen found (2002, doi:10.1006/jcph.2002.7103); the period does not depend on the order."""
    bar = vibration("taylor-flip", 0.5, scheme=Scheme(stress_order=order))
    assert bar.energy == pytest.approx(energy, abs=1e-4)
    assert bar.period == pytest.approx(PERIOD, rel=1e-3)
    assert bar.cross_motion < 1e-12


@pytest.mark.parametrize(
    ("basis", "cfl", "energy"),
    [
        ("linear", 0.5, 0.9996),
        *(pytest.param("cubic", cfl, energy, marks=pytest.mark.slow) for cfl, energy in ((0.5, 0.9985), (1.1, 0.9965))),
    ],
)
def test_period_and_energy_with_other_shape_functions(basis: str, cfl: float, energy: float) -> None:
    """The stability limit of a single particle in 1D is cfl = 1.13 for cubic, 0.82 for quadratic B-splines."""
    bar = vibration("taylor-flip", cfl, scheme=Scheme(basis=basis))
    assert bar.period == pytest.approx(PERIOD, rel=1e-3)
    assert bar.energy == pytest.approx(energy, abs=2e-4)


@pytest.mark.slow
def test_musl_halves_the_energy_loss_of_flip() -> None:
    lost = {order: 1.0 - vibration("flip", 0.5, scheme=Scheme(stress_order=order)).energy for order in ("usl", "musl")}
    assert 0.0 < lost["musl"] < 0.6 * lost["usl"]


def test_the_bar_moves_along_its_axis_only() -> None:
    assert vibration("taylor-flip", 0.5).cross_motion < 1e-12


@pytest.mark.parametrize("along", [0, 1, 2], ids="xyz")
def test_2d_and_3d_bars_agree(along: int) -> None:
    """To round-off: after 2,000 steps energy and period differ by about 1e-15."""
    plane, solid = vibration("taylor-flip", 0.5), vibration("taylor-flip", 0.5, 3, along)
    assert solid.period == pytest.approx(PERIOD, rel=1e-3)
    assert solid.energy == pytest.approx(0.9986, abs=0.0002)
    assert solid.period == pytest.approx(plane.period, rel=1e-11)
    assert solid.energy == pytest.approx(plane.energy, rel=1e-11)
    assert solid.cross_motion < 1e-12
