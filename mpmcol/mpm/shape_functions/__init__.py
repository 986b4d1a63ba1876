"""Shape functions. A new kind is one module here that satisfies `ShapeFunctions`, and one line below."""

from __future__ import annotations

from typing import Any, Protocol

from mpmcol.mpm.shape_functions import cubic, linear, quadratic


class ShapeFunctions(Protocol):
    """What the module of one-dimensional shape functions defines."""

    __name__: str

    @property
    def WIDTH(self) -> int:
        """Nodes with nonzero weight along an axis, at most four."""

    @property
    def TRAVEL_LIMIT(self) -> float:
        """How far a point may travel before points must be sorted again, in cells (see `kernels.sort`)."""

    @property
    def STIFFNESS(self) -> float:
        """Largest sum of w'^2 / w over the nodes of an axis, times h^2, away from walls."""

    def evaluate(self, s: Any, bottom: Any, top: Any, correction: bool) -> tuple[Any, ...]:
        """First node (as a real number), four weights and four gradients (times h) at grid coordinates `s`.

        s: vector of (x - origin) / h, an axis per lane. bottom, top: coordinates half a cell inside the first and the
        last node, minus and plus infinity in lanes without a coordinate. correction: kernel correction beside walls.
        Weights and gradients beyond WIDTH are zero.
        """


SHAPE_FUNCTIONS: dict[str, ShapeFunctions] = {"linear": linear, "quadratic": quadratic, "cubic": cubic}
