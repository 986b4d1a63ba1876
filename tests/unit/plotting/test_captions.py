"""Captions state the material: law, friction, cohesion, and the friction of the floor."""

from __future__ import annotations

import pytest

from mpmcol.case import load_case, resolved_toml
from mpmcol.plotting.captions import heading_of, heading_of_snapshot, material_text
from tests.support.synthetic_run import SHAPE


@pytest.mark.parametrize(
    ("name", "overrides", "text"),
    [
        ("cohesive-column", ("material.friction_deg=0",), "Mohr-Coulomb, φ = 0°, c = 3 kPa"),
        ("cohesive-column", ("material.cohesion=0",), "Mohr-Coulomb, φ = 30°"),
        ("dam", ("friction.floor=0.5",), "Mohr-Coulomb, φ = 33°, floor μ = 0.5"),
        ("layered-column", (), "Mohr-Coulomb, φ = 33°, 1 layer of other material"),
        ("dam", ("friction.floor=0",), "Mohr-Coulomb, φ = 33°, floor μ = 0"),
    ],
)
def test_the_material_has_its_cohesion_and_the_floor_its_friction(
    name: str, overrides: tuple[str, ...], text: str
) -> None:
    case = load_case(name, overrides)
    assert material_text(case) == text
    marked = text.replace("φ", r"$\varphi$").replace("°", r"$\degree$").replace("μ", r"$\mu$").replace("c =", "$c$ =")
    meta = {**vars(SHAPE), "title": case.title, "case": resolved_toml(case)}
    for heading in (heading_of(case, SHAPE), heading_of_snapshot(meta)):
        assert heading.caption.endswith(f"per cell, {marked}")


def test_the_cohesion_of_a_softening_law_has_both_ends() -> None:
    case = load_case("channel-dense", ["material.cohesion=3kPa", "material.cohesion_residual=500"])
    peak, residual = case.material.friction_peak_deg, case.material.friction_residual_deg
    expected = f"Mohr-Coulomb with softening, φ = {peak:g} to {residual:g}°, c = 3 kPa to 500 Pa"
    assert material_text(case) == expected
