"""mpmcol: collapse of granular columns by the material point method.

import mpmcol
case = mpmcol.load_case("quickstart")
results = mpmcol.run(case, "runs/quickstart")
print(results.measure().zeta)
positions = results.snapshot(-1).x
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import Any

__version__ = "0.1.0"

_HOME = {
    "Case": "mpmcol.case", "Results": "mpmcol.io.results", "fit": "mpmcol.api.fits",
    "load_case": "mpmcol.case", "measure": "mpmcol.api.measured",
    "plot": "mpmcol.api.pictures", "propagate": "mpmcol.api.uncertainty", "render": "mpmcol.api.pictures",
    "report": "mpmcol.api.reports", "run": "mpmcol.simulation.run",
    "shipped_cases": "mpmcol.case", "sweep": "mpmcol.api.sweeps",
}  # fmt: skip
_PACKAGES = {"errors", "measure", "report", "sweep"}
__all__ = [
    "Case", "Results", "__version__", "errors", "fit", "load_case", "measure", "plot", "propagate", "render",
    "report", "run", "shipped_cases", "sweep",
]  # fmt: skip


def __getattr__(name: str) -> Any:
    """Load the public names on first use, so that importing mpmcol costs nothing."""
    if name in _PACKAGES:
        return import_module(f"{__name__}.{name}")
    if name not in _HOME:
        raise AttributeError(f"module 'mpmcol' has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)


class _CallablePackage(ModuleType):
    # A package that is also the public function of its name, with its signature and documentation.

    @property
    def __doc__(self) -> str | None:  # type: ignore[override]
        return str(self._function.__doc__)

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        return self._function(*args, **kwargs)

    @property
    def _function(self) -> Any:
        name = self.__name__.rpartition(".")[2]
        return getattr(import_module(_HOME[name]), name)

    @property
    def __signature__(self) -> Any:
        from inspect import signature

        return signature(self._function)


class _Package(ModuleType):
    """This module, which makes packages callable as they are imported."""

    def __setattr__(self, name: str, value: Any) -> None:
        if name in _HOME and isinstance(value, ModuleType):
            value.__class__ = _CallablePackage
        super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
