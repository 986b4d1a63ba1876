"""Pictures and animations of a results folder, from the side, in space or from above, coloured by displacement.

The points are painted by pyvista in a child process, because without a working OpenGL VTK does not fail but dies;
then, or where EGL is missing, Matplotlib paints the same points. Matplotlib always draws what is around them.
"""

from __future__ import annotations

import ctypes
import io
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from PIL import Image

from mpmcol.errors import OutputError, UsageError
from mpmcol.io.atomic import atomic_write
from mpmcol.io.results import Results, measure_snapshot
from mpmcol.io.snapshot import list_snapshots
from mpmcol.plotting import perspective, side_view
from mpmcol.plotting.frame import View, canvas_size, compose, read_drawable
from mpmcol.plotting.top_view import top_view

Frame = Callable[[Sequence[Path], tuple[int, int]], View]

FRAMES: dict[str, Frame] = {"side": side_view.frame, "3d": perspective.frame}
# The default of each model comes first.
VIEWS = {"plane": ("side",), "axisymmetric": ("side", "top"), "quarter": ("3d", "top"), "full": ("3d", "top")}

CHILD = (sys.executable, "-m", "mpmcol.plotting.render_worker")
INSTALL = "install libegl1 libgl1-mesa-dri (Debian, Ubuntu) or mesa-libEGL mesa-dri-drivers (RHEL)"
FRAME_MS, LAST_FRAME_MS = 120, 1500


class Rendered(NamedTuple):
    """The files written, what painted the points ("pyvista" or "matplotlib"), and what to install if anything."""

    paths: list[Path]
    backend: str
    note: str


def render(
    results_folder: Path,
    *,
    gif: bool,
    view: str | None = None,
    snapshot: int = -1,
    size: tuple[int, int] = (1280, 720),
    out: Path | None = None,
) -> Rendered:
    """Draw one snapshot as a PNG and, with `gif`, all of them as an animation beside it.

    view: "side", "3d" or "top", as far as the run's model has it (default: side or 3d). snapshot: which one, from 0,
    or from -1 backwards. out: the PNG (default: `snapshot-<number>.png`, from above `topview.png`, in the results
    folder); the animation takes the same name with .gif (default: `collapse.gif`).
    Raises UsageError for a view or snapshot that is not there or another kind of `out`, OutputError for unreadable
    files and where nothing can be written.
    """
    paths = list_snapshots(results_folder)
    chosen = _choose(paths, snapshot, results_folder)
    view = _choose_view(view, gif, chosen)
    target = _target(out or results_folder / ("topview.png" if view == "top" else f"snapshot-{chosen.stem}.png"))
    if view == "top":
        atomic_write(target, _encoded([_from_above(results_folder, chosen, size)], "PNG"))
        return Rendered([target], "matplotlib", "")
    pictures, note = _draw([chosen], FRAMES[view], size)
    atomic_write(target, _encoded(pictures, "PNG"))
    written = [target]
    if gif:
        pictures, note = _draw(paths, FRAMES[view], size)
        written.append(out.with_suffix(".gif") if out else results_folder / "collapse.gif")
        atomic_write(written[-1], _animation(pictures))
    return Rendered(written, "matplotlib" if note else "pyvista", note)


def _choose(paths: Sequence[Path], snapshot: int, folder: Path) -> Path:
    if not paths:
        raise OutputError(f"{folder}: no snapshots/*.vtkhdf here; give the results folder of a run")
    if not -len(paths) <= snapshot < len(paths):
        raise UsageError(f"there is no snapshot {snapshot}: {folder} has 0 to {len(paths) - 1} (-1 is the last)")
    return paths[snapshot]


def _choose_view(asked: str | None, gif: bool, path: Path) -> str:
    model = str(read_drawable(path)[1]["model"])
    views = VIEWS.get(model)
    if views is None:
        raise OutputError(f"{path}: cannot be drawn, its model {model!r} is none of {', '.join(VIEWS)}")
    view = asked or views[0]
    if view not in views:
        raise UsageError(f"there is no {view} view of a model of kind {model}; choose {' or '.join(views)}")
    if gif and view == "top":
        raise UsageError("the top view is drawn as PNG only; leave the GIF out, or choose another view")
    return view


