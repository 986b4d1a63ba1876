"""Table of a sweep, as CSV and HDF5, and its charts, from synthetic results."""

from __future__ import annotations

import json
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text

from mpmcol.case import load_case
from mpmcol.cli.sweep_display import as_record, summary_lines
from mpmcol.errors import OutputError
from mpmcol.experiments import score
from mpmcol.io.run_folder import write_result
from mpmcol.plotting.figures import MOST_ENTRIES
from mpmcol.plotting.styles import EXPERIMENT_STYLES
from mpmcol.sweep import charts
from mpmcol.sweep.axes import parse_axes
from mpmcol.sweep.engine import Outcome
from mpmcol.sweep.report import write_report
from mpmcol.sweep.runs import PlannedRun, plan_runs
from mpmcol.sweep.table import make_rows, read_table
from mpmcol.sweep.task import TaskResult

FRONTS = ("front_max", "front_connected", "front_height")


def finish(run: PlannedRun, at_rest: bool = True, warnings: Sequence[str] = ()) -> Outcome:
    """Write a result whose runout is 5 % above the law by front_max and equal to it by front_height."""
    geometry = run.case.geometry
    law = 1.24 * geometry.a if geometry.a < 1.7 else 1.6 * geometry.a**0.5
    zeta: dict[str, Any] = dict(zip(FRONTS, (1.05 * law, 1.02 * law, law), strict=True))
    measured = {"zeta": zeta, "beta": 0.88 * geometry.a ** (-5 / 6)}
    errors = [entry.as_dict() for entry in score(measured, geometry.a, geometry.model, geometry.section)]
    if geometry.dimension == 3:
        zeta = {name: {"mean": value, "min": value - 0.1, "max": value + 0.1} for name, value in zeta.items()}
    result = {
        "schema": 1, "status": "done", "zeta": zeta, "beta": measured["beta"], "height": 0.05, "at_rest": at_rest,
        "undisturbed_radius": None, "errors": errors, "profile_scores": [], "points": 848, "steps": 7997,
        "wall_s": {"compile": 2.0, "collapse": 5.0}, "ns_per_point_step": 50.5, "threads": 1, "r_i": 0.097,
        "versions": {"mpmcol": "0.1.0+00000000", "numpy": "2.0"}, "warnings": list(warnings),
    }  # fmt: skip
    run.folder.mkdir(parents=True, exist_ok=True)
    write_result(run.folder, result)
    return Outcome(run, TaskResult("done", 1))


def fail(run: PlannedRun) -> Outcome:
    run.folder.mkdir(parents=True, exist_ok=True)
    failure = {"cause": "too fast", "remedy": "lower time.cfl"}
    zeta = dict.fromkeys(FRONTS, 9.0)
    write_result(run.folder, {"schema": 1, "status": "failed", "zeta": zeta, "beta": 9.0, "failure": failure})
    return Outcome(run, TaskResult("failed", 1, 3, "too fast; lower time.cfl"))


def plan(out: Path, *settings: str, aspect: str | None = "1,2,3,4", case: str = "lube-cylinder") -> list[PlannedRun]:
    return plan_runs(case, parse_axes(aspect, settings)[0], out)


@pytest.fixture
def figures(monkeypatch: pytest.MonkeyPatch) -> dict[str, Figure]:
    drawn: dict[str, Figure] = {}
    save = charts.save_figure

    def keep(figure: Figure, path: Path, svg: bool) -> list[Path]:
        drawn[path.name] = figure
        return save(figure, path, svg)

    monkeypatch.setattr(charts, "save_figure", keep)
    return drawn


def labels(figure: Figure) -> list[str]:
    return [text.get_text() for text in figure.legends[0].get_texts()]


