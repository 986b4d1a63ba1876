"""Cutaway and top views of a heap of known shape.

A column of radius R and height H slides off an undisturbed core, a truncated cone of radius CORE at the top and
2 CORE at the base. A point at a distance d outside the core moves outward by d and, at the top, downward by d, in
STEPS steps.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.text import Annotation
from PIL import Image
from PIL.ImageSequence import Iterator

from mpmcol.errors import OutputError, UsageError
from mpmcol.io.names import CASE_FILE, OWN_FILES
from mpmcol.io.snapshot import Meta, Snapshot, list_snapshots, write_snapshot
from mpmcol.measure import Measurement
from mpmcol.plotting import render as module
from mpmcol.plotting.render import backends, cutaway, frame, projection, render
from mpmcol.plotting.render.coloring import COLORINGS
from mpmcol.plotting.render.frame import canvas_box, read_for_rendering
from mpmcol.plotting.render.projection import TOP
from mpmcol.plotting.render.top import MOVED_COLOR, UNDISTURBED_COLOR, draw_top_view
from mpmcol.plotting.render.walls import wall_boxes, wall_surface
from tests.support.cli import invoke

DISPLACEMENT = COLORINGS["displacement"]
SIZE = (480, 270)
STEPS = 3
POINT = 0.0025
R, H, CORE = 0.05, 0.04, 0.02
FRONT = R + (R - CORE)  # of the last step
META: Meta = {"title": "Heap", "model": "quarter", "spacing": 2 * POINT, "point_size": POINT, "r_i": R, "h_i": H}

needs_egl = pytest.mark.skipif(not backends.has_egl(), reason="this machine has no libEGL")
both_backends = pytest.mark.parametrize(
    "backend", [pytest.param("pyvista", marks=needs_egl), "matplotlib"], indirect=True
)


def lattice(left: float, right: float, bottom: float, top: float, flat: bool) -> np.ndarray:
    x, y = (np.arange(a + POINT / 2, b, POINT) for a, b in ((left, right), (bottom, top)))
    grids = np.meshgrid(x, y, np.zeros(1) if flat else x, indexing="ij")
    return np.column_stack([grid.ravel() for grid in grids])


def displaced(x: np.ndarray) -> np.ndarray:
    r, y = np.hypot(x[:, 0], x[:, 2]), x[:, 1]
    slide = np.maximum(r - CORE * (2 - y / H), 0)
    return np.column_stack([slide * x[:, 0] / r, -slide * y / H, slide * x[:, 2] / r])


def fabricate(folder: Path, model: str = "quarter", has_base: bool = True, square: bool = False) -> Path:
    """Write STEPS + 1 snapshots; a `square` column is a box as wide as the cylinder."""
    left, flat = -0.1 if model == "full" else 0.0, model == "axisymmetric"
    column, base = lattice(left, R, 0, H, flat), lattice(left, 0.1, -4 * POINT, 0, flat)
    column = column[(np.abs(column) < R).all(axis=1) & (square | (np.hypot(column[:, 0], column[:, 2]) < R))]
    points = np.vstack([column, base]) if has_base else column
    meta = {**META, "model": model, "section": "box" if square else "cylinder"}
    for step in range(STEPS + 1):
        moved = np.zeros_like(points)
        moved[: len(column)] = step / STEPS * displaced(column)
        arrays = {
            "position": points + moved,
            "displacement": moved,
            "material": (np.arange(len(points)) >= len(column)).astype(np.uint8),
            "id": np.arange(len(points), dtype=np.int32),
            "mass": np.ones(len(points)),
        }
        folder.mkdir(exist_ok=True)
        write_snapshot(folder, step, Snapshot(0.1 * step, step, "collapse", arrays), meta)
    return folder


@pytest.fixture(scope="module")
def quarter(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return fabricate(tmp_path_factory.mktemp("quarter"))


@pytest.fixture(scope="module")
def axisymmetric(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """With a case file, which the measurement requires."""
    folder = fabricate(tmp_path_factory.mktemp("axisymmetric"), "axisymmetric")
    text = (Path(__file__).parents[3] / "cases/lube-cylinder.toml").read_text()
    (folder / CASE_FILE).write_text(
        text.replace("radius = 0.097", f"radius = {R}").replace("aspect = 0.9", "aspect = 0.8")
    )
    return folder


@pytest.fixture
def backend(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    name: str = getattr(request, "param", "matplotlib")
    monkeypatch.setattr(backends, "has_egl", lambda: name == "pyvista")
    return name


def drawn(folder: Path, out: Path, snapshot: int = -1) -> np.ndarray:
    render(folder, gif=False, snapshot=snapshot, size=SIZE, out=out)
    with Image.open(out) as image:
        return np.asarray(image).astype(int)


def coloured(image: np.ndarray) -> np.ndarray:
    """Mask of the pixels of the material's part of the page that are neither white nor grey."""
    left, top, width, height = canvas_box(SIZE)
    mask = np.zeros(image.shape[:2], bool)
    mask[top : top + height, left : left + width] = True
    return mask & (np.ptp(image, axis=2) > 25)


