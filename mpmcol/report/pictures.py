"""Pictures of runs, and picture files, as data URIs."""

from __future__ import annotations

import base64
import io
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PIL import Image

from mpmcol.errors import OutputError
from mpmcol.integrity.readable import read_error
from mpmcol.io.results import Results
from mpmcol.io.snapshot import read_meta
from mpmcol.plotting.comparison import chart_comparison
from mpmcol.plotting.render import VIEWS
from mpmcol.plotting.run_charts import chart_run
from mpmcol.report.model import Picture
from mpmcol.report.point_images import PointImages, encode_animation, encode_image

TYPES = {".png": "image/png", ".gif": "image/gif", ".svg": "image/svg+xml"}
CHARTS = {  # file of `mpmcol plot` -> what it shows, caption
    "profile.png": (
        "Chart of the height of the deposit over the distance, at several times",
        "Profiles of the deposit",
    ),
    "front.png": (
        "Chart of the runout and the height over time",
        "Runout by each definition of the front, and height, over time",
    ),
    "energy.png": (
        "Chart of the energies over time, in per cent of the potential energy at release",
        "Energy balance, in per cent of the potential energy at release",
    ),
    "walls.png": (
        "Chart of the forces on walls over time, and of the pressure on them over the height",
        "Forces on walls over time; pressures beside the active and passive ones of the material",
    ),
}
COMPARISON_CHARTS = {
    "profile.png": ("Chart of the height of the last state of each run over the distance", "Last state of each run"),
    "front.png": (
        "Chart of the runout and the height of each run over time",
        "Runout by front_height, and height, of each run over time",
    ),
    "energy.png": (
        "Chart of three energies of each run over time, in per cent of the potential energy at release",
        "Potential energy released, kinetic energy and plastic work, in per cent of the potential energy at release",
    ),
}
MOST_FRAMES = 24
OBLIQUE_FLATNESS = 0.55  # of the image of a 3D model


def chart_pictures(results: Results) -> list[Picture]:
    """The charts that `mpmcol plot` draws."""
    with tempfile.TemporaryDirectory() as folder:
        paths = chart_run(results, out=Path(folder))
        return [file_picture(path, *CHARTS[path.name]) for path in paths]


def comparison_pictures(runs: Sequence[Results]) -> list[Picture]:
    """The charts of several runs in common axes that `mpmcol plot` draws."""
    with tempfile.TemporaryDirectory() as folder:
        paths = chart_comparison(runs, out=Path(folder))
        return [file_picture(path, *COMPARISON_CHARTS[path.name]) for path in paths]


def animation(results: Results) -> Picture:
    """The collapse with the points coloured by their speed."""
    paths, fastest = results.snapshots, _fastest(results)
    chosen = np.linspace(0, len(paths) - 1, min(len(paths), MOST_FRAMES)).round().astype(int)
    frames = sorted({*chosen.tolist(), fastest})
    images = _point_images(results, [paths[i] for i in frames], "velocity").images()
    still = images[frames.index(fastest)]
    return Picture(
        _data_uri(encode_animation(images), TYPES[".gif"]),
        "Animation of the collapse: material points, coloured by speed",
        "Collapse, material points coloured by speed",
        still.size,
        _data_uri(encode_image(still), TYPES[".png"]),
    )


def _fastest(results: Results) -> int:
    """Index of the snapshot nearest to the time of the largest kinetic energy since the release."""
    history = results.released_history
    time = history["time"][history["kinetic"].argmax()]
    moments = np.array([float(read_meta(path)["time"]) for path in results.snapshots])
    return int(np.abs(moments - time).argmin())


def deposit_picture(results: Results) -> Picture:
    """The final state with the points coloured by pressure."""
    image = _point_images(results, results.snapshots[-1:], "pressure").image(0)
    state = "Deposit" if results.came_to_rest else "Last state, still moving"
    return Picture(
        _data_uri(encode_image(image), TYPES[".png"]),
        f"{state}: material points, coloured by pressure",
        f"{state}, material points coloured by pressure (mean of each cell)",
        image.size,
    )


def file_picture(path: Path, alt: str, caption: str) -> Picture:
    """A picture file. Raises OutputError if it cannot be read."""
    if not path.is_file():
        raise OutputError(f"{path} is missing; repeat the command that writes it")
    if error := read_error(path):
        raise OutputError(f"{path} is damaged: {error}; repeat the command that writes it")
    data = path.read_bytes()
    with Image.open(io.BytesIO(data)) as image:
        return Picture(_data_uri(data, TYPES[path.suffix]), alt, caption, image.size)


def _point_images(results: Results, paths: Sequence[Path], color: str) -> PointImages:
    shape = results.shape
    if shape.dimension == 3:
        return PointImages(paths, VIEWS[shape.model][0], color, OBLIQUE_FLATNESS)
    length = max(results.history["front_max"].max(), shape.r_i)
    height = max(results.history["height"].max(), shape.h_i) + results.summary["base_used"]
    return PointImages(paths, VIEWS[shape.model][0], color, height / length)


def _data_uri(data: bytes, kind: str) -> str:
    return f"data:{kind};base64,{base64.b64encode(data).decode()}"