def test_a_row_has_inputs_measurements_errors_cost_and_versions(tmp_path: Path) -> None:
    runs = plan(tmp_path, "material.friction_deg=33,36", aspect="2")
    row, _ = make_rows([finish(run) for run in runs])
    zeta = 1.6 * 2**0.5
    assert row["folder"] == runs[0].folder.name and row["status"] == "done"
    assert (row["geometry.aspect"], row["material.friction_deg"], row["a"]) == (2.0, 33.0, 2.0)
    assert [row[f"zeta.{name}"] for name in FRONTS] == pytest.approx([1.05 * zeta, 1.02 * zeta, zeta])
    assert row["law.zeta"] == pytest.approx(zeta) and row["law.beta"] == pytest.approx(row["beta"])
    assert row["law.unverified"] == ""
    assert row["error.lube-2004.zeta.front_max"] == pytest.approx(0.05)
    assert row["error.lube-2004.beta"] == pytest.approx(0.0)
    assert row["error.lajeunesse-2004.zeta.front_height"] == pytest.approx(zeta / (2.0 * 2**0.5) - 1.0)
    assert (row["seconds"], row["compile_seconds"], row["steps"], row["points"]) == (7.0, 2.0, 7997, 848)
    assert (row["ns_per_point_step"], row["version.mpmcol"]) == (50.5, "0.1.0+00000000")


def test_a_failed_run_has_a_message_and_no_measurements(tmp_path: Path) -> None:
    one, two = plan(tmp_path, aspect="1,2")
    rows = make_rows([fail(one), finish(two)])
    assert list(rows[0]) == list(rows[1])
    assert (rows[0]["status"], rows[0]["message"]) == ("failed", "too fast; lower time.cfl")
    assert rows[0]["zeta.front_max"] is None and rows[0]["beta"] is None and rows[0]["law.zeta"] == 1.24


def test_the_mean_in_3d_has_the_same_name_as_the_value_in_2d(tmp_path: Path) -> None:
    flat, full = (plan(tmp_path, aspect="2", case=case)[0] for case in ("lube-cylinder", "lube-quarter"))
    rows = make_rows([finish(flat), finish(full)])
    assert rows[0]["zeta.front_max"] == pytest.approx(rows[1]["zeta.front_max"])
    assert rows[0]["zeta.front_max.min"] is None
    assert rows[1]["zeta.front_max.max"] - rows[1]["zeta.front_max.min"] == pytest.approx(0.2)


def test_notes_are_on_results_and_have_the_number_of_their_runs(tmp_path: Path) -> None:
    """What was said of the plan before the runs is not repeated."""
    runs = plan(tmp_path, "grid.spacing=0.02", aspect="1,2,3")
    planned = [run.discretization.warnings for run in runs]
    more = [(), ("damping took 30 %",), ("damping took 31 %",)]
    found = [[*known, *new] for known, new in zip(planned, more, strict=True)]
    assert all(planned)
    report = write_report([finish(run, warnings=one) for run, one in zip(runs, found, strict=True)], tmp_path)
    assert report.notes == ["damping took 30 % (2 of 3 runs, with the numbers of the first)"]
    assert f"note: {report.notes[0]}" in list(summary_lines(report)) and as_record(report)["notes"] == report.notes


def test_csv_and_hdf5_have_the_same_content(tmp_path: Path) -> None:
    runs = plan(tmp_path)
    report = write_report([fail(runs[0]), *map(finish, runs[1:])], tmp_path)
    rows = read_table(tmp_path / "table.csv")
    with h5py.File(tmp_path / "table.h5") as file:
        assert set(file) - {"case"} == set(rows[0])
        assert file["zeta.front_max"].attrs["unit"] == "1" and file["height"].attrs["unit"] == "m"
        assert file["folder"].asstr()[:].tolist() == [row["folder"] for row in rows]
        beta = file["beta"][:]
        assert np.isnan(beta[0]) and rows[0]["beta"] == ""
        assert beta[1:].tolist() == [float(row["beta"]) for row in rows[1:]]
        (tmp_path / "one.toml").write_text(file["case"].asstr()[2])
    assert load_case(tmp_path / "one.toml") == runs[2].case
    assert rows[1]["at_rest"] == "true"
    assert {path.name for path in report.files} == {"table.csv", "table.h5", "slopes.csv", "zeta.png", "beta.png"}