def pixel(point: tuple[float, float, float], view: cutaway.CutawayView) -> tuple[int, int]:
    """Row and column in the image of a position in space."""
    left, right, bottom, top = view.extent
    first, upper, width, height = canvas_box(SIZE)
    x, y, _ = cutaway.VIEWER @ point
    return upper + round((top - y) / (top - bottom) * height), first + round((x - left) / (right - left) * width)


@both_backends
def test_column_has_the_expected_size(quarter: Path, tmp_path: Path, backend: str):
    """At the elevation e the width is 2 R; the height combines H cos e and the depth of the top times sin e."""
    rows, columns = np.nonzero(coloured(drawn(quarter, tmp_path / "a.png", 0)))
    view = cutaway.fit_view(list_snapshots(quarter)[:1], SIZE, DISPLACEMENT)
    scale = canvas_box(SIZE)[2] / (view.extent[1] - view.extent[0])
    azimuth, elevation = np.radians((35, 28))
    front = R * np.sin(elevation) * np.cos(azimuth)  # the lower corner of the nearer cut
    height = H * np.cos(elevation) + R * np.sin(elevation) + front
    assert np.ptp(columns) == pytest.approx(2 * R * scale, abs=7)
    assert np.ptp(rows) == pytest.approx(height * scale, abs=7)


@both_backends
def test_cut_shows_the_undisturbed_core(quarter: Path, tmp_path: Path, backend: str):
    image = drawn(quarter, tmp_path / "a.png")
    view = cutaway.fit_view(list_snapshots(quarter)[-1:], SIZE, DISPLACEMENT)
    undisturbed = np.array([68, 1, 84])
    top = image[pixel((-CORE / 3, H, -CORE / 3), view)]
    assert np.abs(top - undisturbed).max() < 40
    for shade, x, z in zip(cutaway.CUT_SHADES, (0, CORE), (CORE, 0), strict=True):
        assert np.abs(image[pixel((x, H / 3, z), view)] - undisturbed).max() < 40
        row, column = pixel((x, -2 * POINT, z), view)
        base = image[row - 2 : row + 3, column - 2 : column + 3]
        assert np.ptp(base, axis=2).max() < 12 and base.mean() == pytest.approx(181 * shade, rel=0.1)
    edge = np.array([[-0.25 * R, H, 0.7 * R]])
    assert image[pixel(*(edge + displaced(edge)), view)][1] > 80  # green channel of displaced material; 1 in the core


