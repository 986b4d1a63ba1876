"""Notes on parameters of the mu(I) law."""

from __future__ import annotations

import pytest

import mpmcol
from mpmcol.setup.unfit_settings import setting_warnings

BEADS = {
    "law": '"mu-i"', "density": "1550.0", "youngs_modulus": "2e6", "poissons_ratio": "0.2", "mu_s": "0.48",
    "mu_2": "0.73", "I_0": "0.279", "grain_diameter": "0.7e-3", "grain_density": "2500.0",
}  # fmt: skip


def inline(**keys: str) -> str:
    return "{" + ", ".join(f"{key} = {value}" for key, value in keys.items()) + "}"


def warnings_for(**keys: str) -> list[str]:
    case = mpmcol.load_case("coarse-channel", [f"material={inline(**BEADS | keys)}", "grid.spacing=0.01"])
    return setting_warnings(case, 0.01)


WRONG = pytest.mark.parametrize(
    ("keys", "text"),
    [
        ({"mu_2": "0.48"}, "mu_2 = mu_s = 0.48: friction does not depend on the rate"),
        ({"grain_diameter": "0.02"}, "grain_diameter = 20 mm is larger than a cell of 10 mm"),
        ({"density": "2650.0"}, "density = 2650 kg/m3 is that of the material with its pores"),
    ],
)


@WRONG
def test_a_wrong_parameter_is_noted_and_a_right_one_is_not(keys: dict[str, str], text: str) -> None:
    usual = warnings_for()
    (added,) = set(warnings_for(**keys)) - set(usual)
    assert added.startswith(f"material.{text}")
    assert not any("mu_2" in warning or "grain" in warning for warning in usual)


@WRONG
def test_a_wrong_parameter_of_a_bed_or_layer_is_noted(keys: dict[str, str], text: str) -> None:
    """The materials of the column have no such parameter."""
    bed = mpmcol.load_case("granular-bed", [f"base_material={inline(**BEADS | keys)}"])
    assert any(note.startswith(f"base_material.{text}") for note in setting_warnings(bed, 0.01))
    layers = f"layers=[{{from = 0.02, to = 0.05, material = {inline(**keys)}}}]"
    column = mpmcol.load_case("coarse-channel", [f"material={inline(**BEADS)}", layers])
    assert any(note.startswith(f"layers.0.material.{text}") for note in setting_warnings(column, 0.01))


def test_undrained_clay_has_no_note_on_its_friction() -> None:
    clay = "law = 'mohr-coulomb', density = 1800.0, youngs_modulus = 5e6, poissons_ratio = 0.3, friction_deg = 0.0"
    overrides = [f"material={{{clay}, cohesion = 1e3}}", "geometry.base=rigid", "friction.floor=0.3"]
    case = mpmcol.load_case("coarse-channel", [*overrides, "method.wall_impulse=true"])
    assert not any("friction" in warning for warning in setting_warnings(case, 0.005))


def field_warnings(*overrides: str) -> list[str]:
    case = mpmcol.load_case("random-friction", overrides)
    return [
        warning
        for warning in setting_warnings(case, case.grid.spacing)
        if "field" in warning or "correlation" in warning
    ]


def test_a_field_that_the_grid_does_not_resolve_is_noted() -> None:
    assert field_warnings() == []
    (note,) = field_warnings("grid.spacing=0.1")
    assert note.startswith("material.correlation_length_vertical = 250 mm is only 2.5 cells") and "62.5 mm" in note
    (note,) = field_warnings("material.correlation_length=0.1", "material.correlation_length_vertical=1")
    assert note.startswith("material.correlation_length = 100 mm is only 2 cells")
    layer = "layers=[{from=0, to=0.5, material={correlation_length_vertical=0.1}}]"
    assert field_warnings(layer)[0].startswith("layers.0.material.correlation_length_vertical = 100 mm")


def test_a_length_in_another_unit_is_noted() -> None:
    lengths = ("material.correlation_length=20", "material.correlation_length_vertical=20")
    (note,) = field_warnings(*lengths)
    assert note.startswith("material.correlation_length = 20 m is much longer than the column") and '"20 mm"' in note
    assert field_warnings(lengths[0]) == []  # a layered soil
    (note,) = field_warnings("material.correlation_length=100", lengths[1])
    assert note.startswith("material.correlation_length_vertical = 20 m")


def test_a_field_around_an_axis_is_noted() -> None:
    (note,) = field_warnings("geometry.model=axisymmetric")
    assert "the friction is the same all around the axis" in note and 'geometry.model = "full"' in note
