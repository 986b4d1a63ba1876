"""Images of the material points that NumPy draws."""

from __future__ import annotations

import io

import numpy as np
from PIL import Image

from mpmcol.report.point_images import encode_animation, paint_points

WHITE, RED, GREEN = (255, 255, 255), (255, 0, 0), (0, 255, 0)
EXTENT = (0.0, 4.0, 0.0, 2.0)  # m


def painted(positions: list[tuple[float, float, float]], colors: list[tuple[int, int, int]], side: float) -> np.ndarray:
    image = np.full((20, 40, 3), 255, np.uint8)
    paint_points(image, np.array(positions), np.array(colors) / 255.0, EXTENT, side)
    return image


def test_a_point_is_a_square_at_its_position() -> None:
    image = painted([(1.0, 0.5, 0.0)], [RED], 4.0)
    rows, columns = np.nonzero((image == RED).all(axis=2))
    assert (rows.min(), rows.max(), columns.min(), columns.max()) == (13, 16, 8, 11)  # y = 0.5 is row 15, from the top
    assert len(rows) == 16


def test_the_point_nearest_to_the_viewer_covers_the_others() -> None:
    for heights in ((0.0, 1.0), (1.0, 0.0)):
        image = painted([(1.0, 1.0, heights[0]), (1.1, 1.0, heights[1])], [RED, GREEN], 6.0)
        nearest = (RED, GREEN)[int(np.argmax(heights))]
        assert (image == nearest).all(axis=2).sum() == 36


def test_points_beyond_the_edges_are_cut() -> None:
    image = painted([(0.0, 0.0, 0.0), (4.0, 2.0, 0.0), (9.0, -9.0, 0.0)], [RED, RED, RED], 4.0)
    assert (image == RED).all(axis=2).sum() == 8
    assert tuple(image[0, 0]) == tuple(image[-1, -1]) == WHITE


def test_an_animation_keeps_white_and_all_frames() -> None:
    grey = [np.full((30, 30, 3), 255, np.uint8) for _ in range(3)]
    for i, frame in enumerate(grey):
        frame[10:20, 10:20] = np.arange(100).reshape(10, 10, 1) + 100 + 25 * i
        frame[0, 5:20] = np.arange(238, 253)[:, None]
    animation = Image.open(io.BytesIO(encode_animation([Image.fromarray(frame) for frame in grey])))
    assert animation.n_frames == 3  # type: ignore[attr-defined]
    for i in range(3):
        animation.seek(i)
        assert animation.convert("RGB").getpixel((29, 29)) == WHITE