def test_intervals_of_finer_grids_are_those_of_the_statements(tmp_path: Path) -> None:
    one, two = (finish(run) for run in plan(tmp_path, aspect="1,2"))
    interval = {"finer_grids": {"low": 1.0, "high": 1.5}}
    statement = one.run.folder / "accuracy.json"
    statement.write_text(json.dumps({"zeta": interval, "beta": interval}))
    first, second = make_rows([one, two])
    names = [f"{name}.finer_grids{end}" for name in ("zeta", "beta") for end in ("", ".low", ".high")]
    assert [first[name] for name in names] == [1.25, 1.0, 1.5] * 2 and not any(second[name] for name in names)
    statement.write_text('{"zeta": 1}')
    with pytest.raises(OutputError, match=r"accuracy.json is damaged .*; delete it and repeat the `mpmcol sweep`"):
        make_rows([one, two])


def test_slopes_of_other_runs_do_not_stay_in_the_folder(tmp_path: Path) -> None:
    runs = [finish(run) for run in plan(tmp_path, aspect="2,3,4")]
    write_report(runs, tmp_path)
    assert (tmp_path / "slopes.csv").exists()
    write_report(runs[:1], tmp_path)
    assert not (tmp_path / "slopes.csv").exists()


def test_charts_of_other_runs_do_not_stay_in_the_folder(tmp_path: Path) -> None:
    runs = [finish(run) for run in plan(tmp_path, "geometry.model=plane,axisymmetric", aspect="2")]
    for shown, names in ((runs, {"-plane", "-axisymmetric"}), (runs[:1], {""}), (runs, {"-plane", "-axisymmetric"})):
        write_report(shown, tmp_path)
        found = {path.name for path in tmp_path.glob("*.png")}
        assert found == {f"{quantity}{name}.png" for quantity in ("zeta", "beta") for name in names}


def test_units_of_inputs_are_those_of_the_case(tmp_path: Path) -> None:
    runs = plan(tmp_path, "material.friction_deg=33", "grid.spacing=5 mm", aspect="1")
    write_report([finish(run) for run in runs], tmp_path)
    with h5py.File(tmp_path / "table.h5") as file:
        assert [file[key].attrs["unit"] for key in ("material.friction_deg", "grid.spacing", "a")] == ["deg", "m", "1"]
        assert file["grid.spacing"][0] == 0.005


def test_files_that_are_up_to_date_are_not_written_again(tmp_path: Path) -> None:
    outcomes = [finish(run) for run in plan(tmp_path)]
    files = write_report(outcomes, tmp_path).files
    before = [path.stat().st_mtime_ns for path in files]
    write_report([Outcome(outcome.run, TaskResult("done", 0)) for outcome in outcomes], tmp_path)
    assert [path.stat().st_mtime_ns for path in files] == before
    (tmp_path / "beta.png").unlink()
    write_report(outcomes, tmp_path)
    assert (tmp_path / "beta.png").exists()
    before = [path.stat().st_mtime_ns for path in files]
    finish(outcomes[0].run, at_rest=False)
    write_report(outcomes, tmp_path)
    assert all(path.stat().st_mtime_ns > old for path, old in zip(files, before, strict=True))


def test_without_a_finished_run_only_the_table_is_written(tmp_path: Path) -> None:
    report = write_report([fail(run) for run in plan(tmp_path)], tmp_path)
    assert [path.name for path in report.files] == ["table.csv", "table.h5"]