@needs_egl
def test_both_back_ends_agree(quarter: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    ours = drawn(quarter, tmp_path / "pyvista.png")
    monkeypatch.setattr(backends, "has_egl", lambda: False)
    theirs = drawn(quarter, tmp_path / "matplotlib.png")
    both = coloured(ours) & coloured(theirs)
    assert both.sum() > 0.9 * coloured(theirs).sum()
    assert np.abs(ours[both] - theirs[both]).mean() < 30


@pytest.mark.slow
@both_backends
def test_animation(quarter: Path, tmp_path: Path, backend: str):
    rendered = render(quarter, gif=True, size=SIZE, out=tmp_path / "a.png")
    assert (rendered.paths, rendered.backend) == ([tmp_path / "a.png", tmp_path / "a.gif"], backend)
    with Image.open(tmp_path / "a.gif") as animation:
        frames = [coloured(np.asarray(page.convert("RGB")).astype(int)) for page in Iterator(animation)]
    widths = [np.ptp(np.nonzero(mask)[1]) for mask in frames]
    assert len(widths) == STEPS + 1 and widths == sorted(widths)
    assert widths[-1] / widths[0] == pytest.approx(FRONT / R, rel=0.05)


def test_omitting_hidden_points_does_not_change_the_image(
    quarter: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, backend: str
):
    fast = drawn(quarter, tmp_path / "a.png")
    view = cutaway.fit_view(list_snapshots(quarter)[-1:], SIZE, DISPLACEMENT)
    snapshot, _ = read_for_rendering(list_snapshots(quarter)[-1])
    few = len(view.points(snapshot)[0])
    monkeypatch.setattr(projection, "HIDDEN_DEPTH", np.inf)
    assert few < 0.5 * len(view.points(snapshot)[0])
    assert (np.abs(drawn(quarter, tmp_path / "b.png") - fast).max(axis=2) > 8).mean() < 1e-3


def test_a_quarter_is_drawn_like_the_full_model(quarter: Path, tmp_path: Path, backend: str):
    full = drawn(fabricate(tmp_path / "run", "full"), tmp_path / "a.png")
    heading = canvas_box(SIZE)[1]
    assert np.array_equal(full[heading:], drawn(quarter, tmp_path / "b.png")[heading:])


def test_ticks_of_the_cut_edges_are_at_their_distance_from_the_axis(quarter: Path):
    view = cutaway.fit_view(list_snapshots(quarter)[-1:], SIZE, DISPLACEMENT)
    axes = Figure().add_subplot()
    view.draw_before(axes)
    labels = [
        text for text in axes.texts if isinstance(text, Annotation) and text.get_text() in ("50", "x (mm)", "z (mm)")
    ]
    expected = [(0.05, 0.0), (view.base_radius, 0.0), (0.0, 0.05), (0.0, view.base_radius)]
    assert [text.get_text() for text in labels] == ["50", "x (mm)", "50", "z (mm)"]
    for text, (x, z) in zip(labels, expected, strict=True):
        assert text.xy == pytest.approx(cutaway.VIEWER[:2] @ (x, -view.base, z))


def test_note_states_mirroring_and_cut(quarter: Path):
    view = cutaway.fit_view(list_snapshots(quarter), SIZE, DISPLACEMENT)
    assert view.note == " (quarter mirrored, cut open)"
    assert replace(view, meta={**view.meta, "model": "full"}).note == " (cut open)"


@pytest.mark.parametrize("square", [False, True])
def test_outline_of_the_released_column(tmp_path: Path, square: bool):
    snapshot, meta = read_for_rendering(list_snapshots(fabricate(tmp_path, square=square))[-1])
    x, y = frame.released_outline(snapshot, meta, TOP).T
    assert 0.5 * abs(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1])) == pytest.approx(
        (4 if square else np.pi) * R**2, rel=1e-3
    )


