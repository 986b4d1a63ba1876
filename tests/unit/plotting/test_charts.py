"""Charts: lines, markers and labels; the commands `measure` and `plot` on a synthetic run."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

from mpmcol.case import Case, load_case
from mpmcol.errors import OutputError, UsageError
from mpmcol.experiments import EXPERIMENTS
from mpmcol.io import results
from mpmcol.io.results import Results
from mpmcol.measure import ColumnShape, Measurement, measure
from mpmcol.plotting import charts, run_charts
from tests.support.cli import csv_row, invoke

SHAPE = ColumnShape("plane", "one-sided", r_i=0.09, h_i=0.09, spacing=0.002, density=2650.0, point_size=0.001)
PNG = b"\x89PNG\r\n\x1a\n"


def deposit(spread: float, shape: ColumnShape = SHAPE) -> Measurement:
    """The column sheared into a wedge that is (1 + spread) r_i long."""
    length = shape.r_i * (1.0 + spread)
    size, height = shape.point_size, 2.0 * shape.r_i * shape.h_i / length
    x, y = np.meshgrid(np.arange(size / 2, length, size), np.arange(size / 2, height, size), indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel()])
    points = points[points[:, 1] < height * (1.0 - points[:, 0] / length)]
    mass = np.full(len(points), shape.density * size**2)
    return measure(points, mass, np.zeros_like(points), shape)


@dataclass
class SyntheticRun(Results):
    """Results of a run at rest, without a simulation."""

    folder: Path
    shape: ColumnShape = SHAPE
    experiment: str = "paper"

    times = (0.0, 0.1, 0.2, 0.3)

    @property
    def case(self) -> Case:
        return load_case("quickstart", [f"score.experiment={self.experiment}"])

    @property
    def snapshots(self) -> list[Path]:
        return [self.folder / f"{i}.vtkhdf" for i in range(len(self.times))]

    @property
    def summary(self) -> dict[str, Any]:
        return {"status": "done", "at_rest": True}

    def snapshot(self, i: int) -> SimpleNamespace:
        return SimpleNamespace(time=self.times[i], stage="collapse")

    def measure(self, i: int = -1) -> Measurement:
        return deposit(1.5 * self.times[i] / 0.3, self.shape)

    @property
    def history(self) -> dict[str, np.ndarray]:
        time = np.append(np.linspace(-0.1, 0.0, 3), np.linspace(0.0, 0.4, 41))
        risen = np.clip(time / 0.25, 0.0, 1.0)
        total = self.shape.potential_energy(9.81)
        front = self.shape.r_i * (1.0 + 1.5 * risen)
        before = np.arange(44) < 3  # the last one ends at release, with a separate ledger
        return {
            "stage": np.where(before, "equilibrate", "collapse"),
            "time": time,
            "height": self.shape.h_i * (1.0 - 0.3 * risen),
            "potential": total * (1.0 - 0.6 * risen) + 5.0,
            "residual": 0.002 * total * risen,
            **dict.fromkeys(charts.FRONT_STYLES, front),
            **dict.fromkeys(charts.ENERGY_STYLES, np.where(before, 9.0 * total, 0.1 * total * risen)),
        }


@pytest.fixture
def figures(monkeypatch: pytest.MonkeyPatch) -> list[Figure]:
    drawn: list[Figure] = []
    save = charts.save_figure

    def record(figure: Figure, path: Path, svg: bool) -> list[Path]:
        drawn.append(figure)
        return save(figure, path, svg)

    monkeypatch.setattr(charts, "save_figure", record)
    return drawn


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> SyntheticRun:
    synthetic = SyntheticRun(tmp_path)
    (tmp_path / "result.json").touch()
    monkeypatch.setattr(results, "Results", lambda folder: synthetic)
    return synthetic


def line(figure: Figure, panel: int, label: str) -> tuple[np.ndarray, np.ndarray]:
    found = next(entry for entry in figure.axes[panel].lines if str(entry.get_label()).startswith(label))
    return np.asarray(found.get_xdata(), dtype=float), np.asarray(found.get_ydata(), dtype=float)


def test_a_run_gives_three_charts_with_units_on_every_axis(run: SyntheticRun, figures: list[Figure]) -> None:
    paths = run_charts.chart_run(run)  # type: ignore[arg-type]
    assert [path.name for path in paths] == ["profile.png", "front.png", "energy.png"]
    assert all(path.read_bytes().startswith(PNG) for path in paths)
    labels = [axes.get_ylabel() for figure in figures for axes in figure.axes]
    labels += [figure.axes[-1].get_xlabel() for figure in figures]
    assert all(any(unit in label for unit in ("(mm)", "(-)", "%")) for label in labels)


def test_profile_chart_has_equal_axes_and_the_fronts_at_their_positions(tmp_path: Path, figures: list[Figure]) -> None:
    final = deposit(1.5)
    charts.profile_chart(tmp_path / "p.png", SHAPE, [(0.1, deposit(0.5)), (0.3, final)], EXPERIMENTS["paper-plane"])
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
    charts.profile_chart(tmp_path / "p.png", SHAPE, [(0.3, gap)], EXPERIMENTS["paper-plane"])
    assert line(figures[0], 0, "$t$")[1][1:] == pytest.approx([2e3, 1e3, 0, np.nan, np.nan, 0, 1e3, 0], nan_ok=True)


@pytest.mark.parametrize(("at_rest", "name"), [(True, "deposit"), (False, "last state")])
def test_only_the_last_profile_has_a_name(tmp_path: Path, figures: list[Figure], at_rest: bool, name: str) -> None:
    deposits = [(0.1, deposit(0.5)), (0.3, deposit(1.5))]
    charts.profile_chart(tmp_path / "p.png", SHAPE, deposits, EXPERIMENTS["paper-plane"], at_rest=at_rest)
    labels = [text for entry in figures[0].axes[0].lines if (text := str(entry.get_label())).startswith("$t$")]
    assert [text.partition("}$")[2] for text in labels] == ["", f", {name}"]


def test_distances_of_a_two_sided_release_start_at_the_plane_of_symmetry(tmp_path: Path, figures: list[Figure]) -> None:
    half = replace(SHAPE, release="two-sided")
    charts.profile_chart(tmp_path / "p.png", half, [(0.3, deposit(1.5, half))], EXPERIMENTS["paper-plane"])
    assert figures[0].axes[0].get_xlabel() == "distance from the plane of symmetry (mm)"


def test_experiment_is_drawn_by_front_height_and_surface(tmp_path: Path, figures: list[Figure]) -> None:
    rods = replace(SHAPE, r_i=0.2, h_i=0.1)
    charts.profile_chart(tmp_path / "p.png", rods, [(0.3, deposit(1.2, rods))], EXPERIMENTS["bui-2008"])
    assert line(figures[0], 0, "free surface")[0][-1] == pytest.approx(442.3)
    assert line(figures[0], 0, "failure line")[0][0] == pytest.approx(21.2)
    containers: Any = figures[0].axes[0].containers
    bars = {bar.get_label(): bar.lines[0].get_xydata()[0] for bar in containers}
    assert bars["Bui et al. 2008: front, scatter"] == pytest.approx([442.3, 0.0])
    assert bars["Bui et al. 2008: height, scatter"] == pytest.approx([0.0, 99.2])


def test_no_experimental_front_in_a_gap_and_no_profiles_for_another_column(
    tmp_path: Path, figures: list[Figure]
) -> None:
    gap = replace(SHAPE, h_i=0.18)
    charts.profile_chart(tmp_path / "p.png", gap, [(0.3, deposit(1.5, gap))], EXPERIMENTS["paper-plane"])
    charts.profile_chart(tmp_path / "q.png", SHAPE, [(0.3, deposit(1.5))], EXPERIMENTS["bui-2008"])
    labels = [[str(c.get_label()) for c in figure.axes[0].containers] for figure in figures]
    assert labels == [["Lube et al. 2007 (unverified): height, scatter"], []]
    names = [str(entry.get_label()) for figure in figures for entry in figure.axes[0].lines]
    assert not {"free surface", "universal final surface"} & set(names)


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


def test_a_run_without_release_is_rejected(run: SyntheticRun, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(SyntheticRun, "history", {"stage": np.array(["equilibrate"]), "time": np.array([0.1])})
    with pytest.raises(UsageError, match="before the column was released"):
        run_charts.chart_run(run)  # type: ignore[arg-type]


def test_a_missing_folder_is_an_output_error(tmp_path: Path) -> None:
    with pytest.raises(OutputError):
        charts.profile_chart(tmp_path / "gone" / "p.png", SHAPE, [(0.3, deposit(1.5))], EXPERIMENTS["paper-plane"])


def test_plot_command_prints_the_paths(run: SyntheticRun, figures: list[Figure]) -> None:
    result = invoke("plot", run.folder, "--times", "0.11", "--svg")
    paths = [Path(text) for text in result.output.split()]
    assert {path.suffix for path in paths} == {".png", ".svg"} and len(paths) == 6
    assert all(path.is_file() for path in paths)
    times = [label for entry in figures[0].axes[0].lines if (label := str(entry.get_label())).startswith("$t$")]
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
    score = next(s for s in record["scores"] if s["experiment"] == "paper-plane" and s["quantity"] == "beta")
    assert float(row["error.paper-plane.beta"]) == pytest.approx(score["error"], rel=1e-4)
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
