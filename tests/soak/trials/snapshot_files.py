"""Every snapshot opens in VTK's own reader and in pyvista, with arrays equal to those that were written."""

from __future__ import annotations

import random
from pathlib import Path

import numpy as np
import pyvista
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkIOHDF import vtkHDFReader

import mpmcol
from mpmcol.io.results import Results
from tests.support.runs import SHORT, SMALL_CASES

COUNT = 28
SMALL_COUNT = 2


def trial(seed: int, folder: Path) -> str | None:
    """Read every snapshot of a run as a file and as a step of the series, with each reader."""
    draw, (source, *values) = random.Random(seed), list(SMALL_CASES.values())[seed % len(SMALL_CASES)]
    times = f"output.times={sorted({round(draw.uniform(0.001, 0.1), 4) for _ in range(draw.randint(1, 4))})}"
    more = draw.choice(([], [times], ["output.compression=gzip"]))
    results = mpmcol.run(mpmcol.load_case(source, [*values, *SHORT, *more]), folder / "run", threads=1)
    for k, path in enumerate(results.snapshots):
        if found := difference(results, k, path):
            return f"{path.name} of {source}: {found}"
    return None


def difference(results: Results, k: int, path: Path) -> str | None:
    """The first array that a reader returns otherwise than `Results`."""
    snapshot = results.snapshot(k)
    series = pyvista.get_reader(results.folder / "run.vtkhdf.series")
    series.set_active_time_point(k)
    meshes = {
        "vtkHDFReader": read_by_vtk(path, None),
        "vtkHDFReader of the series": read_by_vtk(results.folder / "run.vtkhdf", snapshot.time),
        "pyvista": pyvista.read(path),
        "pyvista of the series": series.read(),
    }
    for reader, mesh in meshes.items():
        for name, expected in snapshot.arrays.items():
            is_new = not mesh.GetPointData().HasArray(name) and "series" in reader  # history variables begin later
            if name != "position" and is_new:
                continue
            array = mesh.GetPoints().GetData() if name == "position" else mesh.GetPointData().GetArray(name)
            if array is None or not np.array_equal(vtk_to_numpy(array), expected):
                return f"{name} in {reader}"
    return None


def read_by_vtk(path: Path, time: float | None) -> vtkPolyData:
    """The mesh in a file, or in a series at one of its times."""
    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.Update() if time is None else reader.UpdateTimeStep(time)
    return reader.GetOutput()
