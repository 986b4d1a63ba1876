"""What a process takes."""

from __future__ import annotations

import resource
import sys

UNIT = 1 if sys.platform == "darwin" else 1024  # bytes


def peak_memory() -> int:
    """The most memory that this process has had so far, bytes; interpreter, compiler and kernels are in it."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * UNIT
