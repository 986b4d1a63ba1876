"""Pictures of reports: which moment of the collapse stands for the animation."""

from __future__ import annotations

import base64
import io
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from PIL import Image

from mpmcol.report import pictures


def test_the_animation_is_printed_at_the_largest_kinetic_energy(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also if that snapshot is none of the frames, which are fewer than the snapshots."""
    paths = [Path(f"{i}.vtkhdf") for i in range(100)]
    time = np.linspace(0.0, 0.99, 331)
    history = {"time": time, "kinetic": np.exp(-(((time - 0.618) / 0.1) ** 2))}
    drawn: list[int] = []

    def images(results: Any, chosen: list[Path], color: str) -> SimpleNamespace:
        drawn.extend(int(path.stem) for path in chosen)
        return SimpleNamespace(images=lambda: [Image.new("RGB", (4, 4), (i, 0, 0)) for i in drawn])

    monkeypatch.setattr(pictures, "read_meta", lambda path: {"time": 0.01 * int(path.stem)})
    monkeypatch.setattr(pictures, "_point_images", images)
    results: Any = SimpleNamespace(snapshots=paths, released_history=history)
    still = pictures.animation(results).still
    with Image.open(io.BytesIO(base64.b64decode(still.partition(",")[2]))) as image:
        assert image.convert("RGB").getpixel((0, 0)) == (62, 0, 0)
    assert drawn == sorted(set(drawn)) and len(drawn) == pictures.MOST_FRAMES + 1 and {0, 62, 99} <= set(drawn)
