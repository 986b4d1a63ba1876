"""Charts, `measure` and the summary table of a 3D deposit: means around the axis, and their ranges."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from mpmcol.api import measured
from mpmcol.case import load_case
from mpmcol.cli.measure import measure as measure_command
from mpmcol.cli.run_summary import summary_table
from mpmcol.experiments import EXPERIMENTS, score
from mpmcol.measure import FRONTS, ColumnShape, Measurement, measure
from mpmcol.plotting import charts
from mpmcol.plotting.run_charts import chart_run
from tests.support.cli import csv_row
from tests.support.figures import recorded_figures

QUARTER = ColumnShape("quarter", "one-sided", r_i=0.1, h_i=0.09, spacing=0.005, density=2650.0, point_size=0.0025)
BOX = replace(QUARTER, section="box")
SIZE = ("geometry.radius=0.1", "geometry.aspect=0.9")


def deposit(shape: ColumnShape, spread: float = 0.9) -> Measurement:
    """A cone whose base is an ellipse, by a fifth longer along x than along z, or a wedge of a box."""
    size, length = shape.point_size, shape.r_i * (1.0 + spread)
    x, y, z = np.meshgrid(*(np.arange(size / 2, end, size) for end in (1.2 * length, 0.06, length)), indexing="ij")
    slope = np.hypot(x / 1.2, z) if shape.has_sectors else x
    points = np.column_stack([values[y < 0.06 * (1.0 - slope / length)] for values in (x, y, z)])
    return measure(points, np.full(len(points), shape.density * size**3), np.zeros_like(points), shape)


def run_of(shape: ColumnShape, folder: Path) -> SimpleNamespace:
    """A synthetic run at rest; `summary` is the content of its result.json."""
    measured, ones = deposit(shape), np.ones(3)
    summary = measured.scalars() | {
        "errors": [entry.as_dict() for entry in score(measured, shape.a, shape.model, shape.section)],
        "wall_s": {"collapse": 1.0}, "ledger": {"residual": 0.0}, "at_rest": True, "ns_per_point_step": 100.0,
        "points": 1, "steps": 1, "dt": 1e-5, "threads": 1, "time_over_tau": 3.0, "worst_J": [1.0, 1.0],
        "energy_unit": "J of the quarter that is modelled",
    }  # fmt: skip
    history = dict.fromkeys([*FRONTS, *charts.ENERGY_STYLES, "height", "potential", "residual"], ones)
    history |= {"stage": np.array(["collapse"] * 3), "time": np.arange(3.0)}
    return SimpleNamespace(
        folder=folder, shape=shape, snapshots=[folder], status="done", came_to_rest=True,
        history=history, released_history=history,
        case=load_case("lube-quarter", [*SIZE, f"geometry.section={shape.section}"]),
        summary=json.loads(json.dumps(summary)), measure=lambda number: measured,
        snapshot=lambda number: SimpleNamespace(stage="rest", time=0.3), wall_pressure={},
        erosion=None, fall_time=shape.fall_time(9.81),
    )  # fmt: skip


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """A synthetic run of a quarter, which the commands find in every folder."""
    synthetic = run_of(QUARTER, tmp_path)
    monkeypatch.setattr(measured, "as_results", lambda run: synthetic)
    return synthetic


@pytest.fixture
def figures(monkeypatch: pytest.MonkeyPatch) -> list[Figure]:
    return recorded_figures(monkeypatch, charts, saved=True)


def invoke(run: SimpleNamespace, *options: str) -> str:
    outcome = CliRunner().invoke(measure_command, [str(run.folder), *options], catch_exceptions=False)
    assert outcome.exit_code == 0
    return outcome.output


def test_measure_prints_the_mean_and_the_range_around_the_axis(run: SimpleNamespace) -> None:
    measured, lines = run.measure(-1), invoke(run).splitlines()
    low, high = measured.zeta_range["front_height"]
    assert low < measured.zeta["front_height"] - 0.05 and high > measured.zeta["front_height"] + 0.05
    line = next(text for text in lines if text.startswith("front_height"))
    assert line.endswith(f"zeta {measured.zeta['front_height']:7.3f}   {low:.3f} to {high:.3f} around the axis")
    assert any(text.startswith("quarter, cylinder, a = 0.9") for text in lines)
    assert any(text.startswith("Lube et al. 2004") and "1.116" in text for text in lines)


def test_json_and_csv_contain_mean_and_range(run: SimpleNamespace) -> None:
    record = json.loads(invoke(run, "--json"))
    row = csv_row(invoke(run, "--csv"))
    for name in FRONTS:
        for end in ("mean", "min", "max"):
            assert float(row[f"zeta.{name}.{end}"]) == pytest.approx(record["zeta"][name][end], rel=1e-5)
            assert record["front"][name] == run.summary["front"][name]
    assert float(row["beta"]) == pytest.approx(record["beta"], rel=1e-5)


def test_summary_table_has_the_mean_and_the_range_around_the_axis(run: SimpleNamespace) -> None:
    table = summary_table(run).splitlines()  # type: ignore[arg-type]
    number = next(i for i, text in enumerate(table) if text.startswith("zeta, front_max"))
    zeta, front = (run.summary[name]["front_max"] for name in ("zeta", "front"))
    assert f"{1e3 * front['mean']:.4g}" in table[number] and f"{zeta['mean']:8.3f}   1.116 (" in table[number]
    assert table[number + 1].strip() == f"{zeta['min']:.3f} to {zeta['max']:.3f} around the axis"
    assert sum(text.startswith("zeta, ") for text in table) == 3


def test_profile_chart_shows_the_range_of_the_front_around_the_axis(tmp_path: Path, figures: list[Figure]) -> None:
    final = deposit(QUARTER, 1.3)
    charts.profile_chart(tmp_path / "p.png", QUARTER, [(0.3, final)], EXPERIMENTS["lube-2004"])
    axes = figures[0].axes[0]
    assert axes.get_xlabel() == "radius (mm)" and axes.get_ylabel() == "mean height around the axis (mm)"
    (band,) = (patch for patch in axes.patches if isinstance(patch, Rectangle))
    assert final.front_range is not None
    low, high = (1e3 * end for end in final.front_range["front_height"])
    assert (band.get_x(), band.get_x() + band.get_width()) == pytest.approx((low, high))
    assert axes.get_xlim()[1] > 1e3 * final.max_distance > 1.05e3 * final.front["front_max"]
    column = next(line for line in axes.lines if line.get_label() == "column at release")
    assert np.asarray(column.get_xydata()).tolist() == [[0.0, 90.0], [100.0, 90.0], [100.0, 0.0]]
    marks = [str(line.get_label()) for line in axes.lines if str(line.get_label()).startswith("front_height")]
    assert marks == [f"front_height: {1e3 * final.front['front_height']:.1f} mm ({low:.1f} to {high:.1f})"]


def test_a_box_is_drawn_along_x_and_without_an_experiment(tmp_path: Path, figures: list[Figure]) -> None:
    paths = chart_run(run_of(BOX, tmp_path))  # type: ignore[arg-type]
    assert [path.stat().st_size > 1000 for path in paths] == [True] * 3
    axes = figures[0].axes[0]
    assert not axes.containers
    assert axes.get_xlabel() == "distance from the axis along x (mm)" and axes.get_ylabel() == "height (mm)"


def test_summary_table_of_a_box_has_ranges_along_x_and_no_law(tmp_path: Path) -> None:
    box = run_of(BOX, tmp_path)
    table = summary_table(box)  # type: ignore[arg-type]
    assert "no published collapse of a box" in table and "relative to" not in table
    zeta = box.summary["zeta"]["front_height"]
    assert f"{zeta['mean']:8.3f}\n" in table and f"{zeta['min']:.3f} to {zeta['max']:.3f} along x" in table


def test_measure_of_a_box_has_no_errors(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    box = run_of(BOX, tmp_path)
    monkeypatch.setattr(measured, "as_results", lambda run: box)
    assert json.loads(invoke(box, "--json"))["scores"] == []
    assert invoke(box).splitlines()[2].startswith("quarter, box, a = 0.9")
