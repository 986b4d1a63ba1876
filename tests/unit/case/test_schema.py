"""Values, defaults and units of a case."""

from __future__ import annotations

import math

import pytest

from mpmcol.case import load_case, resolved_toml
from tests.support.case_files import GOOD, Write, only_problem


def test_default_values(write: Write) -> None:
    case = load_case(write(GOOD))
    method = case.method
    assert (method.basis, method.transfer, method.stress_order) == ("quadratic", "taylor-flip", "usl")
    assert (method.position_update, method.flip_fraction) == ("trapezoid", 1.0)
    assert method.kernel_correction and method.wall_impulse and method.opening_strain
    assert (case.geometry.base, case.geometry.base_thickness, case.geometry.gravity) == (
        "elastic",
        0.02,
        9.81,
    )
    assert (case.grid.points_per_cell, case.time.cfl, case.output.snapshots) == (4, 0.5, 20)
    assert (case.stages.equilibrate.damping, case.stages.collapse.damping) == (0.5, 0.05)
    assert (case.stages.collapse.end, case.stages.collapse.max_time_factor) == ("rest", 10.0)
    assert case.stages.gate_speed == math.inf
    assert case.score.experiment == "paper"


def test_defaults_that_depend_on_the_material(write: Write) -> None:
    case = load_case(write(GOOD), ["material.youngs_modulus=2 MPa"])
    assert case.stages.equilibrate.law == "mohr-coulomb"
    assert case.stages.k0 == pytest.approx((1 - math.sin(math.radians(33))) / (1 + math.sin(math.radians(33))))
    base = case.base_material
    assert (base.law, base.density, base.youngs_modulus, base.poissons_ratio) == ("elastic", 2650.0, 2e6, 0.2)


def test_given_values_replace_defaults_that_depend_on_the_material(write: Write) -> None:
    stages = '[stages]\ninitial_stress = "k0"\nk0 = 0.5\nequilibrate = { law = "elastic" }\n'
    base = "[base_material]\ndensity = 1\nyoungs_modulus = 2\npoissons_ratio = 0\nlaw = 'elastic'\n"
    case = load_case(write(GOOD + stages + base))
    assert (case.stages.k0, case.stages.equilibrate.law, case.base_material.density) == (0.5, "elastic", 1.0)


def test_a_ratio_of_the_initial_stress_without_effect_is_refused(write: Write) -> None:
    problem = only_problem(write(GOOD + "[stages]\nk0 = 0.5\n"))
    assert (problem.key, problem.line) == ("stages.k0", 19)
    assert problem.message.startswith('[stages] k0 = 0.5: has no effect with initial_stress = "gravity": remove it')
    case = load_case(write(GOOD))
    assert load_case(write(GOOD), [f"stages.k0={case.stages.k0}"]) == case  # in resolved cases of earlier versions
    weaker = load_case(write(resolved_toml(case)), ["material.friction_deg=20"])
    assert weaker.stages.k0 == pytest.approx(math.tan(math.radians(35)) ** 2)
    assigned = load_case(write(GOOD), ["stages.initial_stress=k0", "stages.k0=0.5"])
    assert load_case(write(resolved_toml(assigned))) == assigned


def test_keys_of_the_base_follow_from_the_material(write: Write) -> None:
    elastic = load_case(write(GOOD + "[base_material]\nyoungs_modulus = 1e8\n")).base_material
    assert (elastic.law, elastic.density, elastic.youngs_modulus) == ("elastic", 2650.0, 1e8)
    granular = write(GOOD.replace("aspect = 3.0", 'aspect = 3.0\nbase = "granular"'))
    assert load_case(granular).base_material == load_case(granular).material
    bed = load_case(granular, ["base_material.friction_deg=20"])
    assert bed.base_material == bed.material.model_copy(update={"friction_deg": 20.0})
    softening = [f"{name}_{end}_deg=30" for name in ("friction", "dilatancy") for end in ("peak", "residual")]
    keys = ["law=mohr-coulomb-softening", "softening_rate=2", *softening]
    other = load_case(granular, [f"base_material.{key}" for key in keys]).base_material
    assert (other.law, other.density) == ("mohr-coulomb-softening", 2650.0)


def test_height_and_aspect_ratio_follow_from_each_other() -> None:
    by_aspect = load_case("lube-channel", ["geometry.aspect=5"]).geometry
    assert (by_aspect.r_i, by_aspect.a) == (0.09, 5.0)
    assert by_aspect.h_i == pytest.approx(0.45)
    by_height = load_case("bui-rods").geometry
    assert (by_height.h_i, by_height.a) == (0.1, 0.5)


def test_strings_with_units_are_converted(write: Write) -> None:
    text = GOOD.replace("0.002", '"2 mm"').replace("10e6", '"10 MPa"').replace("2650.0", '"2.65 g/cm3"')
    assert load_case(write(text)) == load_case(write(GOOD))


def test_times_of_snapshots_are_converted_to_seconds(write: Write) -> None:
    assert load_case(write(GOOD), ['output.times=[0, "100 ms", 0.2]']).output.times == (0.0, 0.1, 0.2)
