"""Runs of columns that an outline describes: heaps, a trapezoid behind a gate, and rectangles."""

from __future__ import annotations

from math import radians, tan
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.figure import Figure

import mpmcol
from mpmcol.io.results import Results
from mpmcol.plotting.captions import run_names
from mpmcol.plotting.profiles import LengthAxes, set_up_axes
from mpmcol.plotting.render.coloring import COLORINGS
from mpmcol.plotting.render.side import SideView, fit_view
from tests.support.cli import invoke
from tests.support.runs import TINY

WIDTH, SPACING = 0.3, 0.02
RIGID = (
    "geometry.base=rigid", "method.wall_impulse=true", f"grid.spacing={SPACING}", "output.snapshots=6",
    "stages.collapse.end=time",
)  # fmt: skip


def outline_of_heap(degrees: float) -> str:
    return f"geometry.outline=[[0, 0], [{WIDTH}, 0], [0, {WIDTH * tan(radians(degrees))}]]"


def heap(folder: Path, degrees: float, *overrides: str) -> Results:
    """A run of a heap on a rigid floor that stands free, for 10 sqrt(h_i / g) after its release; phi is 33 degrees."""
    case = mpmcol.load_case("coarse-channel", [outline_of_heap(degrees), "stages.gate=false", *RIGID, *overrides])
    return mpmcol.run(case, folder, threads=1)


def largest_displacement(results: Results) -> float:
    """Largest displacement since the release of all points in all snapshots, over h."""
    snapshots = [results.snapshot(k) for k in range(len(results.snapshots))]
    lengths = [np.linalg.norm(one.arrays["displacement"][one.column], axis=1).max() for one in snapshots]
    return float(max(lengths)) / SPACING


@pytest.fixture(scope="module")
def steep(tmp_path_factory: pytest.TempPathFactory) -> Results:
    return heap(tmp_path_factory.mktemp("steep") / "run", 40.0)


@pytest.mark.parametrize(
    "overrides",
    [
        ("geometry.release=two-sided", "stages.equilibrate.law=mohr-coulomb"),
        ("geometry.model=axisymmetric", "stages.initial_stress=k0"),
    ],
    ids=str,
)
def test_a_heap_with_slopes_below_repose_stands(overrides: tuple[str, ...], tmp_path: Path) -> None:
    results = heap(tmp_path / "run", 25.0, *overrides)
    assert results.summary["time_over_tau"] == pytest.approx(10.0, rel=1e-3)
    assert largest_displacement(results) < 0.05
    assert abs(results.summary["ledger"]["residual"]) < 1e-12 * results.summary["ledger"]["potential"]
    assert not any("released energy" in warning for warning in results.summary["warnings"])


def test_a_steep_heap_keeps_its_shape_until_the_release_and_then_flows(steep: Results) -> None:
    assert steep.measure(0).height == pytest.approx(steep.shape.h_i, rel=0.03)
    assert largest_displacement(steep) > 5.0
    measured = steep.measure()
    assert measured.zeta["front_height"] > 0.1 and measured.beta < 0.8
    assert 15.0 < (measured.repose_angle_deg or 0.0) < 33.0
    assert abs(steep.summary["ledger"]["residual"]) < 1e-12 * steep.summary["ledger"]["potential"]


def test_an_outline_is_not_compared_with_laws_of_the_aspect_ratio(steep: Results) -> None:
    reason = "no published collapse of a column that is no rectangle"
    assert steep.summary["errors"] == steep.summary["profile_scores"] == []
    shown = invoke("measure", steep.folder).stdout
    assert shown.endswith(f"{reason}\n") and "outline of 3 points, r_i = 300 mm" in shown
    again = invoke("run", steep.folder / "case.resolved.toml", "--out", steep.folder)
    assert reason in again.output and "not studied for outlines" in again.output and "Lube" not in again.output
    assert "the shipped study has no outline columns" in invoke("plan", steep.folder / "case.resolved.toml").output


