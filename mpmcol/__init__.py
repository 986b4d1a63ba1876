"""mpmcol: collapse of granular columns by the material point method.

import mpmcol
case = mpmcol.load_case("quickstart")
results = mpmcol.run(case, "runs/quickstart")
print(results.measure().zeta)
positions = results.snapshot(-1).x
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

__version__ = "0.1.0"

_HOME = {"load_case": "mpmcol.case", "run": "mpmcol.simulation.run", "Results": "mpmcol.io.results"}
__all__ = ["Results", "__version__", "load_case", "run"]


def __getattr__(name: str) -> Any:
    """Load the public names on first use, so that importing mpmcol costs nothing."""
    if name not in _HOME:
        raise AttributeError(f"module 'mpmcol' has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)
