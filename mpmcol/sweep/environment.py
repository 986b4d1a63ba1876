"""The machine and the versions that costs belong to."""

from __future__ import annotations

import os
import platform
from pathlib import Path
from typing import Any

from mpmcol.recorder import versions


def environment() -> dict[str, Any]:
    """Versions of what computed, and the machine on which reports are made."""
    system = {"machine": platform.machine(), "cpu": _cpu(), "cores": os.cpu_count(), "system": platform.system()}
    return {**versions(), **system}


def _cpu() -> str:
    """The processor's name, where the system tells it."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor()
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), "")
