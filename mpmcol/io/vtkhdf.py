"""VTKHDF PolyData files of points (Kitware, "VTKHDF file format" 2.6): static meshes and time series of them.

Readable by VTK >= 9.3, ParaView and pyvista. Files are built in memory, because HDF5 can leave a damaged file when the
disk is full or the process is killed; the caller writes the file image atomically.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import count
from typing import Any

import h5py
import numpy as np

from mpmcol.errors import OutputError

VERSION = (2, 6)
# HDF5 1.14 inside VTK cannot read the newest file layout of HDF5 2.0 and shows an empty mesh.
LIBVER = ("earliest", "v110")
# The only filters that every VTK reads without plug-ins.
COMPRESSION: dict[str, dict[str, Any]] = {"none": {}, "gzip": {"compression": 1, "shuffle": True}}
_numbers = count()
CELL_KINDS = ("Vertices", "Lines", "Polygons", "Strips")


@dataclass(frozen=True)
class Step:
    """One static file of a series: its path relative to the index, its time, and its datasets.

    datasets: shape, type and attributes of "Points" and each "PointData/<name>".
    """

    name: str
    time: float
    datasets: dict[str, tuple[tuple[int, ...], np.dtype, dict[str, Any]]]


def create_in_memory(**options: Any) -> h5py.File:
    """An HDF5 file in memory.

    Its name is not part of its content, but unique: HDF5 opens no two files of one name at a time.
    """
    return h5py.File(f"memory-{next(_numbers)}", "w", driver="core", backing_store=False, **options)


@contextmanager
def memory_file() -> Iterator[h5py.File]:
    """A file in memory with the attributes of a VTKHDF PolyData file."""
    with create_in_memory(libver=LIBVER) as file:
        group = file.create_group("VTKHDF")
        group.attrs["Version"] = VERSION
        group.attrs["Type"] = np.bytes_("PolyData")
        yield file


def image(file: h5py.File) -> bytes:
    """The bytes of the file."""
    file.flush()
    return file.id.get_file_image()


def write_points(
    group: h5py.Group,
    points: np.ndarray,
    data: Mapping[str, np.ndarray],
    attributes: Mapping[str, Mapping[str, Any]],
    compression: str,
) -> None:
    """Write a static mesh: points (n, 3), their arrays (n, ...), and one poly-vertex cell of all points.

    Viewers draw cells only. attributes: HDF5 attributes by array name or "Points".
    """
    filters = COMPRESSION[compression]
    group["NumberOfPoints"] = [len(points)]
    for kind in CELL_KINDS:
        _write_cells(group.create_group(kind), len(points) if kind == "Vertices" else 0, filters)
    for name, values in {"Points": points, **{f"PointData/{name}": data[name] for name in data}}.items():
        dataset = group.create_dataset(name, data=values, chunks=values.shape if filters else None, **filters)
        dataset.attrs.update(attributes.get(name.removeprefix("PointData/"), {}))


def _write_cells(group: h5py.Group, n: int, filters: dict[str, Any]) -> None:
    cells = min(n, 1)
    group["NumberOfCells"] = [cells]
    group["NumberOfConnectivityIds"] = [n]
    group["Offsets"] = np.arange(cells + 1) * n
    group.create_dataset("Connectivity", data=np.arange(n, dtype=np.int32), **(filters if n else {}))


def describe(group: h5py.Group, name: str, time: float) -> Step:
    """The step of a series for the static mesh in `group`; `name` is the path of its file relative to the index."""
    names = ["Points", *(f"PointData/{name}" for name in group["PointData"])]
    datasets = {name: (group[name].shape, group[name].dtype, dict(group[name].attrs)) for name in names}
    return Step(name, time, datasets)


def write_series(group: h5py.Group, steps: Sequence[Step]) -> None:
    """Write a time series of virtual datasets and external links to the files of its steps.

    Raises OutputError if the steps differ in the number of points.
    """
    n = steps[0].datasets["Points"][0][0]
    group["NumberOfPoints"] = [n]
    for kind in CELL_KINDS:
        group[kind] = h5py.ExternalLink(steps[0].name, f"/VTKHDF/{kind}")
    # History variables may exist from the collapse on only; the series has the arrays that all steps share.
    common = sorted(set.intersection(*(set(step.datasets) for step in steps)))
    for name in common:
        _write_virtual(group, name, steps)
    _write_times(group.create_group("Steps"), [step.time for step in steps], n, common)


def _write_virtual(group: h5py.Group, name: str, steps: Sequence[Step]) -> None:
    """Concatenate a dataset of all steps, by the low-level interface: `h5py.VirtualLayout` takes twice the time."""
    shape, dtype, attributes = steps[0].datasets[name]
    properties = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    properties.set_obj_track_times(False)  # equal content gives equal bytes
    source = h5py.h5s.create_simple(shape)
    whole = h5py.h5s.create_simple((len(steps) * shape[0], *shape[1:]))
    for i, step in enumerate(steps):
        found = step.datasets[name][0]
        if found != shape:
            raise OutputError(
                f"{step.name}: {name} has shape {found}, but in {steps[0].name} it has {shape}: "
                "the folder holds snapshots of different runs; keep those of one run only"
            )
        whole.select_hyperslab((i * shape[0], *(0 for _ in shape[1:])), shape)
        properties.set_virtual(whole, step.name.encode(), f"/VTKHDF/{name}".encode(), source)
    whole.select_all()
    parent, _, own_name = name.rpartition("/")
    parent_id = group.require_group(parent).id if parent else group.id
    dataset = h5py.h5d.create(parent_id, own_name.encode(), h5py.h5t.py_create(dtype, logical=True), whole, properties)
    h5py.Dataset(dataset).attrs.update(attributes)


def _write_times(group: h5py.Group, times: list[float], n: int, datasets: list[str]) -> None:
    """The group `Steps`: an offset of n points per step; all steps use the cells of the first."""
    count = len(times)
    offsets = n * np.arange(count)
    group.attrs["NSteps"] = count
    group["Values"] = times
    group["PartOffsets"] = np.zeros(count, np.int64)
    group["NumberOfParts"] = np.ones(count, np.int64)
    group["PointOffsets"] = offsets
    group["CellOffsets"] = np.zeros((count, len(CELL_KINDS)), np.int64)
    group["ConnectivityIdOffsets"] = np.zeros((count, len(CELL_KINDS)), np.int64)
    for name in datasets:
        if name.startswith("PointData/"):
            group[name.replace("PointData", "PointDataOffsets")] = offsets
