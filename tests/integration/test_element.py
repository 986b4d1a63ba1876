"""`mpmcol element`: element tests of laws against closed forms, and the command."""

from __future__ import annotations

import csv
from math import asin, atan, degrees, inf, radians, sin, sqrt, tan
from pathlib import Path

import numpy as np
import pytest

import mpmcol
from mpmcol.cli.element import TESTS
from mpmcol.mpm.constitutive import mu_i
from mpmcol.studies.element import run
from mpmcol.studies.element.paths import PATHS
from mpmcol.studies.element.run import element_test
from tests.support.cli import invoke

P0 = 1e3
SAND = "law = 'mohr-coulomb', density = 1600.0, youngs_modulus = 10e6, poissons_ratio = 0.2, friction_deg = 33.0"


def driven(material: str, test: str, strain: float = 0.02, rate: float = 1.0) -> dict[str, np.ndarray]:
    case = mpmcol.load_case("coarse-channel", [f"material={{{material}}}"])
    return element_test(case, PATHS[test], P0, strain, 400, rate)


def test_the_command_offers_all_paths() -> None:
    assert list(PATHS) == list(TESTS)


@pytest.mark.parametrize("cohesion", [0.0, 500.0])
@pytest.mark.parametrize("test", ["plane-strain", "triaxial"])
def test_compression_ends_at_the_strength_of_mohr_coulomb(test: str, cohesion: float) -> None:
    found = driven(f"{SAND}, cohesion = {cohesion}", test)
    n_phi = (1.0 + sin(radians(33.0))) / (1.0 - sin(radians(33.0)))
    assert -found["stress.yy"][-1] == pytest.approx(n_phi * P0 + 2.0 * cohesion * sqrt(n_phi), rel=1e-9)
    np.testing.assert_allclose(-found["stress.xx"], P0, rtol=1e-9)
    if test == "triaxial":
        np.testing.assert_allclose(found["stress.zz"], found["stress.xx"], rtol=1e-12)


def test_dilatancy_expands_at_the_rate_of_the_flow_rule() -> None:
    found = driven(f"{SAND}, dilatancy_deg = 10.0", "plane-strain")
    slope = np.diff(found["volumetric_strain"])[-1] / np.diff(found["strain"])[-1]
    n_psi = (1.0 + sin(radians(10.0))) / (1.0 - sin(radians(10.0)))
    assert slope == pytest.approx(n_psi - 1.0, rel=0.03)


def test_simple_shear_mobilises_the_sine_of_friction_without_dilatancy() -> None:
    found = driven(SAND, "shear", 0.05)
    assert found["stress.xy"][-1] == pytest.approx(sin(radians(33.0)) * P0, rel=1e-3)
    assert found["mobilised_deg"][-1] == pytest.approx(33.0, rel=1e-9)


def test_extension_of_cohesive_sand_opens_at_its_tensile_strength() -> None:
    found = driven(f"{SAND}, cohesion = 500.0, tension = 200.0", "extension", 0.002)
    assert found["pressure"][-1] == pytest.approx(-200.0, rel=1e-12)
    bulk = 10e6 / 1.8
    assert found["opening_strain"][-1] == pytest.approx(0.002 - 1200.0 / bulk, rel=0.01)


def test_the_rate_raises_the_friction_of_mu_i() -> None:
    keys = "mu_s = 0.4, mu_2 = 0.7, I_0 = 0.3, grain_diameter = 1e-3, grain_density = 2500.0"
    material = f"law = 'mu-i', density = 1600.0, youngs_modulus = 10e6, poissons_ratio = 0.2, {keys}"
    for rate in (0.01, 20.0):
        found = driven(material, "shear", 0.05, rate)
        number = rate * 1e-3 * sqrt(2500.0 / found["pressure"][-1])
        assert found["inertial_number"][-1] == pytest.approx(number, rel=0.02)
        assert found["shear"][-1] / found["pressure"][-1] == pytest.approx(0.4 + 0.3 / (1.0 + 0.3 / number), rel=1e-3)
    assert degrees(asin(0.4)) < found["mobilised_deg"][-1]


GRAINS = "I_0 = 0.3, grain_diameter = 1e-3, grain_density = 2500.0"
COHESIVE = {  # material and its tensile strength
    "mohr-coulomb": (f"{SAND}, tension = 200.0", 200.0),
    "drucker-prager": (SAND.replace("mohr-coulomb", "drucker-prager"), 500.0 / tan(radians(33.0))),
    "mu-i": (
        "law = 'mu-i', density = 1600.0, youngs_modulus = 10e6, poissons_ratio = 0.2, mu_s = 0.5, mu_2 = 0.7, "
        + GRAINS,
        1000.0,
    ),
}


@pytest.mark.parametrize("law", COHESIVE)
@pytest.mark.parametrize("limit", [0.0, 0.005, inf])
def test_an_opened_point_loses_its_tensile_strength_at_the_failure_strain(law: str, limit: float) -> None:
    """The largest opening strain that it had counts, although no plastic strain is added while it is open."""
    keys, strength = COHESIVE[law]
    found = driven(f"{keys}, cohesion = 500.0, failure_strain = {limit}", "extension", 0.02)
    opening, tension = found["opening_strain"], -found["pressure"]
    before = (opening > 0.0) & (opening < limit)
    after = np.roll(opening, 1)[1:] > limit  # with the opening at the end of the step before
    np.testing.assert_allclose(tension[before], strength, rtol=1e-9)
    np.testing.assert_allclose(tension[1:][after], 0.0, atol=1e-9)
    assert before.any() == (limit > 0.0) and after.any() == (limit < inf)


