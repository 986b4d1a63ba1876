"""Every snapshot opens in VTK's own reader and in pyvista, with arrays equal to those that were written."""

from __future__ import annotations

import random
from pathlib import Path

import numpy as np
import pyvista
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOHDF import vtkHDFReader

import mpmcol
from mpmcol.results import Results
from tests.soak._runs import CASES, SHORT

COUNT = 28
DRAW = 2


def trial(seed: int, folder: Path) -> str | None:
    """Read every snapshot of a run, alone and as a step of the series, in three ways."""
    draw, (source, *values) = random.Random(seed), list(CASES.values())[seed % len(CASES)]
    times = f"output.times={sorted(round(draw.uniform(0.001, 0.1), 4) for _ in range(draw.randint(1, 4)))}"
    more = draw.choice(([], [times], ["output.compression=gzip"]))
    results = mpmcol.run(mpmcol.load_case(source, [*values, *SHORT, *more]), folder / "run", threads=1)
    for k, path in enumerate(results.snapshots):
        if wrong := differences(results, k, path):
            return f"{path.name} of {source}: {wrong}"
    return None


def differences(results: Results, k: int, path: Path) -> str | None:
    """What one of the readers shows otherwise than ours."""
    ours = results.snapshot(k).arrays
    alone, series = pyvista.read(path), pyvista.get_reader(results.folder / "run.vtkhdf")
    series.set_active_time_point(k)
    step = series.read()
    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.Update()
    raw = reader.GetOutput()
    for name, want in ours.items():
        shown = {"pyvista": values(alone, name), "the series": values(step, name, optional=True)}
        array = raw.GetPoints().GetData() if name == "position" else raw.GetPointData().GetArray(name)
        shown["vtkHDFReader"] = vtk_to_numpy(array)
        for reader_name, got in shown.items():
            if got is not None and not (got.dtype == want.dtype and np.array_equal(got, want)):
                return f"{name} in {reader_name}"
    return None


def values(mesh: pyvista.PolyData, name: str, optional: bool = False) -> np.ndarray | None:
    """An array of a mesh; None if it may be missing and is: a law's history may begin with the collapse."""
    if name == "position":
        return np.asarray(mesh.points)
    return None if optional and name not in mesh.point_data else np.asarray(mesh.point_data[name])