def test_charts_have_laws_scatter_transition_and_fits(tmp_path: Path, figures: dict[str, Figure]) -> None:
    runs = plan(tmp_path, "material.friction_deg=29", aspect="0.5,1,2,3,5")  # as of sand and of glass beads
    write_report([*map(finish, runs[:-1]), finish(runs[-1], at_rest=False)], tmp_path)
    zeta, beta = labels(figures["zeta.png"]), labels(figures["beta.png"])
    assert "Lube et al. 2004, scatter 10%" in zeta and "not at rest" in zeta
    beside = [text.get_text() for text in figures["zeta.png"].axes[0].texts]
    assert "Lajeunesse et al. 2004 (unverified)" in beside and len(zeta) <= MOST_ENTRIES
    fit = r"$\zeta \propto a^{0.50}$ (law $a^{0.50}$)"  # a fit of two runs has no uncertainty
    fronts = [label for label in zeta if label.startswith("front_")]
    assert [label.partition(":")[0] for label in fronts] == list(FRONTS)
    assert all(label.endswith(fit) and label.count("propto") == 2 for label in fronts)
    assert "Lube et al. 2004: transition, no law" in beta
    (span,) = [patch for patch in figures["beta.png"].axes[0].patches if patch.get_zorder() == -2]
    assert [span.get_x(), span.get_x() + span.get_width()] == [1.0, 1.7]


def test_a_transition_beyond_the_chart_is_not_in_its_legend(tmp_path: Path, figures: dict[str, Figure]) -> None:
    write_report([finish(run) for run in plan(tmp_path, aspect="3,5,7")], tmp_path)
    assert not any("transition" in label for label in labels(figures["beta.png"]))


def test_only_laws_that_apply_to_every_run_are_drawn(tmp_path: Path, figures: dict[str, Figure]) -> None:
    write_report([finish(run) for run in plan(tmp_path, "material.friction_deg=8,33")], tmp_path)
    for figure in figures.values():
        texts = [text.get_text() for text in figure.axes[0].texts]
        reason = "Lube et al. 2004 does not apply to 4 of 8 runs: for friction of 28 to 40 deg; here it is 8 deg"
        assert any(reason in text.replace("\n", " ") for text in texts)
        assert not any("et al." in text for text in labels(figure))
        assert sum("et al." in text for text in texts) == 1


def test_laws_of_another_material_are_not_drawn(tmp_path: Path, figures: dict[str, Figure]) -> None:
    write_report([finish(run) for run in plan(tmp_path, case="cylinder")], tmp_path)
    shown = [*labels(figures["zeta.png"]), *(text.get_text() for text in figures["zeta.png"].axes[0].texts)]
    assert any("Lube et al. 2004" in text for text in shown) and not any("Lajeunesse" in text for text in shown)


def test_a_run_that_still_moves_is_marked_and_not_compared(tmp_path: Path) -> None:
    one, two = plan(tmp_path, aspect="1,2")
    moving, rest = make_rows([finish(one, at_rest=False), finish(two)])
    errors = [name for name in rest if name.startswith(("error.", "rms_mm."))]
    assert errors and {moving[name] for name in errors} == {None} != {rest[name] for name in errors}
    assert "still moving" in moving["message"] and rest["message"] == ""


def test_the_law_is_drawn_in_its_range(tmp_path: Path, figures: dict[str, Figure]) -> None:
    write_report([finish(run) for run in plan(tmp_path, aspect="0.5,1,5")], tmp_path)
    curves = [
        line
        for line in figures["beta.png"].axes[0].lines
        if line.get_color() == EXPERIMENT_STYLES["Lube et al. 2004"].colour
    ]
    assert [line.get_xdata()[[0, -1]].tolist() for line in curves] == [
        pytest.approx([0.5 / charts.MARGIN, 1.0]), pytest.approx([1.7, 5 * charts.MARGIN]),
    ]  # fmt: skip
    a, beta = curves[1].get_data()
    assert beta == pytest.approx(0.88 * a ** (-5 / 6))


