"""Side views of a synthetic run by both back ends, animations, and the command `mpmcol render`."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from PIL import Image
from PIL.ImageSequence import Iterator

from mpmcol.errors import OutputError, UsageError
from mpmcol.io.results import Results
from mpmcol.io.snapshot import Meta, Snapshot, list_snapshots, read_snapshot, write_snapshot
from mpmcol.plotting.render import FIT_VIEW, animation, backends, render
from mpmcol.plotting.render import frame as frame_module
from mpmcol.plotting.render.coloring import COLORINGS
from mpmcol.plotting.render.frame import View, canvas_box, canvas_size, page_around
from mpmcol.plotting.render.side import fit_view
from tests.support.cli import invoke

DISPLACEMENT = COLORINGS["displacement"]
SIZE = (480, 270)
STEPS = 4
POINT = 0.005
META: Meta = {
    "title": "Column, a = 3 $x",
    "model": "plane",
    "spacing": 0.01,
    "point_size": POINT,
    "r_i": 0.05,
    "h_i": 0.1,
}

needs_egl = pytest.mark.skipif(not backends.has_egl(), reason="this machine has no libEGL")


def block(right: float, bottom: float, top: float) -> np.ndarray:
    x, y = np.meshgrid(np.arange(POINT / 2, right, POINT), np.arange(bottom + POINT / 2, top, POINT))
    return np.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()])


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A column that shears and flattens on a base much longer than the deposit."""
    path = tmp_path_factory.mktemp("run")
    column, base = block(0.05, 0, 0.1), block(0.5, -0.02, 0)
    points = np.vstack([column, base])
    for step in range(STEPS):
        spread = 1 + step / STEPS
        moved = points.copy()
        moved[: len(column)] = column * (spread, 1 / spread, 1)
        arrays = {
            "position": moved,
            "displacement": moved - points,
            "material": np.repeat(np.array([0, 1], np.uint8), [len(column), len(base)]),
            "id": np.arange(len(points), dtype=np.int32),
        }
        write_snapshot(path, step, Snapshot(0.1 * step, step, "collapse", arrays), META)
    return path


