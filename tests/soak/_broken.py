"""Trials that go wrong in every way, for the tests of the frame."""

from __future__ import annotations

import os
from pathlib import Path

COUNT = 4


def trial(seed: int, folder: Path) -> str | None:
    """Well, wrong, an exception, and the death of the process."""
    (folder / "left behind").touch()
    if seed == 3:
        os.kill(os.getpid(), 9)
    if seed == 2:
        raise ValueError("an exception")
    return "wrong" if seed == 1 else None
