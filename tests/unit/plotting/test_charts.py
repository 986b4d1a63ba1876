"""Charts: lines, markers and labels; the commands `measure` and `plot` on a synthetic run."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from mpmcol.api import measured
from mpmcol.errors import OutputError, UsageError
from mpmcol.experiments import EXPERIMENTS, without_laws
from mpmcol.io import results
from mpmcol.plotting import charts, profiles, run_charts
from mpmcol.plotting.figures import MOST_ENTRIES
from mpmcol.plotting.styles import EXPERIMENT_STYLES, POINTS_COLOUR, RUN_COLOURS
from tests.support.cli import csv_row, invoke
from tests.support.figures import recorded_figures
from tests.support.synthetic_run import SHAPE, SyntheticRun, deposit

PNG = b"\x89PNG\r\n\x1a\n"


@pytest.fixture
def figures(monkeypatch: pytest.MonkeyPatch) -> list[Figure]:
    """The figures that are made; no files are drawn."""
    return recorded_figures(monkeypatch, charts, saved=False)


@pytest.fixture
def saved(monkeypatch: pytest.MonkeyPatch) -> list[Figure]:
    """The figures that are made and drawn into files."""
    return recorded_figures(monkeypatch, charts, saved=True)


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> SyntheticRun:
    synthetic = SyntheticRun(tmp_path)
    (tmp_path / "result.json").touch()
    monkeypatch.setattr(results, "Results", lambda folder: synthetic)
    monkeypatch.setattr(measured, "as_results", lambda folder: synthetic)
    return synthetic


def line(figure: Figure, panel: int, label: str) -> tuple[np.ndarray, np.ndarray]:
    found = next(entry for entry in figure.axes[panel].lines if str(entry.get_label()).startswith(label))
    return np.asarray(found.get_xdata(), dtype=float), np.asarray(found.get_ydata(), dtype=float)


def test_a_run_gives_three_charts_with_units_on_every_axis(run: SyntheticRun, saved: list[Figure]) -> None:
    paths = run_charts.chart_run(run)  # type: ignore[arg-type]
    assert [path.name for path in paths] == ["profile.png", "front.png", "energy.png"]
    assert all(path.read_bytes().startswith(PNG) for path in paths)
    labels = [axes.get_ylabel() for figure in saved for axes in figure.axes]
    labels += [figure.axes[-1].get_xlabel() for figure in saved]
    assert all(any(unit in label for unit in ("(mm)", "(-)", "%")) for label in labels)


def test_an_arrow_shows_gravity_on_a_slope(tmp_path: Path, figures: list[Figure]) -> None:
    for degrees in (0.0, 30.0):
        shape = replace(SHAPE, slope_deg=degrees)
        charts.profile_chart(tmp_path / "p.png", shape, [(0.3, deposit(1.5, shape))], EXPERIMENTS["lube-2007"])
    level, inclined = ([text for text in one.axes[0].texts if "$g$" in text.get_text()] for one in figures)
    (arrow,) = inclined
    x, y = arrow.xyann  # type: ignore[attr-defined]  # of the tail, from the tip
    assert level == [] and np.degrees(np.arctan2(-x, y)) == pytest.approx(30.0)


def test_profile_chart_has_equal_axes_and_the_fronts_at_their_positions(tmp_path: Path, figures: list[Figure]) -> None:
    final = deposit(1.5)
    charts.profile_chart(tmp_path / "p.png", SHAPE, [(0.1, deposit(0.5)), (0.3, final)], EXPERIMENTS["lube-2007"])
    axes = figures[0].axes[0]
    assert axes.get_aspect() == 1.0
    for name, front in final.front.items():
        assert line(figures[0], 0, name)[0] == pytest.approx(1e3 * front)
    x, y = line(figures[0], 0, "$t$ = 0.3 s")
    drawn = np.isfinite(y)
    assert (y[drawn] == 0.0).sum() == 1 and y[drawn][-1] == 0.0  # down to the floor at the front, and no further
    assert np.trapezoid(y[drawn], x[drawn]) == pytest.approx(1e6 * 0.09 * 0.09, rel=0.02)
    assert max(axes.get_xlim()) > 1e3 * final.front["front_max"]


def test_profile_falls_to_the_floor_on_both_sides_of_a_gap(tmp_path: Path, figures: list[Figure]) -> None:
    gap = replace(deposit(0.5), profile_x=np.arange(8.0), profile_y=np.array([2.0, 1.0, 0, 0, 0, 0, 1.0, 0]))
    charts.profile_chart(tmp_path / "p.png", SHAPE, [(0.3, gap)], EXPERIMENTS["lube-2007"])
    heights = line(figures[0], 0, "$t$")[1][:: profiles.SAMPLES]
    assert heights[1:] == pytest.approx([2e3, 1e3, 0, np.nan, np.nan, 0, 1e3, 0], nan_ok=True)


def test_the_surface_is_a_smooth_line_that_keeps_the_area() -> None:
    """Bins that alternate, since few points are spread over them, give no staircase; straight surfaces stay."""
    x = np.arange(0.5, 20.0)
    straight = np.append(np.linspace(2.0, 0.1, 19), 0.0)
    uneven = straight + np.append(0.05 * (-1.0) ** np.arange(19), 0.0)
    drawn = {}
    for name, heights in (("straight", straight), ("uneven", uneven)):
        deposit_of = replace(deposit(0.5), profile_x=x, profile_y=heights, front={"front_max": 19.5})
        drawn[name] = profiles.outline(deposit_of, 1.0)
        shown = np.isfinite(drawn[name][1])
        fine_x, fine_y = drawn[name][0][shown], drawn[name][1][shown]
        assert np.trapezoid(fine_y, fine_x) == pytest.approx(np.trapezoid(heights, x) + 0.5 * heights[0], rel=0.01)
    inside = (drawn["straight"][0] > 3.0) & (drawn["straight"][0] < 16.0)
    assert drawn["straight"][1][inside] == pytest.approx(np.interp(drawn["straight"][0][inside], x, straight), abs=2e-3)
    assert drawn["uneven"][1][inside] == pytest.approx(drawn["straight"][1][inside], abs=5e-3)


def test_the_surface_ends_at_the_farthest_point() -> None:
    """Not in the middle of the next bin, which may be in a wall."""
    x, heights = np.arange(0.5, 5.0), np.array([2.0, 2.0, 2.0, 1.0, 0.0])
    steep = replace(deposit(0.5), profile_x=x, profile_y=heights, front={"front_max": 4.0})
    drawn_x, drawn_y = profiles.outline(steep, 1e3)
    shown = np.isfinite(drawn_y)
    assert drawn_x[shown].max() == 4000.0 and drawn_y[shown][-1] == 0.0


@pytest.mark.parametrize(("at_rest", "name"), [(True, "deposit"), (False, "last state")])
def test_only_the_last_profile_has_a_name(tmp_path: Path, figures: list[Figure], at_rest: bool, name: str) -> None:
    deposits = [(0.1, deposit(0.5)), (0.3, deposit(1.5))]
    charts.profile_chart(tmp_path / "p.png", SHAPE, deposits, EXPERIMENTS["lube-2007"], at_rest=at_rest)
    labels = [text for entry in figures[0].axes[0].lines if (text := str(entry.get_label())).startswith("$t$")]
    assert [text.partition("}$")[2] for text in labels] == ["", f", {name}"]


def test_distances_of_a_two_sided_release_start_at_the_plane_of_symmetry(tmp_path: Path, figures: list[Figure]) -> None:
    half = replace(SHAPE, release="two-sided")
    charts.profile_chart(tmp_path / "p.png", half, [(0.3, deposit(1.5, half))], EXPERIMENTS["lube-2007"])
    assert figures[0].axes[0].get_xlabel() == "distance from the plane of symmetry (mm)"


def test_experiment_is_drawn_by_front_height_and_surface(tmp_path: Path, figures: list[Figure]) -> None:
    rods = replace(SHAPE, r_i=0.2, h_i=0.1)
    charts.profile_chart(tmp_path / "p.png", rods, [(0.3, deposit(1.2, rods))], EXPERIMENTS["bui-2008"])
    assert line(figures[0], 0, "Bui et al. 2008: free surface")[0][-1] == pytest.approx(442.3)
    assert line(figures[0], 0, "Bui et al. 2008: failure line")[0][0] == pytest.approx(21.2)
    containers: Any = figures[0].axes[0].containers
    bars = {bar.get_label(): bar.lines[0].get_xydata()[0] for bar in containers}
    assert bars["Bui et al. 2008: front, scatter"] == pytest.approx([442.3, 0.0])
    assert bars["Bui et al. 2008: height, scatter"] == pytest.approx([0.0, 99.2])


def test_no_experimental_front_in_a_gap_and_no_profiles_for_another_column(
    tmp_path: Path, figures: list[Figure]
) -> None:
    gap = replace(SHAPE, h_i=0.18)
    charts.profile_chart(tmp_path / "p.png", gap, [(0.3, deposit(1.5, gap))], EXPERIMENTS["lube-2007"])
    charts.profile_chart(tmp_path / "q.png", SHAPE, [(0.3, deposit(1.5))], EXPERIMENTS["bui-2008"])
    labels = [[str(c.get_label()) for c in figure.axes[0].containers] for figure in figures]
    assert labels == [["Lube et al. 2007 (unverified): height, scatter"], []]
    names = [str(entry.get_label()) for figure in figures for entry in figure.axes[0].lines]
    assert not any("surface" in name for name in names)


def test_front_chart_is_normalised(run: SyntheticRun, figures: list[Figure]) -> None:
    run_charts.chart_run(run)  # type: ignore[arg-type]
    tau, zeta = line(figures[1], 0, "front_height")
    assert tau[0] == pytest.approx(0.0, abs=1e-9)
    assert tau[-1] == pytest.approx(0.4 / np.sqrt(0.09 / 9.81))
    assert zeta[[0, -1]] == pytest.approx([0.0, 1.5])
    assert line(figures[1], 1, "height")[1][[0, -1]] == pytest.approx([1.0, 0.7])
    assert line(figures[1], 0, "Lube et al. 2007")[1] == pytest.approx([1.6, 1.6])


def test_energy_chart_is_in_per_cent_since_release(run: SyntheticRun, figures: list[Figure]) -> None:
    run_charts.chart_run(run)  # type: ignore[arg-type]
    assert line(figures[2], 0, "potential energy released")[1][[0, -1]] == pytest.approx([0.0, 60.0])
    assert line(figures[2], 0, "dissipated by damping")[1][-1] == pytest.approx(10.0)
    assert figures[2].axes[1].lines[0].get_ydata()[-1] == pytest.approx(0.2)  # type: ignore[index]


def test_lines_differ_without_colour() -> None:
    for styles in (charts.FRONT_STYLES, charts.ENERGY_STYLES):
        assert len({str(style["linestyle"]) for style in styles.values()}) == len(styles)


def test_every_published_law_has_a_style_of_its_own() -> None:
    citations = {experiment.citation for experiment in EXPERIMENTS.values()}
    assert citations <= EXPERIMENT_STYLES.keys()
    shown = {(style.colour, str(style.line)) for style in EXPERIMENT_STYLES.values()}
    assert len(shown) == len(EXPERIMENT_STYLES)
    assert not {style.colour for style in EXPERIMENT_STYLES.values()} & {*RUN_COLOURS, POINTS_COLOUR}


def test_an_experiment_has_the_same_colour_in_every_chart(run: SyntheticRun, figures: list[Figure]) -> None:
    run_charts.chart_run(run)  # type: ignore[arg-type]
    colour = EXPERIMENT_STYLES["Lube et al. 2007"].colour
    bars: Any = figures[0].axes[0].containers
    assert {bar.lines[0].get_color() for bar in bars} == {colour}
    for panel in (0, 1):
        (law,) = [entry for entry in figures[1].axes[panel].lines if "Lube" in str(entry.get_label())]
        assert law.get_color() == colour


def test_legends_are_short_and_name_experiments_by_author(run: SyntheticRun, figures: list[Figure]) -> None:
    run_charts.chart_run(run)  # type: ignore[arg-type]
    legends = [figures[0].legends[0], *(axes.get_legend() for axes in figures[1].axes)]
    texts = [[text.get_text() for text in legend.get_texts()] for legend in legends if legend]
    assert len(texts) == 3 and max(map(len, texts)) <= MOST_ENTRIES
    assert not any("paper" in text for own in texts for text in own)
    assert "Lube et al. 2007: front, height (unverified), scatter" in texts[0]
    assert "Lube et al. 2005: universal final surface" in texts[0]


def test_times_are_coloured_from_light_to_dark_with_a_scale(run: SyntheticRun, figures: list[Figure]) -> None:
    run_charts.chart_run(run)  # type: ignore[arg-type]
    axes = figures[0].axes[0]
    lines = [entry for entry in axes.lines if str(entry.get_label()).startswith("$t$")]
    lightness = [float(np.dot(to_rgb(entry.get_color()), (0.299, 0.587, 0.114))) for entry in lines]
    assert lightness == sorted(lightness, reverse=True) and len(lines) == 3  # without the column itself
    assert lines[-1].get_linewidth() > lines[0].get_linewidth()
    (scale,) = axes.child_axes
    assert scale.get_ylabel() == "time since release (s)"
    assert [tick.get_text() for tick in scale.get_yticklabels()] == ["0.1", "0.2", "0.3"]


def test_title_and_caption_are_those_of_the_resolved_case(run: SyntheticRun, figures: list[Figure]) -> None:
    run.shape = replace(SHAPE, h_i=0.27)  # a = 1 in the title of the case
    run_charts.chart_run(run)  # type: ignore[arg-type]
    for figure in figures:
        assert figure.axes[0].get_title().endswith(", a = 3") and "a = 1" not in figure.axes[0].get_title()
        caption = next(text for text in figure.axes[0].texts if "plane strain" in text.get_text())
        parts = ("$r_i$ = 90 mm", "$h_i$ = 270 mm", "$h$ = 2 mm", "4 points per cell", "Mohr-Coulomb", r"= 33$\degree$")
        assert all(part in caption.get_text() for part in parts)


def test_the_gate_is_drawn_in_the_profile_chart(run: SyntheticRun, figures: list[Figure]) -> None:
    run_charts.chart_run(run)  # type: ignore[arg-type]
    assert set(line(figures[0], 0, "gate")[0]) == {90.0}
    assert "gate" in [text.get_text() for text in figures[0].axes[0].texts]


def test_large_columns_have_axes_in_m(tmp_path: Path, figures: list[Figure]) -> None:
    large = replace(SHAPE, r_i=9.0, h_i=9.0, spacing=0.2, point_size=0.1)
    charts.profile_chart(tmp_path / "p.png", large, [(3.0, deposit(1.5, large))], EXPERIMENTS["lube-2007"])
    axes = figures[0].axes[0]
    assert axes.get_xlabel() == "distance from the wall (m)" and axes.get_ylabel() == "height (m)"
    assert line(figures[0], 0, "front_max")[0] == pytest.approx(22.5, rel=0.02)


def test_the_height_panel_uses_its_range(run: SyntheticRun, figures: list[Figure]) -> None:
    run_charts.chart_run(run)  # type: ignore[arg-type]
    low, high = figures[1].axes[1].get_ylim()
    assert 0.6 < low < 0.7 and 1.05 < high < 1.15  # from the deposit to the scatter of the experiment


def test_a_height_that_hardly_changes_is_not_magnified(tmp_path: Path, figures: list[Figure]) -> None:
    time = np.linspace(0.0, 1.0, 50)
    height = SHAPE.h_i * (0.99889 + 1e-6 * np.sin(40.0 * time))
    charts.front_chart(tmp_path / "f.png", SHAPE, time, {"front_height": time}, height, without_laws("none"))
    axes = figures[0].axes[1]
    low, high = axes.get_ylim()
    assert high - low == pytest.approx(charts.LEAST_RANGE) and low < 0.99889 < high
    figures[0].draw_without_rendering()
    assert axes.yaxis.get_offset_text().get_text() == ""


def test_at_most_seven_energies_have_lines_and_no_energy_is_left_out(tmp_path: Path, figures: list[Figure]) -> None:
    time = np.linspace(0.0, 1.0, 20)
    energies = {name: (i + 1.0) * time for i, name in enumerate(charts.ENERGY_STYLES)}
    total = sum(values[-1] for values in energies.values())
    energies |= {"potential": -total * time, "residual": 0.0 * time}
    charts.energy_chart(tmp_path / "e.png", SHAPE, time, energies)
    lines = [one for one in figures[0].axes[0].lines if not str(one.get_label()).startswith("_")]
    assert len(lines) == MOST_ENTRIES and str(lines[-1].get_label()).endswith(": sum")
    released, *others = (float(np.asarray(one.get_ydata())[-1]) for one in lines)
    assert sum(others) == pytest.approx(released)


def test_a_run_without_release_is_rejected(run: SyntheticRun, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(SyntheticRun, "history", {"stage": np.array(["equilibrate"]), "time": np.array([0.1])})
    with pytest.raises(UsageError, match="before the column was released"):
        run_charts.chart_run(run)  # type: ignore[arg-type]


def test_a_missing_folder_is_an_output_error(tmp_path: Path) -> None:
    with pytest.raises(OutputError):
        charts.profile_chart(tmp_path / "gone" / "p.png", SHAPE, [(0.3, deposit(1.5))], EXPERIMENTS["lube-2007"])


def test_plot_command_prints_the_paths(run: SyntheticRun, saved: list[Figure]) -> None:
    result = invoke("plot", run.folder, "--times", "0.11", "--svg")
    paths = [Path(text) for text in result.output.split()]
    assert {path.suffix for path in paths} == {".png", ".svg"} and len(paths) == 6
    assert all(path.is_file() for path in paths)
    times = [label for entry in saved[0].axes[0].lines if (label := str(entry.get_label())).startswith("$t$")]
    assert [label.split()[2] for label in times] == ["0.1", "0.3"]  # of the nearest snapshot, and the last
    assert times[-1].endswith(", deposit") and not times[0].endswith(", deposit")
    assert invoke("plot", run.folder, "--times", "soon").exit_code == 2


def test_measure_command_table(run: SyntheticRun) -> None:
    table = invoke("measure", run.folder).output
    assert f"zeta {run.measure().zeta['front_max']:7.3f}" in table
    paper = next(text for text in table.splitlines() if text.startswith("Lube et al. 2007 ") and "zeta" in text)
    assert "1.600" in paper and paper.count("*") == 0
    rods = next(text for text in table.splitlines() if text.startswith("Lube et al. 2005 ") and "zeta" in text)
    assert rods.count("*") == 3  # 1.5 is 25 % beyond 1.2
    assert "exponent only" in table
    assert "undisturbed radius" in table and table.count("universal final surface: RMS distance") == 1


def test_measure_command_json_and_csv_agree(run: SyntheticRun) -> None:
    record = json.loads(invoke("measure", run.folder, "--json").output)
    text = invoke("measure", run.folder, "--csv").output
    row = csv_row(text)
    assert record["stop_time"] == pytest.approx(0.25 / np.sqrt(0.09 / 9.81), rel=0.05)
    assert float(row["zeta.front_height"]) == pytest.approx(record["zeta"]["front_height"], rel=1e-5)
    score = next(s for s in record["scores"] if s["experiment"] == "lube-2007" and s["quantity"] == "beta")
    assert float(row["error.lube-2007.beta"]) == pytest.approx(score["error"], rel=1e-4)
    assert score["within_scatter"] == (abs(score["error"]) <= score["scatter"])
    assert row["error.balmforth-kerswell-2005.beta"] == ""
    assert len(record["profile"]["x"]) == len(record["profile"]["y"])


def test_csv_columns_do_not_depend_on_the_aspect_ratio(run: SyntheticRun) -> None:
    headers = []
    for h_i in (0.09, 0.18):  # the second lies in the gap of Eq. 37
        run.shape = replace(SHAPE, h_i=h_i)
        headers.append(invoke("measure", run.folder, "--csv").output.splitlines()[0])
    assert headers[0] == headers[1]


def test_measure_command_measures_an_earlier_snapshot(run: SyntheticRun) -> None:
    record = json.loads(invoke("measure", run.folder, "--json", "--snapshot", "0").output)
    assert record["zeta"]["front_max"] == pytest.approx(0.0, abs=0.02)
    assert record["stop_time"] is None