@pytest.fixture
def without_egl(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(backends, "has_egl", lambda: False)


def pixels(path: Path) -> np.ndarray:
    return np.asarray(Image.open(path).convert("RGB")).astype(int)


def coloured(image: np.ndarray) -> np.ndarray:
    """Mask of the pixels of the material's part of the page that are neither white nor grey."""
    left, top, width, height = canvas_box(SIZE)
    mask = np.zeros(image.shape[:2], bool)
    mask[top : top + height, left : left + width] = True
    return mask & (np.ptp(image, axis=2) > 40)


def column_of(x: float, view: View) -> float:
    """Column of the pixel at x (m)."""
    left, _, width, _ = canvas_box(SIZE)
    return left + (x - view.extent[0]) / (view.extent[1] - view.extent[0]) * width


def assert_correct_image(path: Path, folder: Path) -> None:
    """The deposit has the expected position and size, equally scaled in x and y, above a grey base."""
    image = pixels(path)
    assert image.shape == (SIZE[1], SIZE[0], 3)
    assert image.std() > 20
    rows, columns = np.nonzero(coloured(image))
    view = fit_view(list_snapshots(folder)[-1:], SIZE, DISPLACEMENT)
    spread = 1 + (STEPS - 1) / STEPS
    scale = column_of(1.0, view) - column_of(0.0, view)
    assert columns.min() == pytest.approx(column_of(0.0, view), abs=3)  # points end at the wall
    assert columns.max() == pytest.approx(column_of(0.0475 * spread + 0.65 * POINT, view), abs=4)
    assert np.ptp(rows) == pytest.approx((0.095 / spread + 1.3 * POINT) * scale, abs=4)
    below = image[rows.max() + 6, columns.min() + 5 : columns.max()]
    assert np.ptp(below, axis=1).max() < 12 and 120 < below.mean() < 220


@needs_egl
def test_pyvista_image(folder: Path, tmp_path: Path):
    rendered = render(folder, gif=False, size=SIZE, out=tmp_path / "a.png")
    assert rendered == ([tmp_path / "a.png"], "pyvista", "")
    assert_correct_image(tmp_path / "a.png", folder)


def test_matplotlib_image(folder: Path, tmp_path: Path, without_egl: None):
    rendered = render(folder, gif=False, size=SIZE, out=tmp_path / "a.png")
    assert (rendered.paths, rendered.backend) == ([tmp_path / "a.png"], "matplotlib")
    assert "no libEGL" in rendered.note and "install libegl1" in rendered.note
    assert_correct_image(tmp_path / "a.png", folder)


@needs_egl
def test_both_back_ends_agree(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    render(folder, gif=False, size=SIZE, out=tmp_path / "pyvista.png")
    monkeypatch.setattr(backends, "has_egl", lambda: False)
    render(folder, gif=False, size=SIZE, out=tmp_path / "matplotlib.png")
    ours, theirs = (pixels(tmp_path / f"{name}.png") for name in ("pyvista", "matplotlib"))
    both = coloured(ours) & coloured(theirs)
    assert both.sum() > 0.9 * coloured(theirs).sum()
    assert np.abs(ours[both] - theirs[both]).mean() < 30


@pytest.mark.parametrize("backend", [pytest.param("pyvista", marks=[needs_egl, pytest.mark.slow]), "matplotlib"])
def test_gif_has_every_snapshot(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, backend: str):
    monkeypatch.setattr(backends, "has_egl", lambda: backend == "pyvista")
    rendered = render(folder, gif=True, size=SIZE, out=tmp_path / "a.png")
    assert (rendered.paths, rendered.backend) == ([tmp_path / "a.png", tmp_path / "a.gif"], backend)
    with Image.open(tmp_path / "a.gif") as animation:
        assert animation.size == SIZE
        frames = [coloured(np.asarray(page.convert("RGB")).astype(int)) for page in Iterator(animation)]
    assert len(frames) == STEPS
    widths = [np.ptp(np.nonzero(mask)[1]) for mask in frames]
    assert widths == sorted(widths) and widths[-1] > 1.5 * widths[0]


def test_chosen_snapshot_and_default_names(folder: Path, tmp_path: Path, without_egl: None):
    copy = tmp_path / "run"
    (copy / "snapshots").mkdir(parents=True)
    for path in list_snapshots(folder):
        (copy / "snapshots" / path.name).write_bytes(path.read_bytes())
    first, second = render(copy, gif=False, size=SIZE, snapshot=0), render(copy, gif=True, size=SIZE)
    assert first.paths == [copy / "snapshot-000000.png"]
    assert second.paths == [copy / "snapshot-000003.png", copy / "collapse.gif"]
    assert not np.array_equal(pixels(first.paths[0]), pixels(second.paths[0]))


@pytest.mark.parametrize(
    ("program", "reason", "remedy"),
    [
        ("import os; os.kill(os.getpid(), 11)", "signal 11", "install libegl1"),
        ("raise ImportError('no pyvista here')", "no pyvista here", "pip install pyvista"),
    ],
)
def test_matplotlib_replaces_a_crashed_worker(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, program: str, reason: str, remedy: str
):
    monkeypatch.setattr(backends, "has_egl", lambda: True)
    monkeypatch.setattr(backends, "WORKER", (sys.executable, "-c", program))
    rendered = render(folder, gif=False, size=SIZE, out=tmp_path / "a.png")
    assert rendered.backend == "matplotlib"
    assert reason in rendered.note and remedy in rendered.note and "\n" not in rendered.note
    assert_correct_image(tmp_path / "a.png", folder)


def test_relative_folder_from_another_working_directory(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(folder.parent)
    rendered = render(Path(folder.name), gif=False, size=SIZE, out=tmp_path / "a.png")
    assert rendered.backend == ("pyvista" if backends.has_egl() else "matplotlib")
    assert_correct_image(tmp_path / "a.png", folder)


def test_invalid_requests_are_rejected(folder: Path, tmp_path: Path, without_egl: None):
    with pytest.raises(OutputError, match="give the folder of a run"):
        render(tmp_path, gif=False)
    for wrong in (STEPS, -STEPS - 1):
        with pytest.raises(UsageError, match=f"there is no snapshot {wrong}; expected 0 to 3"):
            render(folder, gif=False, snapshot=wrong)
    with pytest.raises(UsageError, match="ends in .png"):
        render(folder, gif=False, out=tmp_path / "a.jpg")
    with pytest.raises(OutputError, match=r"a.png: the folder .*gone does not exist; create it"):
        render(folder, gif=False, out=tmp_path / "gone" / "a.png")


def drawn_lines(snapshots: Path, release: str = "one-sided") -> tuple[View, list[Line2D], Figure]:
    """The view of the last snapshot, and the lines drawn around its points."""
    path = list_snapshots(snapshots)[-1]
    view = fit_view([path], SIZE, DISPLACEMENT)
    view = replace(view, meta=view.meta | {"release": release})
    figures: list[Figure] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(frame_module, "Figure", lambda **options: figures.append(Figure(**options)) or figures[-1])
        frame_module.Page(view)
    behind, before = figures
    return view, [*behind.axes[0].lines, *before.axes[0].lines], before


def test_the_view_contains_the_column_at_release(folder: Path):
    _, right, bottom, top = (view := drawn_lines(folder)[0]).extent
    column = read_snapshot(list_snapshots(folder)[-1]).x[:, 1].max()
    assert column < 0.06 < META["h_i"] < top  # though the deposit itself is lower
    assert right > META["r_i"] and bottom < -0.0175 and view.meta["h_i"] == META["h_i"]


def test_the_view_contains_a_wall_that_the_flow_reaches(folder: Path, tmp_path: Path):
    snapshot, tall = read_snapshot(list_snapshots(folder)[-1]), (200, 720)
    front = float(snapshot.x[snapshot.column, 0].max())
    plain = fit_view(list_snapshots(folder)[-1:], tall, DISPLACEMENT).extent[1]
    ends = []
    for step, face in enumerate((1.05 * front, 9.0)):
        case = f"walls = [{{ from = {face}, to = {1.04 * face} }}]"
        write_snapshot(tmp_path, step, snapshot, {**META, "case": case})
        ends.append(fit_view(list_snapshots(tmp_path)[-1:], tall, DISPLACEMENT).extent[1])
    assert ends[0] > 1.05 * 1.04 * front > plain == ends[1]


def test_walls_are_drawn_where_the_grid_has_them(folder: Path, tmp_path: Path):
    """As in profile.png: with a spacing of 10 mm a wall from 144 to 166 mm is one from 140 to 170 mm."""
    walls = "walls = [{ from = 0.144, to = 0.166, height = 0.024 }, { from = 0.196 }]"
    write_snapshot(tmp_path, 0, read_snapshot(list_snapshots(folder)[-1]), {**META, "case": walls})
    view, axes = fit_view(list_snapshots(tmp_path), SIZE, DISPLACEMENT), Figure().add_subplot()
    view.draw_before(axes)
    dam, end = [patch for patch in axes.patches if patch.get_x() > META["r_i"]]
    assert (dam.get_x(), dam.get_x() + dam.get_width(), dam.get_height()) == pytest.approx((0.14, 0.17, 0.02))
    assert end.get_x() == pytest.approx(0.2)


def test_a_page_without_a_given_size_fits_the_largest_front_of_the_run(folder: Path):
    """The canvas is filled along x and y, for every snapshot up to the same distance."""
    reach, height = 0.2, META["h_i"]
    for path in list_snapshots(folder):
        view = fit_view([path], None, DISPLACEMENT, reach)
        left, right, bottom, top = view.extent
        assert view.size[0] == 1280 and reach < right < 1.03 * reach and height < top < 1.2 * height
        assert (right - left) / (top - bottom) == pytest.approx(np.divide(*canvas_box(view.size)[2:]))
    tall = fit_view([path], None, DISPLACEMENT, 0.01)
    flat = fit_view([path], None, DISPLACEMENT, 2.0)
    assert (tall.size[1], flat.size[1]) == (1280, 600)
    assert canvas_size(page_around((640, 480))) == pytest.approx((640, 480), abs=2)


def test_images_of_all_snapshots_have_the_range_of_the_history(
    finished: Path, tmp_path: Path, without_egl: None, monkeypatch: pytest.MonkeyPatch
):
    views: list[View] = []
    monkeypatch.setitem(FIT_VIEW, "side", lambda *given: views.append(fit_view(*given)) or views[-1])
    for number in (0, -1):
        render(finished, gif=False, snapshot=number, size=(240, 900), out=tmp_path / "a.png")
    first, last = views
    assert first.extent == pytest.approx(last.extent, abs=1e-5)
    assert 1.0 < first.extent[1] / Results(finished).history["front_max"].max() < 1.05


def test_a_half_model_has_an_axis_of_symmetry_and_a_note(folder: Path):
    styles = {}
    for release in ("one-sided", "two-sided"):
        _, lines, figure = drawn_lines(folder, release)
        styles[release] = next(line.get_linestyle() for line in lines if set(line.get_xdata()) == {0})
        assert ("half model by symmetry" in figure.texts[0].get_text()) == (release == "two-sided")
    assert styles == {"one-sided": "-", "two-sided": "-."}


def test_a_rigid_floor_is_a_line_without_a_base(folder: Path, tmp_path: Path):
    last = read_snapshot(list_snapshots(folder)[-1])
    column = {name: values[last.column] for name, values in last.arrays.items()}
    write_snapshot(tmp_path, 0, Snapshot(0.3, 3, "rest", column), META)
    views = [fit_view(list_snapshots(run)[-1:], SIZE, DISPLACEMENT) for run in (folder, tmp_path)]
    assert [view.base for view in views] == [pytest.approx(0.02), 0.0]
    (floor,) = [line for line in drawn_lines(tmp_path)[1] if not np.any(line.get_ydata())]
    assert max(floor.get_xdata()) > last.x[last.column, 0].max()


def test_a_granular_bed_is_drawn_by_its_points_on_a_floor(folder: Path):
    last = read_snapshot(list_snapshots(folder)[-1])
    layer = fit_view(list_snapshots(folder)[-1:], SIZE, DISPLACEMENT)
    bed = replace(layer, meta={**layer.meta, "case": '[geometry]\nbase = "granular"'})
    assert [len(view.points(last)[0]) for view in (layer, bed)] == [last.column.sum(), len(last.column)]
    heights = []
    for view in (layer, bed):
        axes = Figure().add_subplot()
        view.draw_behind(axes)
        heights.append((axes.lines[0].get_ydata()[0], axes.patches[0].get_height()))
    assert heights == [(0.0, pytest.approx(0.02)), (pytest.approx(-0.02), 0.0)]


def test_the_base_has_straight_ends(folder: Path, tmp_path: Path, without_egl: None):
    render(folder, gif=False, size=SIZE, out=tmp_path / "a.png")
    view, (left, top, width, height) = fit_view(list_snapshots(folder)[-1:], SIZE, DISPLACEMENT), canvas_box(SIZE)
    bottom = view.extent[2]
    rows = [top + height - round((y - bottom) / (view.extent[3] - bottom) * height) for y in (-0.003, -0.018)]
    base = np.abs(pixels(tmp_path / "a.png")[rows[0] : rows[1]] - 181).max(axis=2) < 20
    for line in base:
        inside = np.flatnonzero(line)
        assert inside.min() == pytest.approx(column_of(0.0, view), abs=2) and inside.max() >= left + width - 2
        assert len(inside) > 0.98 * np.ptp(inside)


def test_axes_have_ticks_in_a_unit_that_suits_the_column(folder: Path):
    view, _, page = drawn_lines(folder)
    assert [page.axes[0].get_xlabel(), page.axes[0].get_ylabel()] == ["distance from the wall (mm)", "height (mm)"]
    ticks = [float(tick.get_text()) for tick in page.axes[0].get_xticklabels()]
    assert ticks == pytest.approx([1000 * x for x in page.axes[0].get_xticks()]) and len(ticks) > 3 and min(ticks) == 0
    large = replace(view, meta=view.meta | {"r_i": 2.0, "h_i": 1.0})
    axes = Figure().add_subplot()
    large.draw_before(axes)
    assert axes.get_xlabel() == "distance from the wall (m)"


def test_the_gate_is_a_vertical_line(folder: Path):
    _, lines, page = drawn_lines(folder)
    (gate,) = [line for line in lines if set(line.get_xdata()) == {META["r_i"]}]
    assert max(gate.get_ydata()) > META["h_i"] > min(gate.get_ydata()) == 0
    assert "gate" in [text.get_text() for text in page.axes[0].texts]


def test_the_heading_has_the_aspect_ratio_of_the_column(folder: Path):
    texts = [text.get_text() for text in drawn_lines(folder)[2].texts]
    assert texts[0] == "Column $x, a = 2"  # a = 3 in the title of the case
    assert texts[1] == "plane strain, $r_i$ = 50 mm, $h_i$ = 100 mm, $h$ = 10 mm, 4 points per cell"


def test_snapshot_without_the_required_metadata(tmp_path: Path, without_egl: None):
    arrays: dict[str, np.ndarray] = {
        "position": np.ones((3, 3)),
        "displacement": np.ones((3, 3)),
        "material": np.zeros(3, np.uint8),
        "id": np.arange(3),
    }
    write_snapshot(tmp_path, 0, Snapshot(0.0, 0, "collapse", arrays), {"title": "a", "model": "plane"})
    with pytest.raises(OutputError, match="metadata h_i, point_size, r_i, spacing missing"):
        render(tmp_path, gif=False)


def test_points_at_non_finite_positions_are_omitted(folder: Path, tmp_path: Path, without_egl: None):
    """The last state of a failed run can be rendered."""
    last = list_snapshots(folder)[-1]
    snapshot = read_snapshot(last)
    snapshot.arrays["position"][::50] = np.nan
    snapshot.arrays["displacement"][::50] = np.nan
    write_snapshot(tmp_path, 0, replace(snapshot, stage="failed"), META)
    assert fit_view(list_snapshots(tmp_path), SIZE, DISPLACEMENT).limits == fit_view([last], SIZE, DISPLACEMENT).limits
    render(tmp_path, gif=False, size=SIZE)
    assert coloured(pixels(tmp_path / "snapshot-000000.png")).any()


def test_an_mp4_shows_every_snapshot_and_holds_the_last(folder: Path, tmp_path: Path, without_egl: None):
    imageio_ffmpeg = pytest.importorskip("imageio_ffmpeg")
    size = (401, 301)  # H.264 needs even sizes
    rendered = render(folder, gif=True, mp4=True, size=size, out=tmp_path / "a.png")
    assert [path.name for path in rendered.paths] == ["a.png", "a.gif", "a.mp4"]
    decode = [imageio_ffmpeg.get_ffmpeg_exe(), "-i", tmp_path / "a.mp4", "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    decoded = subprocess.run(decode, capture_output=True, check=True)
    assert b"402x302" in decoded.stderr and b"25 fps" in decoded.stderr and b"h264" in decoded.stderr
    pictures = np.frombuffer(decoded.stdout, np.uint8).reshape(-1, 302 * 402 * 3)
    seconds = (animation.FRAME_MS * (STEPS - 1) + animation.LAST_FRAME_MS) / 1000
    assert len(pictures) == pytest.approx(25 * seconds, abs=2)
    changes = [np.abs(one.astype(int) - two).mean() > 1.0 for one, two in pairwise(pictures)]
    assert sum(changes) == STEPS - 1 and not any(changes[-30:])


def test_an_mp4_without_ffmpeg_is_refused_before_anything_is_drawn(
    folder: Path, tmp_path: Path, without_egl: None, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(UsageError, match=r"pip install imageio-ffmpeg.*--gif needs nothing more"):
        render(folder, gif=False, mp4=True, out=tmp_path / "a.png")
    assert not list(tmp_path.iterdir())


def test_progress_counts_all_images(folder: Path, tmp_path: Path, without_egl: None):
    counted: list[tuple[int, int]] = []
    render(folder, gif=True, size=SIZE, out=tmp_path / "a.png", progress=lambda *count: counted.append(count))
    assert counted == [(i, STEPS + 1) for i in range(1, STEPS + 2)]


@needs_egl
def test_images_are_finished_while_later_ones_are_drawn(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """The worker draws one image at a time, so that the rest of the page costs no time of its own."""
    program = (
        "import sys, json, time\n"
        "for line in sys.stdin:\n"
        "    print(json.loads(line)['image'], flush=True)\n"
        "    time.sleep(0.05)\n"
    )
    monkeypatch.setattr(backends, "WORKER", (sys.executable, "-c", program))
    view = fit_view(list_snapshots(folder), SIZE, DISPLACEMENT)
    frames = [(path, view) for path in list_snapshots(folder)]
    seen: list[str] = []
    assert backends.draw_points(frames, tmp_path, lambda image: seen.append(image.name)) == ""
    assert seen == [f"{i}.png" for i in range(STEPS)]


def test_command(folder: Path, tmp_path: Path, without_egl: None):
    target = tmp_path / "a.png"
    options = ["--gif", "--snapshot", "1", "--size", "400x300", "--out", str(target)]
    result = invoke("render", folder, *options)
    assert result.exit_code == 0
    assert result.stdout.split() == [str(target), str(target.with_suffix(".gif"))]
    assert "libegl1" in result.stderr
    with Image.open(target) as image:
        assert image.size == (400, 300)


@pytest.mark.parametrize("size", ["1280", "0x0", "ax3", "1280x-3", "99999x300", ""])
def test_command_rejects_an_invalid_size(folder: Path, size: str):
    result = invoke("render", folder, "--size", size)
    assert result.exit_code == 2 and "expected WIDTHxHEIGHT" in result.stderr


def test_help_does_not_load_the_drawing_libraries():
    program = "import sys, mpmcol.cli.render; print([m for m in ('matplotlib', 'h5py', 'numpy') if m in sys.modules])"
    child = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert child.stdout.strip() == "[]"
