"""Child process of `mpmcol.render`: reads a job (JSON) from stdin and paints each snapshot into a PNG with pyvista."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import pyvista

from mpmcol.picture import BASE_COLOR, COLORS
from mpmcol.snapshot import read_snapshot

# Painted this much finer than asked for; the picture scales it down, which smooths the edges.
FINER = 2


def paint(job: dict[str, Any]) -> None:
    """Paint the points of each of `snapshots` into the file of the same place in `images`, nothing around them."""
    window = [FINER * pixels for pixels in job["size"]]
    plotter: Any = pyvista.Plotter(off_screen=True, window_size=window)
    plotter.set_background("white")
    _look_at(plotter, *job["extent"])
    for snapshot, image in zip(job["snapshots"], job["images"], strict=True):
        _add_points(plotter, Path(snapshot), job)
        plotter.screenshot(image, return_img=False)
        plotter.clear_actors()
    plotter.close()


def _look_at(plotter: Any, left: float, right: float, bottom: float, top: float) -> None:
    x, y = (left + right) / 2, (bottom + top) / 2
    distance = right - left
    plotter.camera_position = [(x, y, distance), (x, y, 0), (0, 1, 0)]
    plotter.enable_parallel_projection()
    plotter.camera.parallel_scale = (top - bottom) / 2
    plotter.camera.clipping_range = (0.01 * distance, 10 * distance)


def _add_points(plotter: Any, path: Path, job: dict[str, Any]) -> None:
    snapshot = read_snapshot(path)
    style: dict[str, Any] = {
        "style": "points",
        "render_points_as_spheres": True,
        "point_size": FINER * job["point_pixels"],
        "ambient": 0.6,
        "diffuse": 0.5,
        "reset_camera": False,
    }
    points, column = snapshot.arrays["position"], snapshot.column
    if not column.all():
        plotter.add_mesh(pyvista.PolyData(points[~column]), color=BASE_COLOR, **style)
    moved = snapshot.displacement_magnitude[column]
    scale = {"cmap": COLORS, "clim": (0, job["limit"]), "show_scalar_bar": False}
    plotter.add_mesh(pyvista.PolyData(points[column]), scalars=moved, **scale, **style)


if __name__ == "__main__":
    paint(json.load(sys.stdin))
