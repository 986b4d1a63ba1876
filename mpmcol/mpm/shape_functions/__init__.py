"""The functions that carry data between points and nodes, one file per basis.

Each gives `WIDTH`, the nodes of an axis that a point reaches; `padded`, first node, weights and gradients of the
eight lanes' coordinates at once, padded with zeros to four nodes; `TRAVEL`, how many cells a point may travel until
points are sorted anew; and `STIFFNESS`, the largest sum of w'^2 / w along an axis, times h^2, away from walls.
"""

from __future__ import annotations

from types import ModuleType

from mpmcol.mpm.shape_functions import cubic, linear, quadratic

BASES: dict[str, ModuleType] = {"linear": linear, "quadratic": quadratic, "cubic": cubic}
