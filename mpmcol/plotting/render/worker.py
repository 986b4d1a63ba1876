"""Child process of `mpmcol.plotting.render.backends`: reads a job (JSON) from stdin and draws points with pyvista."""

from __future__ import annotations

import json
import sys
from typing import Any

import numpy as np
import pyvista

OVERSAMPLING = 2  # The caller scales the image down, which smooths the edges.


def draw(job: dict[str, Any]) -> None:
    """Draw each file of `points` into the file with the same index in `images`."""
    window = [OVERSAMPLING * pixels for pixels in job["size"]]
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
    _set_camera(plotter, job["extent"], x[:, 2].min(), x[:, 2].max())
    plotter.add_mesh(
        pyvista.PolyData(x),
        scalars=colors,
        rgb=True,
        style="points",
        render_points_as_spheres=True,
        point_size=OVERSAMPLING * job["point_pixels"],
        ambient=0.6,
        diffuse=0.5,
        reset_camera=False,
    )


def _set_camera(plotter: Any, extent: list[float], rear: float, front: float) -> None:
    left, right, bottom, top = extent
    x, y = (left + right) / 2, (bottom + top) / 2
    distance = right - left  # from the nearest point
    plotter.camera_position = [(x, y, front + distance), (x, y, rear), (0, 1, 0)]
    plotter.enable_parallel_projection()
    plotter.camera.parallel_scale = (top - bottom) / 2
    plotter.camera.clipping_range = (0.5 * distance, 1.5 * distance + front - rear)


if __name__ == "__main__":
    draw(json.load(sys.stdin))