def test_rigid_floor_is_drawn(tmp_path: Path, backend: str):
    image = drawn(fabricate(tmp_path, has_base=False), tmp_path / "a.png")
    view = cutaway.fit_view(list_snapshots(tmp_path)[-1:], SIZE, DISPLACEMENT)
    beside = image[pixel((-0.04, 0, 0.92 * FRONT), view)]  # the floor is a disc with 1.12 times the radius of the heap
    assert np.ptp(beside) < 12 and 120 < beside.mean() < 220
    assert (image[pixel((0.04, 0, FRONT), view)] == 255).all()  # cut away


def top_axes(folder: Path, undisturbed: float | None) -> tuple[np.ndarray, Figure]:
    """Top view of the last snapshot, as an array and as a figure."""
    figures: list[Figure] = []
    snapshot, meta = read_for_rendering(list_snapshots(folder)[-1])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(frame, "Figure", lambda **options: figures.append(Figure(**options)) or figures[0])
        image = draw_top_view(snapshot, meta, (640, 360), undisturbed)
    return np.asarray(image).astype(int), figures[0]


def is_color(image: np.ndarray, color: str) -> np.ndarray:
    return np.abs(image - 255 * np.array(to_rgb(color))).max(axis=2) < 20


@pytest.mark.parametrize("model", ["quarter", "full", "axisymmetric"])
def test_top_view_shows_the_complete_circle(tmp_path: Path, model: str):
    """Displacements of 1 mm begin 1 mm / sqrt 2 outside the core, visible between points that moved apart."""
    image, figure = top_axes(fabricate(tmp_path, model), None)
    box = figure.axes[0].get_window_extent()
    mm = box.width / np.ptp(figure.axes[0].get_xlim())
    assert box.width == pytest.approx(box.height)
    image = image[360 - round(box.y1) : 360 - round(box.y0), round(box.x0) : round(box.x1)]
    undisturbed, moved = is_color(image, UNDISTURBED_COLOR), is_color(image, MOVED_COLOR)
    radius = np.sqrt([undisturbed.sum() / np.pi, (undisturbed.sum() + moved.sum()) / np.pi]) / mm
    assert radius[0] == pytest.approx(1000 * CORE + np.sqrt(0.5), abs=1500 * POINT)
    assert radius[1] == pytest.approx(1000 * FRONT, rel=0.06)
    for turned in (image[::-1], image[:, ::-1], image.transpose(1, 0, 2)):
        assert (is_color(turned, MOVED_COLOR) != moved).mean() < 0.03


@pytest.mark.parametrize(("percent", "color"), [(0.9, UNDISTURBED_COLOR), (1.1, MOVED_COLOR)])
def test_top_view_marks_displacements_of_a_hundredth_of_the_radius(tmp_path: Path, percent: float, color: str):
    points = lattice(0, R, 0, H, flat=False)
    arrays: dict[str, np.ndarray] = {
        "position": points,
        "displacement": np.full_like(points, percent / 100 * R / np.sqrt(3)),
        "material": np.zeros(len(points), np.uint8),
        "id": np.arange(len(points)),
    }
    write_snapshot(tmp_path, 0, Snapshot(0.0, 0, "collapse", arrays), META)
    image, _ = top_axes(tmp_path, None)
    inside = image[100:260, 170:330]
    assert is_color(inside, color).mean() > 0.9


def test_circles_of_the_top_view(quarter: Path):
    for undisturbed, radii in ((0.0213, [R, 0.0213]), (0.0, [R]), (None, [R])):
        _, figure = top_axes(quarter, undisturbed)
        lines = figure.axes[0].lines
        for line, radius in zip(lines, radii, strict=True):
            assert np.hypot(*line.get_data()) == pytest.approx(1000 * radius)
    labels = [text.get_text() for text in top_axes(quarter, 0.0213)[1].legends[0].get_texts()]
    assert labels[-2:] == ["column at release, $r_i$ = 50 mm", "undisturbed radius, 21.3 mm"]
    assert labels[0] == "moved by 0.5 mm or more"