def test_several_series_in_one_chart(tmp_path: Path, figures: dict[str, Figure]) -> None:
    runs = plan(tmp_path, "material.friction_deg=30,36", aspect="2,3,5")
    report = write_report([finish(run) for run in runs], tmp_path)
    shown = labels(figures["zeta.png"])
    for name in ("friction_deg = 30", "friction_deg = 36"):
        (label,) = [text for text in shown if text.startswith(name)]
        assert label.count("propto") == 1
    assert len(report.slopes) == 8
    labels_of = {name: figures[name].axes[0].get_ylabel() for name in ("zeta.png", "beta.png")}
    assert "by front_connected; bars:" in labels_of["zeta.png"] and "bars" not in labels_of["beta.png"]


def test_many_series_are_named_beside_their_last_marker(tmp_path: Path, figures: dict[str, Figure]) -> None:
    runs = plan(tmp_path, "material.friction_deg=28,28.4,28.8,29.2,29.6,30", aspect="2,5")
    write_report([finish(run) for run in runs], tmp_path)
    chart = figures["zeta.png"]
    assert len(labels(chart)) <= MOST_ENTRIES and not any("friction" in label for label in labels(chart))
    beside = [text for text in chart.axes[0].texts if text.get_text().startswith("friction_deg")]
    assert len(beside) == 6
    chart.draw_without_rendering()
    boxes = [Text.get_window_extent(text) for text in chart.axes[0].texts]  # without the lines of the annotations
    edges = sorted((box.y0, box.y1) for box in boxes if box.x0 > chart.axes[0].bbox.x1)
    assert len(edges) == 7 and all(lower[1] <= upper[0] + 1.0 for lower, upper in pairwise(edges))


def test_logarithmic_axes_have_plain_labels(tmp_path: Path, figures: dict[str, Figure]) -> None:
    write_report([finish(run) for run in plan(tmp_path, aspect="0.5,1,7")], tmp_path)
    axes = figures["zeta.png"].axes[0]
    ticks = [tick.get_text() for tick in axes.get_xticklabels()]
    assert {"0.5", "1", "2", "5"} <= set(ticks) and not any("$" in tick for tick in ticks)
    assert axes.get_xscale() == axes.get_yscale() == "log"


def test_charts_have_the_parameters_that_all_runs_share(tmp_path: Path, figures: dict[str, Figure]) -> None:
    write_report([finish(run) for run in plan(tmp_path, "material.friction_deg=33,36", aspect="2,3")], tmp_path)
    axes = figures["zeta.png"].axes[0]
    assert axes.get_title() == "Cylinder collapse, Mohr-Coulomb"
    assert axes.texts[0].get_text() == "axisymmetric, $r_i$ = 97 mm, $h$ = 5.105 mm, 4 points per cell"


def test_an_axis_other_than_the_aspect_ratio(tmp_path: Path, figures: dict[str, Figure]) -> None:
    runs = plan(tmp_path, "grid.spacing=0.005,0.01,0.02", aspect="2")
    report = write_report([finish(run) for run in runs], tmp_path)
    axes = figures["zeta.png"].axes[0]
    assert axes.get_xlabel() == "grid.spacing (m)" and axes.get_xscale() == "linear"
    assert "Lube et al. 2004, a = 2, scatter" in labels(figures["zeta.png"])
    assert report.slopes == []


def test_text_values_get_equidistant_ticks_and_kinds_of_column_get_charts_of_their_own(
    tmp_path: Path, figures: dict[str, Figure]
) -> None:
    write_report([finish(run) for run in plan(tmp_path, "method.transfer=flip,pic", aspect="2")], tmp_path)
    ticks = figures["zeta.png"].axes[0].get_xticklabels()
    assert [tick.get_text() for tick in ticks] == ["flip", "pic"]
    runs = plan(tmp_path / "kinds", "geometry.model=axisymmetric,plane", aspect="2,3")
    report = write_report([finish(run) for run in runs], tmp_path / "kinds")
    names = {path.name for path in report.files if path.suffix == ".png"}
    assert names == {f"{name}-{kind}.png" for name in ("zeta", "beta") for kind in ("axisymmetric", "plane")}
