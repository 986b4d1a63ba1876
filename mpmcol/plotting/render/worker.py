"""Child process of `mpmcol.plotting.render.backends`: draws points with pyvista.

Each line of stdin is a job (JSON) with the file of the points; when its image is written, its name is printed.
"""

from __future__ import annotations

import json
import sys
from typing import Any

import numpy as np
import pyvista
from PIL import Image

OVERSAMPLING = 2  # The image is scaled down, which smooths the edges.


def main() -> None:
    """Draw the jobs, which have equal sizes."""
    plotter: Any = None
    for line in sys.stdin:
        job = json.loads(line)
        if plotter is None:
            plotter = pyvista.Plotter(off_screen=True, window_size=[OVERSAMPLING * pixels for pixels in job["size"]])
            plotter.ren_win.SetMultiSamples(0)  # no second smoothing, which takes half of the time
        _add_points(plotter, job)
        pixels = plotter.screenshot(None, return_img=True, transparent_background=True)
        Image.fromarray(pixels).reduce(OVERSAMPLING).save(job["image"], compress_level=1)
        plotter.clear_actors()
        print(job["image"], flush=True)


def _add_points(plotter: Any, job: dict[str, Any]) -> None:
    with np.load(job["points"]) as arrays:
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
    main()