def _target(path: Path) -> Path:
    if path.suffix != ".png":
        raise UsageError(f"{path}: a picture is written as PNG; give a name that ends in .png")
    if not path.parent.exists():
        raise OutputError(f"{path}: the folder {path.parent} does not exist; create it, or name another one")
    return path


def _from_above(folder: Path, path: Path, size: tuple[int, int]) -> Image.Image:
    snapshot, meta = read_drawable(path)
    undisturbed = measure_snapshot(snapshot, Results(folder).shape).undisturbed_radius
    return top_view(snapshot, meta, size, undisturbed)


def _draw(paths: Sequence[Path], frame: Frame, size: tuple[int, int]) -> tuple[list[Image.Image], str]:
    """One finished picture for each snapshot file, and the note of the painter."""
    view = frame(paths, size)
    with tempfile.TemporaryDirectory() as folder:
        images = [Path(folder) / f"{path.stem}.png" for path in paths]
        note = _paint(paths, images, view)
        painted = [None if note else image for image in images]
        pairs = zip(paths, painted, strict=True)
        return [compose(read_drawable(path)[0], view, image) for path, image in pairs], note


def _paint(paths: Sequence[Path], images: Sequence[Path], view: View) -> str:
    """Paint the points with pyvista into `images`; return "" or, where that cannot be, why and what to do."""
    if not _has_egl():
        return f"drawn with Matplotlib, since this machine has no libEGL; for pyvista's pictures {INSTALL}"
    files = [_write_points(path, image.with_suffix(".npz"), view) for path, image in zip(paths, images, strict=True)]
    job = {
        "points": files,
        "images": [str(path) for path in images],
        "extent": view.extent,
        "size": canvas_size(view.size),
        "point_pixels": view.point_pixels,
    }
    environment = os.environ | {"VTK_DEFAULT_OPENGL_WINDOW": "vtkEGLRenderWindow"}
    package_root = Path(__file__).resolve().parents[2]
    try:
        child = subprocess.run(
            CHILD,
            input=json.dumps(job),
            env=environment,
            cwd=package_root,
            capture_output=True,
            check=False,
            text=True,
            timeout=120 + 20 * len(paths),
        )
    except subprocess.TimeoutExpired as error:
        return f"drawn with Matplotlib, since pyvista did not end within {error.timeout} s; {INSTALL}"
    if child.returncode == 0:
        return ""
    if child.returncode < 0:
        return f"drawn with Matplotlib, since OpenGL failed (signal {-child.returncode}); {INSTALL}"
    lines = child.stderr.strip().splitlines() or ["no message"]
    return f"drawn with Matplotlib, since pyvista failed ({lines[-1]}); install pyvista anew: pip install pyvista"


def _write_points(path: Path, target: Path, view: View) -> str:
    """Write what the child paints of a snapshot; returns the name of the file."""
    x, colors = view.points(read_drawable(path)[0])
    np.savez(target, x=x.astype(np.float32), colors=np.rint(255.0 * colors).astype(np.uint8))
    return str(target)


def _has_egl() -> bool:
    try:
        ctypes.CDLL("libEGL.so.1")
    except OSError:
        return False
    return True


def _animation(pictures: Sequence[Image.Image]) -> bytes:
    # By coverage, not by count: the colour bar has few pixels but needs all of its colours.
    frames = [picture.quantize(256, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE) for picture in pictures]
    times = [FRAME_MS] * (len(frames) - 1) + [LAST_FRAME_MS]
    return _encoded(frames, "GIF", save_all=True, append_images=frames[1:], duration=times, loop=0)


def _encoded(pictures: Sequence[Image.Image], kind: str, **options: Any) -> bytes:
    buffer = io.BytesIO()
    pictures[0].save(buffer, kind, **options)
    return buffer.getvalue()
