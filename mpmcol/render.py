"""Pictures and animations of a results folder: the points coloured by how far they moved.

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
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from PIL import Image

from mpmcol.errors import OutputError, UsageError
from mpmcol.files import atomic_write
from mpmcol.picture import View, canvas_size, compose, frame
from mpmcol.snapshot import list_snapshots, read_snapshot

CHILD = (sys.executable, "-m", "mpmcol._render")
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
    snapshot: int = -1,
    size: tuple[int, int] = (1280, 720),
    out: Path | None = None,
) -> Rendered:
    """Draw one snapshot as a PNG and, with `gif`, all of them as an animation beside it.

    snapshot: which one, from 0, or from -1 backwards. out: the PNG (default: `snapshot-<number>.png` in the
    results folder); the animation takes the same name with .gif (default: `collapse.gif`).
    Raises UsageError for a snapshot that is not there or another kind of `out`, OutputError for unreadable files
    and where nothing can be written.
    """
    paths = list_snapshots(results_folder)
    chosen = _choose(paths, snapshot, results_folder)
    target = out or results_folder / f"snapshot-{chosen.stem}.png"
    if target.suffix != ".png":
        raise UsageError(f"{target}: a picture is written as PNG; give a name that ends in .png")
    if not target.parent.exists():
        raise OutputError(f"{target}: the folder {target.parent} does not exist; create it, or name another one")
    pictures, note = _draw([chosen], size)
    atomic_write(target, _encoded(pictures, "PNG"))
    written = [target]
    if gif:
        pictures, note = _draw(paths, size)
        written.append(out.with_suffix(".gif") if out else results_folder / "collapse.gif")
        atomic_write(written[-1], _animation(pictures))
    return Rendered(written, "matplotlib" if note else "pyvista", note)


def _choose(paths: Sequence[Path], snapshot: int, folder: Path) -> Path:
    if not paths:
        raise OutputError(f"{folder}: no snapshots/*.vtkhdf here; give the results folder of a run")
    if not -len(paths) <= snapshot < len(paths):
        raise UsageError(f"there is no snapshot {snapshot}: {folder} has 0 to {len(paths) - 1} (-1 is the last)")
    return paths[snapshot]


def _draw(paths: Sequence[Path], size: tuple[int, int]) -> tuple[list[Image.Image], str]:
    """One finished picture for each snapshot file, and the note of the painter."""
    view = frame(paths, size)
    with tempfile.TemporaryDirectory() as folder:
        images = [Path(folder) / f"{path.stem}.png" for path in paths]
        note = _paint(paths, images, view)
        painted = [None if note else image for image in images]
        pairs = zip(paths, painted, strict=True)
        return [compose(read_snapshot(path), view, image) for path, image in pairs], note


def _paint(paths: Sequence[Path], images: Sequence[Path], view: View) -> str:
    """Paint the points with pyvista into `images`; return "" or, where that cannot be, why and what to do."""
    if not _has_egl():
        return f"drawn with Matplotlib, since this machine has no libEGL; for pyvista's pictures {INSTALL}"
    job = {
        "snapshots": [str(path.resolve()) for path in paths],
        "images": [str(path) for path in images],
        "extent": view.extent,
        "size": canvas_size(view.size),
        "limit": view.limit,
        "point_pixels": view.point_pixels,
    }
    environment = os.environ | {"VTK_DEFAULT_OPENGL_WINDOW": "vtkEGLRenderWindow"}
    package_root = Path(__file__).resolve().parents[1]
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