def test_charts_and_renderings_show_the_outline_and_no_gate(steep: Results) -> None:
    outline = np.array([(0.0, 0.0), (WIDTH, 0.0), (0.0, steep.shape.h_i), (0.0, 0.0)]).T
    axes = Figure().add_subplot()
    set_up_axes(LengthAxes(axes, "m", 1.0), steep.shape, [steep.measure()], 0.0)
    assert [line.get_label() for line in axes.lines][:2] == ["column at release", "_child1"]  # no line of a gate
    assert np.array_equal(np.array(axes.lines[0].get_data()), outline)
    view = fit_view(steep.snapshots[:1], (400, 300), COLORINGS["displacement"])
    assert isinstance(view, SideView)
    drawn = Figure().add_subplot()
    view.draw_before(drawn)
    assert any(np.array_equal(np.array(line.get_data()), outline) for line in drawn.lines)
    assert not any("gate" in text.get_text() for text in drawn.texts)


def test_runs_that_differ_in_the_outline_are_named_by_their_folders() -> None:
    runs = [
        SimpleNamespace(case=mpmcol.load_case("coarse-channel", [outline_of_heap(slope)]), folder=Path(f"at-{slope}"))
        for slope in (20, 30)
    ]
    assert run_names(runs) == ["at-20", "at-30"]  # type: ignore[arg-type]


def test_a_trapezoid_behind_a_gate_is_held_until_the_release(tmp_path: Path) -> None:
    trapezoid = "geometry.outline=[[0, 0], [0.2, 0], [0.2, 0.14], [0, 0.2]]"  # its top slopes towards the gate
    case = mpmcol.load_case("coarse-channel", [trapezoid, *RIGID, "stages.collapse.max_time_factor=4"])
    results = mpmcol.run(case, tmp_path / "run", threads=1)
    released, last = results.snapshot(0), results.snapshot(-1)
    assert released.x[released.column, 0].max() < 0.2
    stress = released.arrays["stress"][released.column]
    at_gate = (released.x[released.column, 0] > 0.2 - SPACING) & (released.x[released.column, 1] < 0.1)
    assert 0.2 < stress[at_gate, 0].sum() / stress[at_gate, 1].sum() < 0.6  # earth pressure: K_a is 0.29
    assert last.x[last.column, 0].max() > 0.3
    mass = released.arrays["mass"][released.column].sum(dtype=np.float64)
    assert mass == pytest.approx(2650.0 * 0.5 * 0.2 * (0.2 + 0.14), rel=1e-6)  # stored as float32
    assert abs(results.summary["ledger"]["residual"]) < 1e-12 * results.summary["ledger"]["potential"]


@pytest.mark.parametrize(("model", "stress"), [("plane", "gravity"), ("axisymmetric", "k0")])
def test_a_rectangle_as_outline_has_equal_bits(model: str, stress: str, tmp_path: Path) -> None:
    sizes = {
        "column": ["geometry.radius=0.09", "geometry.height=0.1"],
        "outline": ['geometry.outline=[[0, 0.1], ["9 cm", 0.1], [0.09, 0], [0, 0]]'],
    }
    states = [
        mpmcol.run(
            mpmcol.load_case(
                "coarse-channel", [*size, *TINY, f"geometry.model={model}", f"stages.initial_stress={stress}"]
            ),
            tmp_path / name,
            threads=1,
        ).summary
        for name, size in sizes.items()
    ]
    assert states[0]["state_sha256"] == states[1]["state_sha256"]
    assert states[0]["errors"] == states[1]["errors"]


def test_check_and_dry_run_count_the_points_of_the_area() -> None:
    values = ("--set", outline_of_heap(45.0), "--set", "stages.gate=false")
    assert "plane, outline of 3 points, mohr-coulomb, r_i = 0.3 m" in invoke("check", "coarse-channel", *values).output
    full = invoke("sweep", "coarse-channel", "--dry-run", "--json", *values, "--set", "geometry.base=rigid").stdout
    assert '"points": 7200' in full  # half of 60 x 60 cells with 4 points each
    steep = invoke("check", "coarse-channel", *values[:2]).output
    assert "note: stages.gate = true: nothing holds the slope in the first stage" in steep
    assert "set stages.gate = false" in steep
