"""Which code computed a result, with which packages, and on which machine."""

from __future__ import annotations

import hashlib
import os
import platform
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

from mpmcol import __version__

# Packages whose code affects numbers. Case files do not count: every resolved case holds all values.
NUMERICAL = ("experiments", "io", "measure", "mpm", "setup", "simulation")
DEPENDENCIES = ("numba", "llvmlite", "numpy", "h5py")


@cache
def code_version() -> str:
    """The version with eight digits of a digest of the sources that affect numbers, for example "0.1.0+3f2a9c1b"."""
    digest, package = hashlib.sha256(), Path(__file__).parent
    for name in NUMERICAL:
        for path in sorted((package / name).rglob("*.py")):
            digest.update(path.relative_to(package).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return f"{__version__}+{digest.hexdigest()[:8]}"


def versions() -> dict[str, str]:
    """Versions of the program and of what it computes with."""
    packages = {name: metadata.version(name) for name in DEPENDENCIES}
    return {"mpmcol": code_version(), "python": platform.python_version(), **packages}


def environment() -> dict[str, Any]:
    """Versions, and the machine on which a report is made."""
    system = {"machine": platform.machine(), "cpu": cpu_name(), "cores": os.cpu_count(), "system": platform.system()}
    return {**versions(), **system}


def cpu_name() -> str:
    """Name of the processor, or its architecture where the system does not report the name."""
    try:
        lines = Path("/proc/cpuinfo").read_text("utf-8").splitlines()
        return next(line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()
