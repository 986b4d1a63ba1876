"""Child process of `mpmcol.plotting.render`: reads a job (JSON) from stdin and draws the points of each file."""

from __future__ import annotations

import json
import sys
from typing import Any

import numpy as np
import pyvista

# Painted this much finer than asked for; the picture scales it down, which smooths the edges.
FINER = 2


def paint(job: dict[str, Any]) -> None:
    """Paint the points of each of `points` into the file of the same place in `images`, nothing around them."""
    window = [FINER * pixels for pixels in job["size"]]
    plotter: Any = pyvista.Plotter(off_screen=True, window_size=window)
    plotter.set_background("white")
    for points, image in zip(job["points"], job["images"], strict=True):
        _add_points(plotter, points, job)
        plotter.screenshot(image, return_img=False)
        plotter.clear_actors()
    plotter.close()


def _add_points(plotter: Any, file: str, job: dict[str, Any]) -> None:
    with np.load(file) as arrays:
        x, colors = arrays["x"], arrays["colors"]
    _look_at(plotter, job["extent"], x[:, 2].min(), x[:, 2].max())
    plotter.add_mesh(
        pyvista.PolyData(x),
        scalars=colors,
        rgb=True,
        style="points",
        render_points_as_spheres=True,
        point_size=FINER * job["point_pixels"],
        ambient=0.6,
        diffuse=0.5,
        reset_camera=False,
    )


def _look_at(plotter: Any, extent: list[float], rear: float, front: float) -> None:
    left, right, bottom, top = extent
    x, y = (left + right) / 2, (bottom + top) / 2
    distance = right - left  # from the nearest point
    plotter.camera_position = [(x, y, front + distance), (x, y, rear), (0, 1, 0)]
    plotter.enable_parallel_projection()
    plotter.camera.parallel_scale = (top - bottom) / 2
    plotter.camera.clipping_range = (0.5 * distance, 1.5 * distance + front - rear)


if __name__ == "__main__":
    paint(json.load(sys.stdin))
