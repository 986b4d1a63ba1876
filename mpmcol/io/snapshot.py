"""Snapshots of the material points: one immutable VTKHDF file each, and an index over all of them.

ParaView opens one snapshot, or the run as a time series through `run.vtkhdf` or `run.vtkhdf.series`.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from mpmcol.errors import OutputError
from mpmcol.io import vtkhdf
from mpmcol.io.atomic import INDEX_FILES, atomic_write, make_folder
from mpmcol.io.checksums import has_digest, read_digests

SCHEMA = 1
UNITS = {
    "position": "m",
    "velocity": "m/s",
    "displacement": "m",
    "stress": "Pa",
    "volume_ratio": "1",
    "opening_strain": "1",
    "mass": "kg",
    "volume": "m3",
    "material": "1",
    "id": "1",
}
EXTENSIVE = {"mass", "volume"}
PER = {"plane": "/m", "axisymmetric": "/rad"}  # in 3D, all that is modelled
ATTRIBUTES = {"velocity": "Vectors", "stress": "Tensors", "id": "GlobalIds"}
DAMAGE = (OSError, KeyError, ValueError, TypeError, AttributeError, IndexError, RuntimeError, MemoryError)

Meta = Mapping[str, str | int | float]


@dataclass(frozen=True)
class Snapshot:
    """The state of all n material points at one moment; in order of point id once it was read from a file.

    time: s since the release, or since the start if the run ended while equilibrating. arrays: "position" (n, 3) m,
    "velocity" (n, 3) m/s, "displacement" since the release (n, 3) m,
    "stress" (n, 6: xx yy zz xy yz xz) Pa, tension positive,
    "volume_ratio" (n) J, "opening_strain" (n), "mass" (n) and "volume" (n) per metre or per radian, in 3D
    of all that is modelled, "material" (n) 0 column and 1 base, "id" (n), and the law's history variables by name.
    """

    time: float
    step: int
    stage: str
    arrays: dict[str, np.ndarray]

    @property
    def x(self) -> np.ndarray:
        """Positions, m: (n, 2) in the plane of a model of two dimensions, (n, 3) in three."""
        position = self.arrays["position"]
        return position if position[:, 2].any() else position[:, :2]

    @property
    def column(self) -> np.ndarray:
        """Mask (n) of the points of the column; the others are those of the base."""
        return self.arrays["material"] == 0

    @property
    def displacement_magnitude(self) -> np.ndarray:
        """Length of the displacement since the release (n), m."""
        return np.linalg.norm(self.arrays["displacement"], axis=1)


def write_snapshot(folder: Path, index: int, snapshot: Snapshot, meta: Meta, compression: str = "none") -> Path:
    """Write `folder/snapshots/<index>.vtkhdf` atomically, sorted by point id, reals as float32; return its path.

    meta: what a reader needs to know about the run: model, spacing, point_size, r_i, h_i, title, case text,
    versions, threads. compression: "none" or "gzip". Raises OutputError.
    """
    path = make_folder(folder / "snapshots", parents=False) / f"{index:06d}.vtkhdf"
    order = np.argsort(snapshot.arrays["id"], kind="stable")
    data = {name: _compact(values)[order] for name, values in snapshot.arrays.items()}
    moment: Meta = {"time": snapshot.time, "step": snapshot.step, "stage": snapshot.stage}
    marks = {name: _marks(name, PER.get(str(meta.get("model")), "")) for name in UNITS}
    with vtkhdf.memory_file() as file:
        points = data.pop("position")
        vtkhdf.write_points(file["VTKHDF"], points, data, {"Points": marks["position"], **marks}, compression)
        file["VTKHDF/FieldData/TimeValue"] = [snapshot.time]
        for name, value in {**meta, "schema": SCHEMA, "units": "SI", **moment}.items():
            _write_plain(file, f"mpmcol/{name}", value)
        content = vtkhdf.image(file)
    atomic_write(path, content)
    return path


def read_snapshot(path: Path) -> Snapshot:
    """Read back what `write_snapshot` wrote (reals as float32). Raises OutputError for any other file."""
    with _opened(path) as file:
        arrays = {"position": file["VTKHDF/Points"][()]}
        arrays |= {name: dataset[()] for name, dataset in file["VTKHDF/PointData"].items()}
        if len({len(values) for values in arrays.values()}) != 1:
            raise ValueError("its arrays differ in length")
        moment = file["mpmcol"]
        return Snapshot(_plain(moment["time"]), _plain(moment["step"]), _plain(moment["stage"]), arrays)


def read_meta(path: Path) -> dict[str, str | int | float]:
    """What a snapshot file says about its run: the `meta` of `write_snapshot`, and time, step and stage."""
    with _opened(path) as file:
        return {name: _plain(dataset) for name, dataset in file["mpmcol"].items()}


def list_snapshots(folder: Path) -> list[Path]:
    """The snapshot files of a results folder, in the order in which they were taken."""
    found = (path for path in (folder / "snapshots").glob("*.vtkhdf") if path.stem.isdecimal())
    return sorted(found, key=lambda path: int(path.stem))


def write_index(folder: Path, steps: Sequence[vtkhdf.Step] | None = None) -> None:
    """Rewrite `run.vtkhdf` and `run.vtkhdf.series`, the run as one time series, from the snapshots present.

    steps: what `describe_snapshot` says of each of them, where that is known already. Raises OutputError, also where
    a snapshot is damaged or has another number of points than the first.
    """
    if steps is None:
        steps = [describe_snapshot(path) for path in list_snapshots(folder)]
    if not steps:
        raise OutputError(f"{folder / 'snapshots'}: no snapshot to index; write one first")
    series = [{"name": step.name, "time": step.time} for step in steps]
    text = json.dumps({"file-series-version": "1.0", "files": series}, indent=1)
    with vtkhdf.memory_file() as file:
        vtkhdf.write_series(file["VTKHDF"], steps)
        content = vtkhdf.image(file)
    for name, data in zip(INDEX_FILES, (content, text.encode()), strict=True):
        atomic_write(folder / name, data)


def describe_snapshot(path: Path) -> vtkhdf.Step:
    """What the index needs to know of a snapshot file. Raises OutputError."""
    with _opened(path) as file:
        return vtkhdf.describe(file["VTKHDF"], f"snapshots/{path.name}", _plain(file["mpmcol/time"]))


def _marks(name: str, per: str) -> dict[str, str | np.bytes_]:
    units: dict[str, str | np.bytes_] = {"units": UNITS[name] + (per if name in EXTENSIVE else "")}
    return units | ({"Attribute": np.bytes_(ATTRIBUTES[name])} if name in ATTRIBUTES else {})


def _compact(values: np.ndarray) -> np.ndarray:
    return values.astype(np.float32) if values.dtype.kind == "f" else values


def _write_plain(file: h5py.File, name: str, value: str | int | float) -> None:
    """Text gets a fixed length: HDF5 may read a damaged heap, where texts of any length lie, for ever."""
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
    """The open snapshot file; whatever goes wrong inside becomes an OutputError that names the file."""
    if not path.is_file():
        raise OutputError(f"{path}: no such snapshot; they are in the folder `snapshots` of a results folder")
    try:
        _require_own_bytes(path)
        with h5py.File(path, "r", locking=False) as file:
            if "VTKHDF" not in file or "mpmcol" not in file:
                raise ValueError("it was not written by mpmcol (no group /VTKHDF or /mpmcol)")
            if _plain(file["mpmcol/schema"]) != SCHEMA:
                raise ValueError(f"its schema is not {SCHEMA}: another version of mpmcol wrote it")
            yield file
    except DAMAGE as error:
        raise OutputError(
            f"{path}: not a readable snapshot: {error}; the other snapshots stand alone, and the case run again with "
            "--fresh makes it anew"
        ) from error


def _require_own_bytes(path: Path) -> None:
    """Raise ValueError if the run's list of digests knows other bytes: what HDF5 makes of damage is not foreseeable."""
    folder = path.parent.parent
    try:
        digest = read_digests(folder).get(path.relative_to(folder).as_posix())
    except (OSError, ValueError):
        return  # the run has not ended, or the list is damaged too
    if digest is not None and not has_digest(path, digest):
        raise ValueError("its bytes are not those that the run wrote")
