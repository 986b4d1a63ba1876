"""Trials that fail in every way, for the tests of the runner."""

from __future__ import annotations

import os
from pathlib import Path

COUNT = 4


def trial(seed: int, folder: Path) -> str | None:
    """Pass, report a failure, raise an exception, or kill the process."""
    (folder / "left behind").touch()
    if seed == 3:
        os.kill(os.getpid(), 9)
    if seed == 2:
        raise ValueError("an exception")
    return "failed" if seed == 1 else None