def test_axes_and_legend_of_the_top_view_fit_the_page(quarter: Path):
    _, figure = top_axes(quarter, 0.0213)
    page = figure.bbox
    for part in (figure.axes[0].get_tightbbox(), figure.legends[0].get_window_extent()):
        assert page.x0 <= part.x0 and part.x1 <= page.x1 and page.y0 <= part.y0 and part.y1 <= page.y1
    assert figure.axes[0].get_tightbbox().x1 < figure.legends[0].get_window_extent().x0


def test_top_view_of_a_run(axisymmetric: Path, monkeypatch: pytest.MonkeyPatch):
    radii: list[float | None] = []
    monkeypatch.setattr(module, "draw_top_view", lambda *given: radii.append(given[-1]) or draw_top_view(*given))
    rendered = render(axisymmetric, gif=False, view="top", size=(300, 500))
    assert rendered == ([axisymmetric / "topview.png"], "matplotlib", "")
    assert radii == [pytest.approx(CORE, abs=1.01 * POINT)]
    with Image.open(axisymmetric / "topview.png") as image:
        assert image.size == (300, 500)
    assert "topview.png" in OWN_FILES


def test_measured_radius_of_a_3d_run_is_drawn(quarter: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    measured = Measurement({}, {}, 0, 0, 0, 0, None, 0.0213, np.empty(0), np.empty(0))
    monkeypatch.setattr(module, "Results", lambda folder: SimpleNamespace(shape=None))
    monkeypatch.setattr(module, "measure_snapshot", lambda snapshot, shape: measured)
    images = []
    for radius in (0.0213, None):
        measured = replace(measured, undisturbed_radius=radius)
        render(quarter, gif=False, view="top", size=SIZE, out=tmp_path / "a.png")
        images.append((tmp_path / "a.png").read_bytes())
    assert images[0] != images[1]


def test_unavailable_views_are_rejected(quarter: Path, axisymmetric: Path, tmp_path: Path):
    with pytest.raises(UsageError, match="no side view for the quarter model; choose 3d or top"):
        render(quarter, gif=False, view="side")
    with pytest.raises(UsageError, match="no 3d view for the axisymmetric model; choose side or top"):
        render(axisymmetric, gif=False, view="3d")
    with pytest.raises(UsageError, match="no top view for the plane model; choose side$"):
        render(fabricate(tmp_path / "plane", "plane"), gif=False, view="top")
    with pytest.raises(UsageError, match="the top view is available as PNG only"):
        render(quarter, gif=True, view="top")
    with pytest.raises(OutputError, match='model = "sphere", expected one of plane, axisymmetric'):
        render(fabricate(tmp_path / "sphere", "sphere"), gif=False)


def test_command(axisymmetric: Path, quarter: Path, tmp_path: Path):
    target = tmp_path / "a.png"
    result = invoke("render", axisymmetric, "--view", "top", "--out", target)
    assert (result.exit_code, result.stdout.split(), result.stderr) == (0, [str(target)], "")
    result = invoke("render", quarter, "--view", "below")
    assert result.exit_code == 2 and "'side', '3d', 'top'" in result.stderr


def test_the_top_view_has_no_other_colours(quarter: Path) -> None:
    with pytest.raises(UsageError, match="omit --color"):
        render(quarter, gif=False, view="top", color="pressure")


CASE = """
walls = [
    { from = 0.06, to = 0.07, height = 0.02, half_width = 0.03 },
    { from = 0.055, side_from = 0.05, side_to = 0.06 },
]
"""


def test_walls_of_a_quarter_are_mirrored_and_those_without_ends_reach_the_edge() -> None:
    dams = {((s * 0.07 - (s > 0) * 0.01, 0.0, -0.03), (s * 0.07 + (s < 0) * 0.01, 0.02, 0.03)) for s in (1, -1)}
    boxes = wall_boxes({**META, "case": CASE}, 0.09)
    assert len(boxes) == 6
    np.testing.assert_allclose(sorted(boxes[:2]), sorted(dams), atol=1e-15)
    expected = {
        (min(0.055 * i, 0.09 * i), 0.0, min(0.05 * k, 0.06 * k), max(0.055 * i, 0.09 * i), H, max(0.05 * k, 0.06 * k))
        for i in (1, -1)
        for k in (1, -1)
    }
    assert {(*low, *high) for low, high in boxes[2:]} == expected
    assert len(wall_boxes({**META, "model": "full", "case": CASE}, 0.09)) == 2
    assert wall_boxes(META, 0.09) == wall_boxes({**META, "model": "plane", "case": CASE}, 0.09) == []


def test_walls_are_where_the_grid_has_them() -> None:
    h = float(META["spacing"])
    given, on_grid = (
        f"walls = [{{ from = {6.0 * h + d}, to = {8.0 * h - d}, height = {3.0 * h + d}, half_width = {5.0 * h - d} }}]"
        for d in (0.4 * h, 0.0)
    )
    moved, exact = (wall_boxes({**META, "case": case}, 0.09) for case in (given, on_grid))
    np.testing.assert_allclose(moved, exact, atol=1e-15)


def test_surfaces_of_walls_are_cut_like_the_material_and_closed() -> None:
    """Points on faces of the box, none in the removed quarter, all around what remains of it."""
    low, high = np.array([-0.02, 0.0, -0.01]), np.array([0.03, 0.02, 0.04])
    x, colors = wall_surface([(tuple(low), tuple(high))], 0.002, 1.0)
    assert not ((x[:, 0] > 0.0) & (x[:, 2] > 0.0)).any()
    on_face = np.isclose(x, low) | np.isclose(x, high) | np.isclose(x * [1, 0, 1] + [0, 1, 0], 0.0)
    assert on_face.any(axis=1).all() and (colors < 0.6).all()
    for place in (
        (0.03, 0.01, -0.005),
        (0.015, 0.01, 0.0),
        (0.0, 0.01, 0.02),
        (-0.01, 0.02, 0.02),
        (0.01, 0.02, -0.01),
    ):
        assert np.linalg.norm(x - place, axis=1).min() < 0.002


def test_walls_are_closed_where_they_are_cut_at_the_edge_of_the_base() -> None:
    box = (-0.02, 0.0, -0.01), (0.03, 0.02, 0.04)
    x, _ = wall_surface([box], 0.001, 0.015)
    assert np.hypot(x[:, 0], x[:, 2]).max() == pytest.approx(0.015)
    for angle in np.radians((100.0, 170.0, 330.0)):  # within the box, outside the removed quarter
        place = 0.015 * np.cos(angle), 0.01, 0.015 * np.sin(angle)
        assert np.linalg.norm(x - place, axis=1).min() < 0.001


def test_the_cutaway_view_shows_walls_that_hide_and_are_hidden(tmp_path: Path) -> None:
    """Of a dam at x < 0 the heap hides a part; one at x > 0 hides what lies behind it."""
    folder, walls = fabricate(tmp_path / "plain"), tmp_path / "walls"
    walls.mkdir()
    snapshot = read_for_rendering(list_snapshots(folder)[-1])[0]
    write_snapshot(walls, 0, snapshot, {**META, "section": "cylinder", "case": CASE})
    plain, view = (cutaway.fit_view(list_snapshots(path)[-1:], SIZE, DISPLACEMENT) for path in (folder, walls))
    (x, colors), (bare, _) = view.points(snapshot), plain.points(snapshot)
    grey = np.ptp(colors, axis=1) == 0.0
    surface, _ = wall_surface(wall_boxes(view.meta, view.base_radius), 0.5 * POINT, view.base_radius)
    assert 0 < grey.sum() < len(surface)
    assert 0 < (~grey).sum() < len(bare)
    left, right, bottom, top = view.extent
    assert ((x[:, 0] > left) & (x[:, 0] < right) & (x[:, 1] > bottom) & (x[:, 1] < top)).all()
