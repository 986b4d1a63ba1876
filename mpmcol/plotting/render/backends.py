"""Back ends that draw the material points: pyvista in a child process, or Matplotlib.

VTK terminates the process if OpenGL does not work, hence the child process. Matplotlib draws the points if the child
fails or libEGL is missing, and always adds the surroundings (axes, colour bar, heading).
"""

from __future__ import annotations

import contextlib
import ctypes
import json
import os
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from mpmcol.plotting.render.frame import Page, View, canvas_size, read_for_rendering

# By path: `-m` would import this package, which the child does not need.
WORKER = (sys.executable, "-P", str(Path(__file__).with_name("worker.py")))
IS_LINUX = sys.platform == "linux"
INSTALL = (
    "install libegl1 libgl1-mesa-dri (Debian, Ubuntu) or mesa-libEGL mesa-dri-drivers (RHEL)"
    if IS_LINUX
    else "update the graphics driver"
)


def draw_frames(
    frames: Sequence[tuple[Path, View]], progress: Callable[[int], None] = lambda done: None
) -> tuple[list[Image.Image], str]:
    """One finished image for each snapshot file in its view; also why Matplotlib drew the points, or "".

    `progress` receives the number of finished images.
    """
    pages: dict[int, Page] = {}  # by identity of the view
    finished: list[Image.Image] = []

    def finish(image: Path | None) -> None:
        path, view = frames[len(finished)]
        if id(view) not in pages:
            pages[id(view)] = Page(view)
        finished.append(pages[id(view)].draw(read_for_rendering(path)[0], image))
        progress(len(finished))

    with tempfile.TemporaryDirectory() as folder:
        note = draw_points(frames, Path(folder), finish)
    while note and len(finished) < len(frames):
        finish(None)
    return finished, note


def draw_points(frames: Sequence[tuple[Path, View]], folder: Path, finish: Callable[[Path], None]) -> str:
    """Draw the points with pyvista and pass each image on to `finish`, in order, while the next one is drawn.

    Returns "", or why that failed and how to fix it.
    """
    if not has_egl():
        return f"drawn with Matplotlib, because this machine has no libEGL; for rendering by pyvista {INSTALL}"
    window = {"VTK_DEFAULT_OPENGL_WINDOW": "vtkEGLRenderWindow"} if IS_LINUX else {}
    environment = os.environ | window | {"PYTHONIOENCODING": "utf-8"}  # of the paths that both exchange
    limit = 120 + 20 * len(frames)
    errors = folder / "errors.txt"
    pipe: dict[str, Any] = {
        "stdin": subprocess.PIPE,
        "stdout": subprocess.PIPE,
        "encoding": "utf-8",
        "env": environment,
    }
    with (
        errors.open("w", encoding="utf-8") as stderr,
        subprocess.Popen(WORKER, stderr=stderr, **pipe) as child,
        ThreadPoolExecutor(1) as feeder,
    ):
        timer = threading.Timer(limit, child.kill)
        timer.start()
        try:
            fed = feeder.submit(_feed, child, frames, folder)
            for line in child.stdout or ():
                finish(Path(line.rstrip("\n")))
            code = child.wait()
        finally:
            expired = not timer.is_alive()
            timer.cancel()
            child.kill()
    fed.result()
    if code == 0:
        return ""
    if expired:
        return f"drawn with Matplotlib, because pyvista did not finish within {limit} s; {INSTALL}"
    if code < 0:
        return f"drawn with Matplotlib, because OpenGL failed (signal {-code}); {INSTALL}"
    lines = errors.read_text("utf-8", errors="replace").strip().splitlines() or ["no message"]
    return f"drawn with Matplotlib, because pyvista failed ({lines[-1]}); reinstall it: pip install pyvista"


def _feed(child: Any, frames: Sequence[tuple[Path, View]], folder: Path) -> None:
    """Write the jobs of the worker, until it ends."""
    with contextlib.suppress(BrokenPipeError), child.stdin as jobs:
        for i, (path, view) in enumerate(frames):
            points = folder / f"{i}.npz"
            _write_points(path, points, view)
            job = {
                "points": str(points),
                "image": str(points.with_suffix(".png")),
                "extent": view.extent,
                "size": canvas_size(view.size),
                "point_pixels": view.point_pixels,
            }
            jobs.write(json.dumps(job) + "\n")
            jobs.flush()


def has_egl() -> bool:
    """Whether the EGL library can be loaded, by which Linux draws without a display; other systems need none."""
    if not IS_LINUX:
        return True
    try:
        ctypes.CDLL("libEGL.so.1")
    except OSError:
        return False
    return True


def _write_points(path: Path, target: Path, view: View) -> None:
    """Write positions and colours of a snapshot's points for the worker."""
    x, colors = view.points(read_for_rendering(path)[0])
    np.savez(target, x=x.astype(np.float32), colors=np.rint(255.0 * colors).astype(np.uint8))
