"""Columns that can be simulated. A geometry is one file in this folder and one line in `GEOMETRIES`.

A geometry's module holds
  DIMENSION      2, or 3 with the axis of the column at x = z = 0 and y upward
  AXISYMMETRIC   whether the hoop direction takes part
  gate           (horizontal coordinates, radius, depth) -> for each of them where the gate holds that component of
                 the velocity: at and beyond the column's surface; the column is where no gate stands
  volumes        (sizes, x) -> initial volumes of points (m3, per metre, per radian) from their areas or volumes
"""

from __future__ import annotations

from types import ModuleType

from mpmcol.setup.geometries import axisymmetric, box, cylinder, plane

GEOMETRIES: dict[str, ModuleType] = {"plane": plane, "axisymmetric": axisymmetric, "cylinder": cylinder, "box": box}
