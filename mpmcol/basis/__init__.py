"""The functions that carry data between points and nodes, one file per basis.

Each gives `WIDTH`, the nodes of an axis that a point reaches, and `padded`, first node, weights and gradients of the
eight lanes' coordinates at once, padded with zeros to four nodes.
"""

from __future__ import annotations

from types import ModuleType

from mpmcol.basis import quadratic

BASES: dict[str, ModuleType] = {"quadratic": quadratic}
