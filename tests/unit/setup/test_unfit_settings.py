"""Settings that are known to be unfit: each causes one warning, and what this proposes causes none."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import mpmcol
from mpmcol.case import load_case, shipped_cases
from mpmcol.errors import UsageError
from mpmcol.setup import cores
from mpmcol.setup.cores import available_cores, thread_note
from mpmcol.setup.discretization import discretize
from mpmcol.setup.memory import require_memory_for
from mpmcol.setup.shortening import elastic_shortening
from mpmcol.setup.unfit_settings import kind_of, require_stiff_column
from tests.support.cli import invoke, set_options
from tests.support.runs import TINY

SAND = ("geometry.aspect=1", "grid.spacing=0.005")  # of lube-channel, with an elastic base and wall_impulse = false
BED = ["geometry.base=granular", "geometry.base_thickness=0.012", "method.wall_impulse=true"]
UNFIT = [  # overrides of SAND, beginning of the warning, what it proposes
    (["grid.points_per_cell=1"], "grid.points_per_cell = 1", "grid.points_per_cell=9"),
    (["grid.spacing=0.02"], "grid.spacing = 0.0225 m: the radius", "grid.spacing=0.015"),
    (["geometry.aspect=0.3", "grid.spacing=0.0075"], "grid.spacing = 0.0075 m: the height", "grid.spacing=0.0045"),
    (BED, "geometry.base_thickness = 0.012 m: the granular bed has only 2 cells", "grid.spacing=0.003"),
    (["geometry.base=rigid"], "method.wall_impulse = false", "method.wall_impulse=true"),
    (
        ["geometry.base=rigid", "method.wall_impulse=true", "friction.floor=31 deg"],
        "friction.floor = 0.6009 (31 degrees): the column shears at sin(33 degrees) = 0.545",
        "friction.floor=0.54",
    ),
    (["material.friction_deg=0.5236"], "material.friction_deg = 0.5236", "material.friction_deg=0.5236 rad"),
    (["material.density=2.65"], "material.density = 2.65 kg/m3", "material.density=2.65 g/cm3"),
    (["material.dilatancy_deg=10"], "material.dilatancy_deg = 10", "material.dilatancy_deg=0"),
    (["material.youngs_modulus=1e5"], "material.youngs_modulus = 100000 Pa", "material.youngs_modulus=1.1e+06"),
    (["geometry.slope_deg=30"], "geometry.slope_deg = 30: the flow does not stop", "stages.collapse.end=time"),
    (["geometry.base_thickness=10"], "geometry.base_thickness = 10 m is 111 times", "geometry.base_thickness=10 mm"),
    (["geometry.gravity=0.0981"], "geometry.gravity = 0.0981 m/s2 is 0.01 times", "geometry.gravity=9.81"),
    (["material.cohesion=5 kPa"], "material.cohesion = 5000 Pa: the column does not", "material.cohesion=1.8e+02"),
    (["stages.collapse.damping=0.9"], "stages.collapse.damping = 0.9: local", "stages.collapse.damping=0.05"),
    (
        ["stages.collapse.max_time_factor=1e-3"],
        "stages.collapse.max_time_factor = 0.001: the run ends 9.58e-05 s",
        "stages.collapse.max_time_factor=10",
    ),
    (["stages.collapse.max_time_factor=0.5"], "stages.collapse.max_time_factor = 0.5: the", "stages.collapse.end=time"),
    (
        ["stages.gate_speed=1e-6"],
        "stages.gate_speed = 1e-06 m/s: the run takes about 2.3e+09",
        "stages.gate_speed=0.094",
    ),
    (
        ["material.poissons_ratio=0.4999999"],
        "material.poissons_ratio = 0.4999999: the run",
        "material.poissons_ratio=0.49",
    ),
    (
        ["material.youngs_modulus=1e15"],
        "material.youngs_modulus = 1e+15 Pa: the run",
        "material.youngs_modulus=1.2e+06",
    ),
    (["time.cfl=1e-4"], "time.cfl = 0.0001: the run", "time.cfl=0.5"),
    (["grid.spacing=0.001 mm"], "grid.spacing = 0.001 mm: the run", "grid.spacing=0.9 mm"),
    (
        ["stages.collapse.end=time", "stages.collapse.max_time_factor=1e4"],
        "stages.collapse.max_time_factor = 1e+04: the run",
        "stages.collapse.max_time_factor=10",
    ),
    (["geometry.domain_length=0.3"], "geometry.domain_length = 0.3 m", "geometry.domain_length=0.398"),
]
WALLS = [  # walls of the case frictional-floor, beginning of the warning, walls that cause none
    ("{from=0.15, to=0.2, friction=0.6}", "walls: friction = 0.6 of wall-1: the material shears at sin(33 degrees)",
     "{from=0.15, to=0.2, friction=0.54}"),
    ("{from=0.09, to=0.2}", "walls: from = 0.09 m of wall-1 is 0 cells from the column", "{from=0.0975, to=0.2}"),
    ("{from=1, to=1.1}", "walls: from = 1 m of wall-1 is beyond the expected front", "{from=0.2, to=0.3}"),
]  # fmt: skip
SOFTENING = [
    (["material.friction_residual_deg=0.5"], "material.friction_residual_deg = 0.5"),
    (["material.dilatancy_residual_deg=6"], "material.dilatancy_residual_deg = 6"),
]


MU_I = ("geometry.base=rigid", "method.wall_impulse=true")  # of mu-i-cylinder, whose mu_2 is 0.643
MU_I_NOTE = "friction.floor = 0.9 (42 degrees): the column shears at mu_2 = 0.643 of the pressure before it slides"


def warnings_of(case: str, *overrides: str) -> list[str]:
    """Warnings of a case, without those of lengths that are rounded to whole cells."""
    return [text for text in discretize(load_case(case, overrides)).warnings if " became " not in text]


@pytest.mark.parametrize(("overrides", "beginning", "proposed"), UNFIT, ids=[str(one[0]) for one in UNFIT])
def test_an_unfit_setting_is_reported_and_its_remedy_is_not(
    overrides: list[str], beginning: str, proposed: str
) -> None:
    (warning,) = warnings_of("lube-channel", *SAND, *overrides)
    assert warning.startswith(beginning) and "\n" not in warning
    assert proposed.partition("=")[2] in warning.partition("set")[2]
    assert warnings_of("lube-channel", *SAND, *overrides, proposed) == []


@pytest.mark.parametrize(("walls", "beginning", "proposed"), WALLS)
def test_an_unfit_wall_is_reported(walls: str, beginning: str, proposed: str) -> None:
    (warning,) = warnings_of("frictional-floor", f"walls=[{walls}]")
    assert warning.startswith(beginning) and "\n" not in warning
    assert warnings_of("frictional-floor", f"walls=[{proposed}]") == []


def test_friction_is_compared_with_the_largest_that_each_law_mobilises() -> None:
    (warning,) = warnings_of("mu-i-cylinder", *MU_I, "friction.floor=0.9")
    assert warning.startswith(MU_I_NOTE) and "set less than 0.643" in warning
    assert warnings_of("mu-i-cylinder", *MU_I, "friction.floor=0.64") == []
    (warning,) = warnings_of("mu-i-cylinder", *MU_I, "walls=[{from=0.2, to=0.25, friction=0.65}]")
    assert "the material shears at mu_2 = 0.643" in warning
    matched = (
        'material={law="drucker-prager", friction_deg=33, match="compression", density=2650, youngs_modulus=3.5e6, '
    )
    matched += "poissons_ratio=0.2}"
    (warning,) = warnings_of("frictional-floor", matched, "friction.floor=0.8")
    assert "the column shears at mu = 0.768" in warning
    assert warnings_of("frictional-floor", matched, "friction.floor=0.75") == []
    elastic = matched.replace("drucker-prager", "elastic").replace(' friction_deg=33, match="compression",', "")
    assert warnings_of("frictional-floor", elastic, "friction.floor=5") == []
    clay = ("material.friction_deg=0", "material.cohesion=500")
    assert warnings_of("frictional-floor", *clay, "walls=[{from=0.2, to=0.25, friction=0.1}]") == []


def test_a_bed_has_as_many_cells_as_it_is_rounded_to() -> None:
    """19.6 mm of cells of 5.105 mm: 3.9, which become four."""
    quarter = ("geometry.base=granular", "method.wall_impulse=true")
    warnings = discretize(load_case("lube-quarter", quarter)).warnings
    assert any("geometry.base_thickness became 0.0204211 m (+2.11%), 4 whole cells" in text for text in warnings)
    assert not any("the granular bed has only" in text for text in warnings)
    (warning,) = warnings_of("lube-channel", *SAND, *BED, "geometry.base_thickness=0.005")
    assert "has only 1 cell, and" in warning


@pytest.mark.parametrize(("overrides", "beginning"), SOFTENING)
def test_residual_angles_are_those_that_last(overrides: list[str], beginning: str) -> None:
    (warning,) = warnings_of("lube-channel-dense", *overrides)
    assert warning.startswith(beginning)


@pytest.mark.parametrize(
    ("ratio", "overrides", "stands"),
    [
        (1.9, (), True),  # without tensile strength: stands up to 2, falls from 2.67
        (2.1, (), False),
        (3.4, ("material.tension=@",), True),  # with that of the apex: the slip circle falls at 3.83
        (3.6, ("material.tension=@",), False),
        (1.9, ("geometry.base=granular", "geometry.base_thickness=0.2"), False),  # the bed may fail below it
        (1.9, ("geometry.slope_deg=10",), False),
        (1.9, ("layers=[{to=0.5, material={cohesion=0.0}}]",), False),
        (3.4, ("material.tension=@", "geometry.model=axisymmetric"), False),
        (1.9, ("geometry.model=axisymmetric",), True),
    ],
)
def test_a_column_whose_cohesion_carries_it_is_reported(ratio: float, overrides: tuple[str, ...], stands: bool) -> None:
    """Ratio: rho g h_i / (c tan(45 deg + phi/2)) with phi = 30 degrees; @: the apex of the cone, c cot(phi)."""
    cohesion = 1800.0 * 9.81 / 3.0**0.5 / ratio
    given = [text.replace("@", str(0.999 * cohesion * 3.0**0.5)) for text in overrides]
    found = warnings_of("cohesive-column", f"material.cohesion={cohesion}", *given)
    assert any("stands up to" in text for text in found) == stands


def test_snapshots_after_the_end_are_reported() -> None:
    (warning,) = warnings_of("lube-channel", *SAND, "output.times=[0.1, 100]")
    assert warning.startswith("output.times: 100 s is after the end of the run, at most 0.9578 s after the release")
    assert warnings_of("lube-channel", *SAND, "output.times=[0.1, 0.957]") == []


def test_locking_is_named_with_a_large_poissons_ratio_only_where_it_occurs() -> None:
    locking, averaged = (
        warnings_of("lube-channel", *SAND, "material.poissons_ratio=0.4999999", f"method.volumetric_strain={how}")
        for how in ("point", "cell")
    )
    assert 'method.volumetric_strain = "cell"' in locking[0] and "volumetric_strain" not in averaged[0]


def test_the_stiffest_material_causes_the_number_of_steps() -> None:
    (warning,) = warnings_of("lube-channel", *SAND, "base_material.youngs_modulus=1e15")
    assert warning.startswith("base_material.youngs_modulus = 1e+15 Pa: the run")


@pytest.mark.parametrize(
    ("layer", "beginning"),
    [
        ("to=45, material={friction_deg=22}", "layers.0.to = 45 m is above the column, whose top is at 0.18 m"),
        ("to=0.18001, material={friction_deg=22}", ""),  # rounded
        ("to=0.045", "layers.0.material has the values of the column's material: the layer has no effect"),
        ("to=0.045, material={density=2650}", "layers.0.material has the values"),
    ],
)
def test_a_layer_without_effect_or_above_the_column_is_reported(layer: str, beginning: str) -> None:
    found = warnings_of("layered-column", f"layers=[{{{layer}}}]")
    assert len(found) == bool(beginning) and all(text.startswith(beginning) for text in found)


def test_gravity_is_named_before_the_stiffness_that_it_makes_too_small() -> None:
    wrong = load_case("lube-channel", [*SAND, "geometry.gravity=981", "material.youngs_modulus=1e5"])
    with pytest.raises(UsageError, match=r"^geometry.gravity = 981 m/s2 is 100 times .*; material.youngs_modulus"):
        require_stiff_column(wrong)
    gravity, stiffness = warnings_of("lube-channel", *SAND, "geometry.gravity=981")
    assert gravity.startswith("geometry.gravity = 981") and stiffness.startswith("material.youngs_modulus")


def test_large_numbers_are_short() -> None:
    heavy = load_case("lube-channel", [*SAND, "material.density=1e30"])
    with pytest.raises(UsageError, match=r"is 3.97e\+22 times its height"):
        require_stiff_column(heavy)
    with pytest.raises(UsageError, match=r"^grid.spacing = 1e-12 m: .* need \S{8} GB"):
        require_memory_for(discretize(load_case("lube-channel", [*SAND, "grid.spacing=1e-12"])))


@pytest.mark.parametrize("name", shipped_cases())
def test_shipped_cases_cause_no_warning(name: str) -> None:
    assert warnings_of(name) == []


def test_lengths_that_change_by_round_off_are_not_reported() -> None:
    spacings = ("0.003214286", "0.0032143", "0.003214", "0.003")
    found = [
        discretize(load_case("bui-rods", ["geometry.radius=0.09", f"grid.spacing={h}"])).warnings for h in spacings
    ]
    assert [len(warnings) for warnings in found] == [0, 0, 1, 0] and "(+0.01%)" in found[2][0]


def test_a_column_that_its_own_weight_compresses_by_a_third_is_refused(tmp_path: Path) -> None:
    """By every command that would run it: its shortening is rho g h_i / (2 E_oed)."""
    limit = 1.5 * 2650.0 * 9.81 * 0.09 * 0.9  # E_oed = E / 0.9 at nu = 0.2
    softer, stiffer = (f"material.youngs_modulus={factor * limit}" for factor in (0.99, 1.01))
    require_stiff_column(load_case("lube-channel", [*SAND, stiffer]))
    for command, *options in (("check",), ("run", "--dry-run"), ("run", "--out", tmp_path / "run")):
        refused = invoke(command, "lube-channel", *options, *set_options((*SAND, softer)))
        assert refused.exit_code == 2
        assert re.search(r"of its height, more than a third[;\s]+set \S+ Pa or more", refused.output)
    refused = invoke("sweep", "lube-channel", "--dry-run", *set_options((*SAND[1:], softer)), "--aspect", "0.1,1")
    assert refused.exit_code == 2 and "run a1: material.youngs_modulus" in refused.output
    assert not (tmp_path / "run/case.resolved.toml").exists()


def test_a_soft_layer_and_a_soft_bed_shorten_the_column_as_a_stiff_one_does_not() -> None:
    """Half of it n times softer: the shortening is (3 n + 1) / 4 or (n + 3) / 4 of the uniform one."""
    uniform = elastic_shortening(load_case("layered-column", ["layers=[]"]))
    soft = "material = { youngs_modulus = 2e5 }"
    lower, upper = (
        elastic_shortening(load_case("layered-column", [f"layers=[{{ from = {low}, to = {high}, {soft} }}]"]))
        for low, high in ((0.0, 0.09), (0.09, 0.18))
    )
    assert lower == pytest.approx(uniform * (3.0 * 10.0 + 1.0) / 4.0) and upper == pytest.approx(uniform * 13.0 / 4.0)
    bed = load_case("granular-bed", ["base_material.youngs_modulus=2e3"])
    with pytest.raises(UsageError, match=r"base_material.youngs_modulus = 2000 Pa: the elastic shortening of the bed"):
        require_stiff_column(bed)
    with pytest.raises(UsageError, match=r"layers.0.material.youngs_modulus = 2000 Pa: .* the sum over its layers"):
        require_stiff_column(load_case("layered-column", ["layers.0.material.youngs_modulus=2e3"]))


@pytest.mark.parametrize(("cells", "is_thin"), [(1.0, True), (1.9, True), (2.0, False), (10.0, False)])
def test_a_layer_of_less_than_two_cells_is_reported(cells: float, is_thin: bool) -> None:
    h = 0.0045
    layers = f"layers=[{{from=0, to=0.045}}, {{from=0.045, to={0.045 + cells * h}, material={{friction_deg=22}}}}]"
    found = [text for text in warnings_of("layered-column", layers) if "the layer of" in text]
    assert len(found) == is_thin
    if is_thin:
        assert found[0].startswith("layers.1: ") and f"set grid.spacing = {cells * h / 2.0:.4g} m or less" in found[0]


def test_a_run_reports_an_unfit_setting_once_and_records_it(tmp_path: Path) -> None:
    messages: list[str] = []
    case = load_case("coarse-channel", [*TINY, "stages.collapse.max_time_factor=0.1", "material.friction_deg=0.5236"])
    results = mpmcol.run(case, tmp_path, notify=messages.append)
    (warning,) = (text for text in results.summary["warnings"] if text.startswith("material.friction_deg"))
    assert messages.count(f"note: {warning}") == 1


def test_more_threads_than_cores_are_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    assert available_cores() >= 1
    monkeypatch.setattr(cores, "available_cores", lambda: 2)
    assert "8 threads on 2 cores: no faster than 2" in (thread_note(8) or "")
    assert thread_note(2) is thread_note(1) is None


def test_warnings_of_one_kind_differ_in_numbers_only() -> None:
    settings = ("material.dilatancy_deg=10", "material.dilatancy_deg=12.5", "material.density=2.65")
    one, other, third = (kind_of(*warnings_of("lube-channel", setting)) for setting in settings)
    assert one == other != third