def test_failed_grains_have_the_rate_of_grains_without_cohesion() -> None:
    """The inertial number of a state follows from the strength that is left."""
    material = mu_i.Material(
        density=1600.0, youngs_modulus=10e6, poissons_ratio=0.2, mu_s=0.5, mu_2=0.7, I_0=0.3, grain_diameter=1e-3,
        grain_density=2500.0, cohesion=500.0, failure_strain=0.01,
    )  # fmt: skip
    params = mu_i.make_params(material)
    mean, shear, history = np.array([-1000.0, -1000.0]), np.array([600.0, 1100.0]), (np.array([0.02, 0.0]), np.zeros(2))
    numbers = mu_i.inertial_number(mean, shear, history, params)
    np.testing.assert_allclose(mu_i.friction_of(numbers, material), 0.6, rtol=1e-12)


@pytest.mark.parametrize("path", ["plane-strain", "triaxial", "shear", "extension"])
@pytest.mark.parametrize("rate", [0.01, 20.0])
def test_mu_i_with_equal_coefficients_is_drucker_prager(path: str, rate: float) -> None:
    """The state after each step of the compiled update, at any rate."""
    elastic = "density = 1600.0, youngs_modulus = 10e6, poissons_ratio = 0.2, cohesion = 50.0"
    angle = degrees(atan(0.4))
    cone = driven(f"law = 'drucker-prager', {elastic}, friction_deg = {angle}, match = 'tangent'", path, 0.02, rate)
    same, other = (
        driven(f"law = 'mu-i', {elastic}, mu_s = 0.4, mu_2 = {x}, {GRAINS}", path, 0.02, rate) for x in (0.4, 0.5)
    )
    for name, expected in cone.items():
        np.testing.assert_allclose(same[name], expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())
    if path != "extension" and rate > 1.0:
        assert abs(other["shear"][-1] / cone["shear"][-1] - 1.0) > 0.01


def test_the_command_writes_chart_and_table(tmp_path: Path) -> None:
    result = invoke("element", "coarse-channel", "--strain", "0.01", "--steps", "50", "--out", tmp_path / "new")
    assert result.exit_code == 0 and "largest mobilised friction angle 33 deg" in result.output
    assert (tmp_path / "new/element.png").stat().st_size > 5000
    rows = list(csv.reader((tmp_path / "new/element.csv").read_text().splitlines()))
    assert len(rows) == 52 and rows[0][:2] == ["strain", "stress.xx [Pa]"]


def test_clay_has_its_cohesion_as_strength_and_sand_may_not_have_yielded(tmp_path: Path) -> None:
    clay = ("--set", "material.friction_deg=0", "--set", "material.cohesion=3000", "--out", tmp_path / "clay")
    done = invoke("element", "coarse-channel", "--test", "triaxial", *clay)
    assert "largest shear stress (s1 - s3) / 2 3000 Pa" in done.output and "largest sqrt(J2) 3464 Pa" in done.output
    assert "of stresses to which cohesion contributes" in done.output and "note:" not in done.output
    elastic = ("--pressure", "100 kPa", "--strain", "0.001", "--out", tmp_path / "sand")
    done = invoke("element", "coarse-channel", "--test", "triaxial", *elastic)
    assert "note: the stress rises at the end as it did at the start: no strength yet" in done.output
    done = invoke("element", "coarse-channel", "--test", "extension", *clay[:-1], tmp_path / "pulled")
    assert "no tensile strength up to a mean tension of" in done.output
    assert "contributes" not in done.output


def test_extension_prints_the_tensile_strength(tmp_path: Path) -> None:
    keys = ("--set", "material.tension=1.5 kPa", "--test", "extension", "--out", tmp_path / "new")
    result = invoke("element", "cohesive-column", *keys)
    assert result.exit_code == 0 and "tensile strength (largest mean tension) 1500 Pa" in result.output
    assert "opening strain at the end 0.04" in result.output and "friction angle" not in result.output


@pytest.mark.parametrize(
    ("option", "value", "text"),
    [
        ("--test", "torsion", "plane-strain"),
        ("--steps", "1", "10<=x"),
        *(("--pressure", text, "expected a number > 0 in Pa") for text in ("-1", "nan", "inf", "1e300", "0", "1 kg")),
        *(("--rate", text, "expected a number > 0") for text in ("nan", "inf")),
        ("--strain", "11", "expected a number > 0 and <= 10"),
    ],
)
def test_wrong_options_are_refused(option: str, value: str, text: str) -> None:
    refused = invoke("element", "coarse-channel", option, value)
    assert refused.exit_code == 2 and text in refused.stderr


def test_values_have_units_and_a_folder_that_cannot_be_is_refused_first(tmp_path: Path) -> None:
    command = ("element", "coarse-channel", "--steps", "10", "--pressure", "2 kPa", "--strain", "5%", "--out")
    assert "initial pressure 2000 Pa" in invoke(*command, tmp_path / "out").output
    (tmp_path / "file").touch()
    refused = invoke(*command, tmp_path / "file")
    assert refused.exit_code == 5 and refused.stdout == ""


def test_a_stress_that_cannot_be_kept_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run, "WIDEST", 0.01)
    refused = invoke("element", "coarse-channel", "--test", "triaxial", "--out", tmp_path)
    assert refused.exit_code == 2 and "no strain keeps the stress" in refused.stderr
