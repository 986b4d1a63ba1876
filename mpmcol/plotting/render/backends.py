"""Back ends that draw the material points: pyvista in a child process, or Matplotlib.

VTK terminates the process if OpenGL does not work, hence the child process. Matplotlib draws the points if the child
fails or libEGL is missing, and always adds the surroundings (scale bar, colour bar, heading).
"""

from __future__ import annotations

import ctypes
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PIL import Image

from mpmcol.plotting.render.frame import View, canvas_size, compose, read_for_rendering

# By path: `-m` would import this package, which the child does not need.
WORKER = (sys.executable, "-P", str(Path(__file__).with_name("worker.py")))
IS_LINUX = sys.platform == "linux"
INSTALL = (
    "install libegl1 libgl1-mesa-dri (Debian, Ubuntu) or mesa-libEGL mesa-dri-drivers (RHEL)"
    if IS_LINUX
    else "update the graphics driver"
)


def draw_frames(paths: Sequence[Path], view: View) -> tuple[list[Image.Image], str]:
    """One finished image for each snapshot file; also why Matplotlib drew the points, or ""."""
    with tempfile.TemporaryDirectory() as folder:
        images = [Path(folder) / f"{path.stem}.png" for path in paths]
        note = draw_points(paths, images, view)
        drawn = [None if note else image for image in images]
        pairs = zip(paths, drawn, strict=True)
        return [compose(read_for_rendering(path)[0], view, image) for path, image in pairs], note


def draw_points(paths: Sequence[Path], images: Sequence[Path], view: View) -> str:
    """Draw the points with pyvista into the files `images`; returns "", or why that failed and how to fix it."""
    if not has_egl():
        return f"drawn with Matplotlib, because this machine has no libEGL; for rendering by pyvista {INSTALL}"
    files = [_write_points(path, image.with_suffix(".npz"), view) for path, image in zip(paths, images, strict=True)]
    job = {
        "points": files,
        "images": [str(path) for path in images],
        "extent": view.extent,
        "size": canvas_size(view.size),
        "point_pixels": view.point_pixels,
    }
    environment = os.environ | ({"VTK_DEFAULT_OPENGL_WINDOW": "vtkEGLRenderWindow"} if IS_LINUX else {})
    try:
        child = subprocess.run(
            WORKER,
            input=json.dumps(job),
            env=environment,
            capture_output=True,
            check=False,
            encoding="utf-8",
            errors="replace",
            timeout=120 + 20 * len(paths),
        )
    except subprocess.TimeoutExpired as error:
        return f"drawn with Matplotlib, because pyvista did not finish within {error.timeout} s; {INSTALL}"
    if child.returncode == 0:
        return ""
    if child.returncode < 0:
        return f"drawn with Matplotlib, because OpenGL failed (signal {-child.returncode}); {INSTALL}"
    lines = child.stderr.strip().splitlines() or ["no message"]
    return f"drawn with Matplotlib, because pyvista failed ({lines[-1]}); reinstall it: pip install pyvista"


def has_egl() -> bool:
    """Whether the EGL library can be loaded, by which Linux draws without a display; other systems need none."""
    if not IS_LINUX:
        return True
    try:
        ctypes.CDLL("libEGL.so.1")
    except OSError:
        return False
    return True


def _write_points(path: Path, target: Path, view: View) -> str:
    """Write positions and colours of a snapshot's points for the worker; returns the file name."""
    x, colors = view.points(read_for_rendering(path)[0])
    np.savez(target, x=x.astype(np.float32), colors=np.rint(255.0 * colors).astype(np.uint8))
    return str(target)
