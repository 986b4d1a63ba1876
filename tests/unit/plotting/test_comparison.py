"""Charts of several runs, and measurements of the user in them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from mpmcol.case import Case, load_case
from mpmcol.errors import UsageError
from mpmcol.measure import ColumnShape
from mpmcol.measure.shape import Obstacle
from mpmcol.plotting import comparison
from mpmcol.plotting.captions import run_names
from mpmcol.plotting.comparison import MOST_RUNS, chart_comparison
from mpmcol.plotting.measured_series import EXPECTED, MOST_SERIES, read_points
from mpmcol.plotting.run_charts import _far_points
from tests.support.cli import invoke
from tests.support.figures import recorded_figures
from tests.support.synthetic_run import SHAPE, SyntheticRun


@dataclass
class OtherRun(SyntheticRun):
    """A synthetic run with values of its case replaced."""

    replaced: tuple[str, ...] = ()

    @property
    def case(self) -> Case:
        return load_case("coarse-channel", list(self.replaced))


@pytest.fixture
def figures(monkeypatch: pytest.MonkeyPatch) -> list[Figure]:
    """The figures that are made; no files are drawn."""
    return recorded_figures(monkeypatch, comparison, saved=False)


@pytest.fixture
def saved(monkeypatch: pytest.MonkeyPatch) -> list[Figure]:
    """The figures that are made and drawn into files."""
    return recorded_figures(monkeypatch, comparison, saved=True)


def run_in(folder: Path, name: str, *replaced: str, shape: ColumnShape = SHAPE) -> OtherRun:
    (folder / name).mkdir(parents=True, exist_ok=True)
    (folder / name / "result.json").touch()
    return OtherRun(folder / name, shape, replaced=replaced)


def curves(axes: Axes) -> list[Line2D]:
    """Lines with many points: those of the runs."""
    return [line for line in axes.lines if len(line.get_xydata()) > 9]


def legend(figure: Figure) -> list[str]:
    return [text.get_text() for text in figure.legends[0].get_texts()]


def test_each_chart_has_a_line_for_each_run(tmp_path: Path, saved: list[Figure]) -> None:
    runs = [run_in(tmp_path, "coarse"), run_in(tmp_path, "fine", "grid.spacing=0.003")]
    paths = chart_comparison(runs, out=tmp_path / "charts")
    assert [path.name for path in paths] == ["profile.png", "front.png", "energy.png"]
    assert all(path.stat().st_size > 5000 for path in paths)
    for figure in saved:
        assert legend(figure)[:2] == ["spacing = 5 mm", "spacing = 3 mm"] and len(legend(figure)) <= 7
        for axes in figure.axes:
            own = [
                line for line in axes.lines if line.get_color() in ("black", "#e69f00") and len(line.get_xdata()) > 9
            ]
            assert len(own) == 2 and len({str(line.get_linestyle()) for line in own}) == 2
    assert "Lube et al. 2007: front, height (unverified), scatter" in legend(saved[0])


def test_each_reason_why_no_experiment_is_drawn_is_given(tmp_path: Path, figures: list[Figure]) -> None:
    runs = [run_in(tmp_path, name, f"material.{name}") for name in ("friction_deg=8", "cohesion=500")]
    chart_comparison(runs, out=tmp_path / "charts")
    text = " ".join(figures[0].axes[0].get_title(loc="left").split())
    text += " ".join(note.get_text() for note in figures[0].axes[0].texts)
    assert "here it is 8 deg" in text and "grains without cohesion" in text


def test_runs_are_named_by_what_differs_or_by_their_folders(tmp_path: Path) -> None:
    def names(*replaced: tuple[str, ...]) -> list[str]:
        return run_names([run_in(tmp_path, f"run-{i}", *values) for i, values in enumerate(replaced)])

    assert names((), ("material.friction_deg=36",)) == ["friction_deg = 33 deg", "friction_deg = 36 deg"]
    assert names((), ("grid.spacing=0.01", "grid.points_per_cell=9")) == [
        "spacing = 5 mm, points_per_cell = 4", "spacing = 10 mm, points_per_cell = 9",
    ]  # fmt: skip
    layers = [(f"layers=[{{from=0, to=0.04, material={{friction_deg={angle}}}}}]",) for angle in (20, 25)]
    assert names(*layers) == [f"layers.0.material.friction_deg = {angle} deg" for angle in (20, 25)]
    three = ("grid.spacing=0.01", "grid.points_per_cell=9", "time.cfl=0.3")
    assert names((), three) == ["run-0", "run-1"]
    assert names((), ("score.experiment=lube-2005",)) == ["run-0", "run-1"]  # equal simulations
    same = [run_in(tmp_path / one, "run") for one in ("a", "b")]
    assert run_names(same) == [str(run.folder) for run in same]


def test_columns_of_different_sizes_are_compared_relative_to_their_radius(
    tmp_path: Path, figures: list[Figure]
) -> None:
    large = replace(SHAPE, r_i=0.9, h_i=0.9, spacing=0.02, point_size=0.01)
    chart_comparison([run_in(tmp_path, "a"), run_in(tmp_path, "b", shape=large)], out=tmp_path)
    axes = figures[0].axes[0]
    assert axes.get_xlabel() == "distance from the wall over $r_i$ (-)"
    ends = [
        np.nanmax(line.get_xdata()[np.isfinite(line.get_ydata())]) for line in axes.lines if len(line.get_xdata()) > 9
    ]
    assert ends[0] == pytest.approx(ends[1], rel=0.02) and ends[0] == pytest.approx(2.5, rel=0.05)


@pytest.mark.parametrize("size", [1.0, 2.0])
def test_each_column_and_its_walls_are_drawn(tmp_path: Path, figures: list[Figure], size: float) -> None:
    dam = replace(SHAPE, r_i=size * 0.09, obstacles=(Obstacle(0.2, 0.22, 0.03),))
    low = replace(SHAPE, h_i=0.05)
    chart_comparison([run_in(tmp_path, name, shape=one) for name, one in (("a", low), ("b", dam))], out=tmp_path)
    axes = figures[0].axes[0]
    drawn = [np.round(np.asarray(one.get_xydata()), 9).tolist() for one in axes.lines]
    for shape in (dam, low):
        factor = 1e3 if size == 1.0 else 1.0 / shape.r_i
        assert np.round(factor * shape.surface.T, 9).tolist() in drawn
        assert [patch.get_x() for patch in axes.patches] == pytest.approx([0.2 * (1e3 if size == 1.0 else 1 / 0.18)])


def test_different_slopes_are_stated(tmp_path: Path, figures: list[Figure]) -> None:
    shapes = {"a": SHAPE, "b": replace(SHAPE, slope_deg=10.0)}
    chart_comparison([run_in(tmp_path, name, shape=one) for name, one in shapes.items()], out=tmp_path)
    for figure in figures[:2]:
        assert any("slopes of 0, 10 deg; drawn along the base" in text.get_text() for text in figure.axes[0].texts)


def test_the_experiment_is_left_out_where_aspect_ratios_differ(tmp_path: Path, figures: list[Figure]) -> None:
    chart_comparison([run_in(tmp_path, "a"), run_in(tmp_path, "b", shape=replace(SHAPE, h_i=0.18))], out=tmp_path)
    assert not any("Lube" in text for figure in figures for text in legend(figure))


def test_runs_without_a_meaningful_comparison_are_refused(tmp_path: Path) -> None:
    plane, cylinder = run_in(tmp_path, "a"), run_in(tmp_path, "b", shape=replace(SHAPE, model="axisymmetric"))
    with pytest.raises(UsageError, match=r"a is plane strain and .*b is a cylinder: .*cannot be compared"):
        chart_comparison([plane, cylinder], out=tmp_path)
    with pytest.raises(UsageError, match="a: given twice"):
        chart_comparison([plane, run_in(tmp_path, "a")], out=tmp_path)
    with pytest.raises(UsageError, match=f"{MOST_RUNS + 1} runs: one chart can show {MOST_RUNS}"):
        chart_comparison([run_in(tmp_path, str(i)) for i in range(MOST_RUNS + 1)], out=tmp_path)


def test_the_command_compares_into_the_current_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, saved: list[Figure]
) -> None:
    runs = {path: run_in(tmp_path, path) for path in ("a", "b")}
    monkeypatch.setattr("mpmcol.io.results.Results", lambda folder: runs[folder.name])
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    done = invoke("plot", tmp_path / "a", tmp_path / "b")
    assert done.output.split() == ["profile.png", "front.png", "energy.png"] and Path("profile.png").is_file()
    refused = invoke("plot", tmp_path / "a", tmp_path / "b", "--times", "0.1")
    assert refused.exit_code == 2 and "--times chooses profiles of one run" in refused.output


def write(folder: Path, text: str) -> Path:
    path = folder / "measured.csv"
    path.write_text(text)
    return path


def test_points_are_read_in_their_units(tmp_path: Path) -> None:
    (series,) = read_points(write(tmp_path, "# scanned\nr [mm],z (cm)\n0,8.2\n\n100, 4\n"))
    assert series.r == pytest.approx([0.0, 0.1]) and series.z == pytest.approx([0.082, 0.04])
    assert series.label == "measured.csv"
    (series,) = read_points(write(tmp_path, "x [mm],y\n100,0.04\n"))
    assert (series.r[0], series.z[0]) == (pytest.approx(0.1), 0.04)
    (series,) = read_points(write(tmp_path, "\ufeffz,r\n0.08,0\n"))
    assert (series.r[0], series.z[0]) == (0.0, 0.08)


def test_points_far_beyond_the_deposit_are_noted(tmp_path: Path) -> None:
    points = read_points(write(tmp_path, "r,z\n0,100\n200,50\n"))
    (note,) = _far_points(points, 0.37)
    assert "points up to 200 m, a deposit of 370 mm" in note and "r [mm]" in note
    assert not [*_far_points(points, 50.0)]


@pytest.mark.parametrize(
    ("column", "labels"),
    [("series", ["1", "2"]), ("t", ["t = 1 s", "t = 2 s"]), ("t [ms]", ["t = 1 ms", "t = 2 ms"])],
)
def test_a_third_column_divides_the_points_into_series(tmp_path: Path, column: str, labels: list[str]) -> None:
    found = read_points(write(tmp_path, f"r,z,{column}\n0,0.08,1\n0.1,0.03,2\n0.05,0.06,1\n"))
    assert [series.label for series in found] == [f"measured.csv: {label}" for label in labels]
    assert found[0].r == pytest.approx([0.0, 0.05])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "the file is empty; expected columns"),
        ("r,z\n", "no points below the header"),
        ("r,z\n0,0.1\n0.1,high\n", "line 3: z = 'high' is not a number"),
        ("r,z\n0,nan\n", "line 2: z = 'nan' is not a number"),
        ("r,z\n0,1e400\n", "line 2: z = '1e400' is not a number"),
        ('r,z\n"0,05",0.1\n', "line 2: r = '0,05' is not a number; the decimal separator is a point"),
        ("r,z\n0,05,0,1\n", "line 2: 4 values, expected 2 as in the header; the decimal separator is a point"),
        ("r,z\n0\n", "line 2: 1 values, expected 2"),
        ("r;z\n0;1\n", "line 1: column 'r;z' is not usable; columns are separated by commas"),
        ("x,h\n0,1\n", "line 1: column 'h' is not usable; expected columns"),
        ("0,1\n0,2\n", "line 1: column '0' is not usable; the first line must be a header"),
        ("r,x,z\n0,1,2\n", "line 1: column 'x' is not usable"),
        ("r,z,r\n0,1,2\n", "line 1: column 'r' is not usable"),
        ("r [inch],z\n0,1\n", "line 1: r cannot be in 'inch'; expected m, mm, cm"),
        ("r,t\n0,1\n", "line 1: columns r, t; expected columns"),
        ("r,z,series\n" + "".join(f"0,1,{i}\n" for i in range(MOST_SERIES + 1)), "8 series; one chart can show 7"),
        (f'r,z\n0,"{"1" * 200000}"\n', "line 2: cannot be read"),
    ],
)
def test_a_bad_file_is_refused_with_its_line(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(UsageError) as refused:
        read_points(write(tmp_path, text))
    assert "measured.csv" in str(refused.value) and message in str(refused.value)


def test_a_file_that_is_no_text_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"cannot be read \(No such file or directory\)"):
        read_points(tmp_path / "gone.csv")
    with pytest.raises(UsageError, match=r"cannot be read \(Is a directory\)"):
        read_points(tmp_path)
    (tmp_path / "a.csv").write_bytes(b"\x89PNG\xff")
    with pytest.raises(UsageError, match="it is not a text file") as refused:
        read_points(tmp_path / "a.csv")
    assert EXPECTED in str(refused.value)


def test_measurements_are_drawn_and_in_view(tmp_path: Path, figures: list[Figure]) -> None:
    measured = read_points(write(tmp_path, "r [mm],z [mm],series\n0,80,A\n450,2,B\n"))
    chart_comparison([run_in(tmp_path, "a"), run_in(tmp_path, "b", "time.cfl=0.3")], points=measured, out=tmp_path)
    axes = figures[0].axes[0]
    drawn = {str(line.get_label()): line.get_xydata().tolist() for line in axes.lines}
    assert drawn["measured.csv: A"] == [[0.0, 80.0]] and drawn["measured.csv: B"] == [[450.0, 2.0]]
    assert axes.get_xlim()[1] > 450.0
    large = replace(SHAPE, r_i=0.9, h_i=0.9, spacing=0.02, point_size=0.01)
    with pytest.raises(UsageError, match="different r_i; plot each run with its own points"):
        chart_comparison([run_in(tmp_path, "a"), run_in(tmp_path, "b", shape=large)], points=measured, out=tmp_path)
