"""Columns that can be simulated. A geometry is one file in this folder and one line in `GEOMETRIES`.

A geometry's module holds
  AXISYMMETRIC   whether the hoop direction takes part
  volumes        (areas in the plane, x) -> initial volumes, per metre or per radian
"""

from __future__ import annotations

from types import ModuleType

from mpmcol.geometries import axisymmetric, plane

GEOMETRIES: dict[str, ModuleType] = {"plane": plane, "axisymmetric": axisymmetric}
