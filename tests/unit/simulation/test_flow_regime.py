"""Inertial numbers from stresses, and the record of the rates of a flow."""

from __future__ import annotations

from dataclasses import asdict

import numpy as np
import pytest

import mpmcol
from mpmcol.cli.run_summary import _flows
from mpmcol.mpm.constitutive import mu_i
from mpmcol.mpm.particles import BASE, Points
from mpmcol.simulation.derived import derived_quantities
from mpmcol.simulation.flow_regime import FlowHistogram, FlowRegime

BEADS = {"mu_s": 0.48, "mu_2": 0.73, "I_0": 0.279, "grain_diameter": 0.7e-3, "grain_density": 2500.0}
KEYS = ", ".join(f"{key} = {value}" for key, value in BEADS.items())
MATERIAL = f"material={{law = 'mu-i', density = 1550.0, youngs_modulus = 10e6, poissons_ratio = 0.2, {KEYS}}}"
INTACT = (0.0, 0.0)
CASE = mpmcol.load_case("coarse-channel", [MATERIAL])


def sheared(numbers: np.ndarray, p: float = 800.0) -> Points:
    """Points whose stress is that of a flow with these inertial numbers; every second one is of the base."""
    points, sigma = Points(len(numbers)), np.zeros((len(numbers), 6))
    sigma[:, :3] = -p
    sigma[:, 3] = mu_i.friction_of(numbers, CASE.material) * p
    points.sigma, points.m[:] = sigma, 2.0
    return points


def test_the_inertial_number_is_that_of_the_step() -> None:
    """Of a return from a trial stress, with the plastic shear rate of the step."""
    params, dt = mu_i.make_params(CASE.material), 3e-5
    mean, trial = np.array([-1000.0, -100.0, -1e4, -1000.0]), np.array([600.0, 80.0, 6000.0, 470.0])
    _, shear, _, _, yields = mu_i.return_map(mean, trial, (0.0, 0.0), params, dt)
    shear = np.where(yields > 0.0, shear, trial)
    expected = (trial - shear) / (params.shear_modulus * dt) * 0.7e-3 * np.sqrt(2500.0 / -mean)
    np.testing.assert_allclose(mu_i.inertial_number(mean, shear, INTACT, params), expected, rtol=1e-9)
    assert expected[-1] == 0.0


def test_without_flow_pressure_or_dependence_on_the_rate_it_is_zero() -> None:
    params = mu_i.make_params(CASE.material)
    mean, shear = np.array([0.0, 10.0, -100.0, -100.0]), np.array([0.0, 0.0, 48.0, 80.0])
    np.testing.assert_array_equal(mu_i.inertial_number(mean, shear, INTACT, params)[:3], 0.0)
    assert mu_i.inertial_number(mean, shear, INTACT, params)[3] > 1e10  # above mu_2
    np.testing.assert_array_equal(mu_i.inertial_number(mean, shear, INTACT, params._replace(mu_excess=0.0)), 0.0)


def test_the_equations_are_well_posed_at_intermediate_rates() -> None:
    """The criterion is Eq. 3.9 of Barker & Gray 2017 (doi:10.1017/jfm.2017.428) as well."""
    numbers = np.geomspace(1e-4, 10.0, 2001)
    allowed = numbers[mu_i.well_posed(numbers, CASE.material.model_copy(update={"mu_s": 0.3819, "mu_2": 0.6435}))]
    assert (allowed.min(), allowed.max()) == pytest.approx((0.01935, 0.8523), rel=0.01)
    assert not mu_i.well_posed(numbers, CASE.material.model_copy(update={"mu_2": 0.48})).any()


def test_percentiles_are_those_of_the_flowing_mass_of_the_column() -> None:
    numbers = np.array([0.01] * 60 + [0.1] * 40 + [1e-5] * 50)
    points = sheared(np.concatenate([numbers, [3.0] * 50]))
    points.kind[-50:] = BASE
    flow = FlowHistogram(CASE)
    assert flow.as_dict() is None
    flow.add(points)
    found = flow.as_dict()
    assert found is not None
    assert (found["I_p5"], found["I_median"], found["I_p95"]) == pytest.approx((0.01, 0.01, 0.1), rel=0.03)
    assert found["mu_p95"] == pytest.approx(mu_i.friction_of(np.array(0.1), CASE.material), rel=0.01)
    assert found["ill_posed"] == pytest.approx(0.6)
    assert "60 % of the flow of the column is outside" in next(flow.notes())

    other = FlowHistogram(CASE)
    other.set_memory(flow.memory())
    assert other.as_dict() == found


def test_bed_and_layers_have_percentiles_of_their_own() -> None:
    """The layer has another mu_2; the column's own material does not flow."""
    layers = "layers=[{from = 0.0, to = 0.05, material = {mu_2 = 0.9}}]"
    case = mpmcol.load_case("granular-bed", [MATERIAL, layers])
    points = sheared(np.array([0.01] * 10 + [0.1] * 10 + [1e-5] * 5))
    points.kind[:10], points.kind[10:20] = BASE, BASE + 1
    flow = FlowHistogram(case)
    flow.add(points)
    found = flow.of_others()
    assert flow.as_dict() is None and found is not None and list(found) == ["base", "layer-1"]
    assert found["base"]["I_median"] == pytest.approx(0.01, rel=0.03)
    layer = case.layers[0].material
    params = mu_i.make_params(layer)
    shear = 800.0 * mu_i.friction_of(np.array([0.1]), CASE.material)
    number = mu_i.inertial_number(np.array([-800.0]), shear, INTACT, params)
    assert found["layer-1"]["I_median"] == pytest.approx(number[0], rel=0.03)
    assert found["layer-1"]["mu_median"] == pytest.approx(mu_i.friction_of(number, layer)[0], rel=0.01)
    assert [note for note in flow.notes() if "flow of the base is outside" in note]

    other = FlowHistogram(case)
    other.set_memory(flow.memory())
    assert other.of_others() == found


def test_the_summary_has_a_line_for_each_material_and_names_the_percentiles() -> None:
    flow = asdict(FlowRegime(0.01, 0.02, 0.3, 0.4, 0.45, 0.5, 0.0))
    lines = list(_flows({"flow": flow, "flow_by_material": {"base": flow}}))
    assert [line.partition(":")[0] for line in lines] == ["flow of the column", "flow of the base"]
    assert "I 0.01 to 0.3, median 0.02; mu 0.400 to 0.500" in lines[0] and "percentiles 5 to 95" in lines[0]
    assert not list(_flows({"flow": None, "flow_by_material": None}))


def test_a_bed_of_mu_i_is_reported_under_a_column_of_another_law() -> None:
    case = mpmcol.load_case("granular-bed", [MATERIAL.replace("material=", "base_material=")])
    points = sheared(np.array([0.1] * 10))
    points.kind[:5] = BASE
    flow = FlowHistogram(case)
    flow.add(points)
    assert flow.as_dict() is None and list(flow.of_others() or {}) == ["base"]


def test_other_laws_have_neither_inertial_numbers_nor_percentiles() -> None:
    case = mpmcol.load_case("coarse-channel")
    flow, points = FlowHistogram(case), sheared(np.array([0.1]))
    flow.add(points)
    assert (flow.as_dict(), flow.of_others(), flow.memory(), list(flow.notes())) == (None, None, [], [])
    assert derived_quantities(case, points) == {}
    np.testing.assert_allclose(derived_quantities(CASE, points)["inertial_number"], 0.1)
