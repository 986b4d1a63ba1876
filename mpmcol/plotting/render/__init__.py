"""Images and animations of a run: its material points from the side, in a cutaway view or from above.

The side and cutaway views are coloured by a quantity of the points (`coloring.py`); the top view shows where the
surface of the deposit moved.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import numpy as np
from PIL import Image

from mpmcol.errors import OutputError, UsageError
from mpmcol.io.atomic import atomic_write
from mpmcol.io.names import HISTORY_FILE
from mpmcol.io.results import Results, measure_snapshot, read_history
from mpmcol.io.run_snapshots import find_snapshot, run_snapshots
from mpmcol.plotting.limits import require_image
from mpmcol.plotting.render import animation, cutaway, side
from mpmcol.plotting.render.backends import draw_frames
from mpmcol.plotting.render.coloring import COLORINGS, Coloring
from mpmcol.plotting.render.frame import PAGE, View, read_for_rendering
from mpmcol.plotting.render.top import draw_top_view

FitView = Callable[[Sequence[Path], tuple[int, int] | None, Coloring, float], View]

FIT_VIEW: dict[str, FitView] = {"side": side.fit_view, "3d": cutaway.fit_view}
# The default of each model comes first.
VIEWS = {"plane": ("side",), "axisymmetric": ("side", "top"), "quarter": ("3d", "top"), "full": ("3d", "top")}


class Rendered(NamedTuple):
    """The files written, the back end that drew the points ("pyvista" or "matplotlib"), and what to install, if any."""

    paths: list[Path]
    backend: str
    note: str


def render(
    results_folder: Path,
    *,
    gif: bool,
    mp4: bool = False,
    view: str | None = None,
    color: str = "displacement",
    snapshot: int = -1,
    size: tuple[int, int] | None = None,
    out: Path | None = None,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Rendered:
    """Draw one snapshot as a PNG and, with `gif` or `mp4`, all snapshots as an animation.

    Args:
        results_folder: of the run.
        gif, mp4: also write the animation, beside the PNG, in this format.
        view: "side", "3d" or "top", if the model of the run has it (default: "side" in 2D, "3d" in 3D).
        color: quantity by which the points are coloured: "displacement", "velocity", "pressure", "shear",
            "inertial" (law mu-i) or "friction" (law mohr-coulomb-random).
        snapshot: index of the snapshot; negative indices count from the end.
        size: width and height, pixels (default: 1280 wide; in the side view as high as needed, else 720).
        out: the PNG (default: `snapshot-<number>.png`, or `topview.png`, in the results folder). The animation takes
            the same name with the suffix .gif or .mp4 (default: `collapse.gif`, `collapse.mp4`).
        progress: receives the number of finished images and their total number.

    Raises:
        UsageError: there is no such colour or size, the model has no such view, the view no colours, the law no such
            quantity, the run no such snapshot, or `out` is not a PNG, or an MP4 is wanted without ffmpeg.
        OutputError: a file cannot be read or written.
    """
    require_image(color, size)
    chosen = find_snapshot(results_folder, snapshot)
    view = _choose_view(view, gif or mp4, chosen)
    target = _target(out or results_folder / ("topview.png" if view == "top" else f"snapshot-{chosen.stem}.png"))
    if view == "top":
        if color != "displacement":
            raise UsageError("the top view shows which points have moved; omit --color or choose another view")
        atomic_write(target, _encode(_top_view_of(results_folder, chosen, size or PAGE)))
        return Rendered([target], "matplotlib", "")
    encoders = {".gif": animation.gif} if gif else {}
    if mp4:
        animation.require_mp4()
        encoders[".mp4"] = animation.mp4
    reach, fit_view = _largest_front(results_folder), FIT_VIEW[view]
    frames = _frames(
        chosen,
        run_snapshots(results_folder) if encoders else [],
        lambda paths: fit_view(paths, size, COLORINGS[color], reach),
    )
    images, note = draw_frames(frames, lambda done: progress(done, len(frames)))
    atomic_write(target, _encode(images[0]))
    written = [target]
    for suffix, encode in encoders.items():
        written.append(out.with_suffix(suffix) if out else results_folder / f"collapse{suffix}")
        atomic_write(written[-1], encode(images[1:]))
    return Rendered(written, "matplotlib" if note else "pyvista", note)


def _frames(chosen: Path, paths: Sequence[Path], fit_view: Callable[[Sequence[Path]], View]) -> list[tuple[Path, View]]:
    """The chosen snapshot with a scale of colours of its own, then those of the animation in a view that fits all."""
    frames = [(chosen, fit_view([chosen]))]
    if paths:
        common = fit_view(paths)
        frames += [(path, common) for path in paths]
    return frames


def _largest_front(folder: Path) -> float:
    """The largest front_max of the run, m, so that images of all its snapshots have the same range; 0 if unknown."""
    with suppress(OutputError, ValueError):
        return float(np.nanmax(read_history(folder / HISTORY_FILE)["front_max"]))
    return 0.0


def _choose_view(requested: str | None, animated: bool, path: Path) -> str:
    model = str(read_for_rendering(path)[1]["model"])
    views = VIEWS.get(model)
    if views is None:
        raise OutputError(f'{path}: cannot be rendered; model = "{model}", expected one of {", ".join(VIEWS)}')
    view = requested or views[0]
    if view not in views:
        raise UsageError(f"no {view} view for the {model} model; choose {' or '.join(views)}")
    if animated and view == "top":
        raise UsageError("the top view is available as PNG only; omit --gif and --mp4, or choose another view")
    return view


def _target(path: Path) -> Path:
    if path.suffix != ".png":
        raise UsageError(
            f"{path}: images are written as PNG; give a file name that ends in .png; --gif and --mp4 "
            "write an animation beside it"
        )
    if not path.parent.exists():
        raise OutputError(f"{path}: the folder {path.parent} does not exist; create it or choose another one")
    return path


def _top_view_of(folder: Path, path: Path, size: tuple[int, int]) -> Image.Image:
    snapshot, meta = read_for_rendering(path)
    undisturbed = measure_snapshot(snapshot, Results(folder).shape).undisturbed_radius
    return draw_top_view(snapshot, meta, size, undisturbed)


def _encode(image: Image.Image) -> bytes:
    buffer = io.BytesIO()
    image.save(buffer, "PNG")
    return buffer.getvalue()
