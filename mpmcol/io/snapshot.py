"""Snapshots of the material points: one immutable VTKHDF file each, and an index of all of them.

ParaView opens a single snapshot, or the run as a time series by `run.vtkhdf` or `run.vtkhdf.series`.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from mpmcol.errors import OutputError
from mpmcol.io import vtkhdf
from mpmcol.io.atomic import atomic_write, make_folder
from mpmcol.io.checksums import has_checksum, listed_checksums
from mpmcol.io.names import INDEX_FILES, SNAPSHOT_FOLDER

SCHEMA = 1
UNITS = {
    "position": "m",
    "velocity": "m/s",
    "displacement": "m",
    "stress": "Pa",
    "pressure": "Pa",
    "shear_stress": "Pa",
    "volume_ratio": "1",
    "opening_strain": "1",
    "mass": "kg",
    "volume": "m3",
    "material": "1",
    "id": "1",
}
EXTENSIVE = {"mass", "volume"}
PER = {"plane": "/m", "axisymmetric": "/rad"}  # in 3D, all that is modelled
COMPONENTS = {"velocity": "x y z", "displacement": "x y z", "stress": "xx yy zz xy yz xz"}
DESCRIPTIONS = {  # field data for viewers, which do not show HDF5 attributes
    "stress_components": COMPONENTS["stress"].split(),
    "stress_sign": ["tension positive"],
    "material_ids": ["0 column", "1 base", "2 first layer of the column"],
}
BASE_MATERIAL = 1
ATTRIBUTES = {"velocity": "Vectors", "stress": "Tensors", "id": "GlobalIds"}
DAMAGE = (OSError, KeyError, ValueError, TypeError, AttributeError, IndexError, RuntimeError, MemoryError)

RESTORE = "restore it from a copy, or run the case again with --fresh"

Meta = Mapping[str, str | int | float]


@dataclass(frozen=True)
class Snapshot:
    """The state of all n material points at one time; stored snapshots are sorted by point id.

    time: s since the release, or since the start if the run ended during equilibration. arrays: "position" (n, 3) m,
    "velocity" (n, 3) m/s, "displacement" since the release (n, 3) m, "stress" (n, 6: xx yy zz xy yz xz) Pa, tension
    positive, "pressure" and "shear_stress" (n) of the mean stress of a cell, Pa, "volume_ratio" (n) J,
    "opening_strain" (n), "mass" (n) and "volume" (n) per metre in plane strain, per radian in axisymmetry, of the
    modelled part in 3D, "material" (n) 0 column, 1 base, 2 and more the layers of the column, "id" (n), and the history
    variables of the constitutive law by name.
    """

    time: float
    step: int
    stage: str
    arrays: dict[str, np.ndarray]

    @property
    def x(self) -> np.ndarray:
        """Positions, m: (n, 2) in two dimensions, (n, 3) in three."""
        position = self.arrays["position"]
        return position if position[:, 2].any() else position[:, :2]

    @property
    def column(self) -> np.ndarray:
        """Mask (n) of the points of the column; all others are points of the base."""
        return self.arrays["material"] != BASE_MATERIAL

    @property
    def displacement_magnitude(self) -> np.ndarray:
        """Magnitude of the displacement since the release (n), m."""
        return np.linalg.norm(self.arrays["displacement"], axis=1)


def as_stored(snapshot: Snapshot) -> Snapshot:
    """The snapshot as it is stored and read back: sorted by point id, real numbers as float32.

    Arrays of a snapshot that has this form already are not copied.
    """
    ids = snapshot.arrays["id"]
    order = slice(None) if (ids[:-1] <= ids[1:]).all() else np.argsort(ids, kind="stable")
    arrays = {name: _single_precision(values)[order] for name, values in snapshot.arrays.items()}
    return replace(snapshot, arrays=arrays)


def write_snapshot(folder: Path, index: int, snapshot: Snapshot, meta: Meta, compression: str = "none") -> Path:
    """Write `folder/snapshots/<index>.vtkhdf` atomically in the form of `as_stored`; return its path.

    meta: data of the run for readers: model, spacing, point_size, r_i, h_i, title, case text, versions, threads.
    compression: "none" or "gzip". Raises OutputError.
    """
    path = make_folder(folder / SNAPSHOT_FOLDER, parents=False) / f"{index:06d}.vtkhdf"
    data = dict(as_stored(snapshot).arrays)
    moment: Meta = {"time": snapshot.time, "step": snapshot.step, "stage": snapshot.stage}
    per = PER.get(str(meta.get("model")), "")
    attributes = {name: _attributes(name, per) for name in UNITS}
    with vtkhdf.memory_file() as file:
        points = data.pop("position")
        vtkhdf.write_points(file["VTKHDF"], points, data, {"Points": attributes["position"], **attributes}, compression)
        file["VTKHDF/FieldData/TimeValue"] = [snapshot.time]
        for name, texts in _descriptions(per).items():
            # the only kind of text that VTK reads; it crashes on strings of fixed length
            file.create_dataset(f"VTKHDF/FieldData/{name}", data=texts, dtype=h5py.string_dtype("ascii"))
        for name, value in {**meta, "schema": SCHEMA, "units": "SI", **moment}.items():
            _write_plain(file, f"mpmcol/{name}", value)
        content = vtkhdf.image(file)
    atomic_write(path, content)
    return path


def read_snapshot(path: Path) -> Snapshot:
    """Read a snapshot file; real numbers are float32. Raises OutputError if it is damaged or not a snapshot."""
    with _opened(path) as file:
        return _snapshot(file)


def read_meta(path: Path) -> dict[str, str | int | float]:
    """Data of the run in a snapshot file: the `meta` of `write_snapshot`, and time, step and stage."""
    with _opened(path) as file:
        return _meta(file)


def read_with_meta(path: Path) -> tuple[Snapshot, dict[str, str | int | float]]:
    """A snapshot as `read_snapshot` and data of the run as `read_meta`, from one reading of the file."""
    with _opened(path) as file:
        return _snapshot(file), _meta(file)


def _snapshot(file: h5py.File) -> Snapshot:
    arrays = {"position": file["VTKHDF/Points"][()]}
    arrays |= {name: dataset[()] for name, dataset in file["VTKHDF/PointData"].items()}
    if len({len(values) for values in arrays.values()}) != 1:
        raise ValueError("its arrays differ in length")
    moment = file["mpmcol"]
    return Snapshot(_plain(moment["time"]), _plain(moment["step"]), _plain(moment["stage"]), arrays)


def _meta(file: h5py.File) -> dict[str, str | int | float]:
    return {name: _plain(dataset) for name, dataset in file["mpmcol"].items()}


def list_snapshots(folder: Path) -> list[Path]:
    """The snapshot files of a results folder in the order of writing."""
    found = (path for path in (folder / SNAPSHOT_FOLDER).glob("*.vtkhdf") if path.stem.isdecimal())
    return sorted(found, key=lambda path: int(path.stem))


def write_index(folder: Path, steps: Sequence[vtkhdf.Step] | None = None) -> None:
    """Write `run.vtkhdf` and `run.vtkhdf.series`, the run as one time series of its snapshots.

    steps: `describe_snapshot` of each snapshot; by default the files are read. Raises OutputError, also if a snapshot
    is damaged or differs from the first in the number of points.
    """
    if steps is None:
        steps = [describe_snapshot(path) for path in list_snapshots(folder)]
    if not steps:
        raise OutputError(f"{folder / SNAPSHOT_FOLDER}: no snapshot to index; write one first")
    series = [{"name": step.name, "time": step.time} for step in steps]
    text = json.dumps({"file-series-version": "1.0", "files": series}, indent=1)
    with vtkhdf.memory_file() as file:
        vtkhdf.write_series(file["VTKHDF"], steps)
        content = vtkhdf.image(file)
    for name, data in zip(INDEX_FILES, (content, text.encode()), strict=True):
        atomic_write(folder / name, data)


def describe_snapshot(path: Path) -> vtkhdf.Step:
    """The entry of a snapshot file in the index. Raises OutputError."""
    with _opened(path) as file:
        return vtkhdf.describe(file["VTKHDF"], f"{SNAPSHOT_FOLDER}/{path.name}", _plain(file["mpmcol/time"]))


def step_of(path: Path, snapshot: Snapshot, meta: Meta) -> vtkhdf.Step:
    """What `describe_snapshot` finds in the file of `write_snapshot`, without reading it.

    snapshot: in the form of `as_stored`.
    """
    per = PER.get(str(meta.get("model")), "")
    datasets = {
        "Points" if name == "position" else f"PointData/{name}": (
            values.shape,
            values.dtype,
            dict(sorted(_attributes(name, per).items())) if name in UNITS else {},  # as read
        )
        for name, values in snapshot.arrays.items()
    }
    return vtkhdf.Step(f"{SNAPSHOT_FOLDER}/{path.name}", snapshot.time, datasets)


def _attributes(name: str, per: str) -> dict[str, str | np.bytes_]:
    units: dict[str, str | np.bytes_] = {"units": _unit(name, per)}
    components: dict[str, str | np.bytes_] = {"components": COMPONENTS[name]} if name in COMPONENTS else {}
    return units | components | ({"Attribute": np.bytes_(ATTRIBUTES[name])} if name in ATTRIBUTES else {})


def _descriptions(per: str) -> dict[str, list[str]]:
    """Names of components and materials, sign of stresses, and the unit of each array that has one."""
    return {**DESCRIPTIONS, "units": [f"{name} {_unit(name, per)}" for name in UNITS if UNITS[name] != "1"]}


def _unit(name: str, per: str) -> str:
    return UNITS[name] + (per if name in EXTENSIVE else "")


def _single_precision(values: np.ndarray) -> np.ndarray:
    return values.astype(np.float32, copy=False) if values.dtype.kind == "f" else values


def _write_plain(file: h5py.File, name: str, value: str | int | float) -> None:
    """Write a scalar; strings have a fixed length, since HDF5 may loop forever in a damaged heap of variable ones."""
    if isinstance(value, str):
        text = value.encode()
        file.create_dataset(name, data=text, dtype=h5py.string_dtype("utf-8", max(len(text), 1)))
    else:
        file[name] = value


def _plain(dataset: h5py.Dataset) -> Any:
    is_text = h5py.check_string_dtype(dataset.dtype) is not None
    return dataset.asstr()[()] if is_text else dataset[()].item()


@contextmanager
def _opened(path: Path) -> Iterator[h5py.File]:
    """The open snapshot file; any error while it is open becomes an OutputError with its path."""
    if not path.is_file():
        raise OutputError(f"{path}: no such snapshot; {RESTORE}")
    try:
        _verify_checksum(path)
        with h5py.File(path, "r", locking=False) as file:
            if "VTKHDF" not in file or "mpmcol" not in file:
                raise ValueError("it was not written by mpmcol (no group /VTKHDF or /mpmcol)")
            if _plain(file["mpmcol/schema"]) != SCHEMA:
                raise ValueError(f"its schema is not {SCHEMA}: another version of mpmcol wrote it")
            yield file
    except DAMAGE as error:
        raise OutputError(
            f"{path}: not a readable snapshot: {error}; the other snapshots are not affected; {RESTORE}"
        ) from error


def _verify_checksum(path: Path) -> None:
    """Raise ValueError if SHA256SUMS lists another checksum: HDF5 may crash or hang on damaged files."""
    folder = path.parent.parent
    checksum = listed_checksums(folder).get(path.relative_to(folder).as_posix())
    if checksum is not None and not has_checksum(path, checksum):
        raise ValueError("its checksum does not match")
