"""Which code computed a result: the version and a digest of the sources that decide numbers."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path

from mpmcol import __version__

# Neither the words of a case file, whose values are in every resolved case, nor what only shows results.
DECIDING = (
    "basis", "bounds.py", "experiments", "geometries", "grid.py", "jit.py", "kernels", "laws", "layout.py", "measure",
    "outcome.py", "recorder.py", "results.py", "scene.py", "simd", "simulation.py", "snapshot.py", "solver.py",
    "stages.py", "state.py", "time_step.py", "vtkhdf.py", "watch.py",
)  # fmt: skip


@cache
def code_version() -> str:
    """The version with eight digits of the digest, for example "0.1.0+3f2a9c1b"."""
    digest, package = hashlib.sha256(), Path(__file__).parent
    for name in DECIDING:
        entry = package / name
        for path in sorted(entry.rglob("*.py")) if entry.is_dir() else [entry]:
            digest.update(path.relative_to(package).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return f"{__version__}+{digest.hexdigest()[:8]}"
