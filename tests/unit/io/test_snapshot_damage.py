"""Damaged snapshot files and full disks are reported as OutputError."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import h5py
import numpy as np
import pytest

from mpmcol.errors import OutputError
from mpmcol.io.checksums import checksum_of, write_checksums
from mpmcol.io.snapshot import Meta, Snapshot, read_meta, read_snapshot, write_index, write_snapshot

N = 20
META: Meta = {"model": "plane", "case": "[grid]\n"}
SNAPSHOT = Snapshot(
    0.1,
    7,
    "collapse",
    {
        "position": np.linspace(0, 1, 3 * N).reshape(N, 3),
        "mass": np.ones(N),
        "id": np.arange(N, dtype=np.int32),
    },
)


def test_a_full_disk_leaves_existing_files_unchanged(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    path = write_snapshot(tmp_path, 0, SNAPSHOT, META)
    write_index(tmp_path)
    before = {name: (tmp_path / name).read_bytes() for name in ("run.vtkhdf", "run.vtkhdf.series")}

    def full(*args):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "write", full)
    for attempt in (lambda: write_snapshot(tmp_path, 1, SNAPSHOT, META), lambda: write_index(tmp_path)):
        with pytest.raises(OutputError, match="No space left on device"):
            attempt()
    assert os.listdir(tmp_path / "snapshots") == ["000000.vtkhdf"]
    assert np.array_equal(read_snapshot(path).arrays["mass"], np.ones(N))
    assert before == {name: (tmp_path / name).read_bytes() for name in before}
    assert sorted(os.listdir(tmp_path)) == ["run.vtkhdf", "run.vtkhdf.series", "snapshots"]


def test_truncated_file(tmp_path: Path):
    path = write_snapshot(tmp_path, 0, SNAPSHOT, META)
    content = path.read_bytes()
    for size in (0, 7, 100, 2000, len(content) // 2, len(content) - 1):
        path.write_bytes(content[:size])
        with pytest.raises(
            OutputError, match=r"000000.vtkhdf: not a readable snapshot: .*run the case again with --fresh"
        ):
            read_snapshot(path)


def test_random_damage_raises_no_other_error(tmp_path: Path):
    path = write_snapshot(tmp_path, 0, SNAPSHOT, META)
    content, rng = path.read_bytes(), np.random.default_rng(3)
    refused = 0
    for _ in range(200):
        damaged = np.frombuffer(content, np.uint8).copy()
        damaged[rng.integers(len(damaged), size=20)] = rng.integers(256, size=20)
        path.write_bytes(damaged.tobytes())
        try:
            read_snapshot(path)
        except OutputError:
            refused += 1
    assert refused > 50


def test_files_of_other_programs_and_other_schemas_are_refused(tmp_path: Path):
    path = tmp_path / "a.vtkhdf"
    with pytest.raises(OutputError, match="a.vtkhdf: no such snapshot"):
        read_snapshot(path)
    with h5py.File(path, "w") as file:
        file["data"] = 1
    with pytest.raises(OutputError, match="not written by mpmcol"):
        read_snapshot(path)
    path = write_snapshot(tmp_path, 0, SNAPSHOT, META)
    with h5py.File(path, "r+") as file:
        file["mpmcol/schema"][()] = 99
    with pytest.raises(OutputError, match="another version of mpmcol"):
        read_snapshot(path)


def test_arrays_of_unequal_length_are_refused(tmp_path: Path):
    path = write_snapshot(tmp_path, 0, SNAPSHOT, META)
    with h5py.File(path, "r+") as file:
        del file["VTKHDF/PointData/mass"]
        file["VTKHDF/PointData/mass"] = np.ones(N - 1)
    with pytest.raises(OutputError, match="differ in length"):
        read_snapshot(path)


def test_a_changed_byte_is_reported_before_hdf5_opens_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    path = write_snapshot(tmp_path, 0, SNAPSHOT, META)
    write_checksums(tmp_path, {"snapshots/000000.vtkhdf": checksum_of(path)})
    assert np.array_equal(read_snapshot(path).arrays["mass"], np.ones(N))
    content = bytearray(path.read_bytes())
    content[-1] ^= 1
    path.write_bytes(content)
    monkeypatch.setattr(h5py, "File", None)
    with pytest.raises(OutputError, match="its checksum does not match"):
        read_snapshot(path)


def test_strings_have_a_fixed_length(tmp_path: Path):
    path = write_snapshot(tmp_path, 0, SNAPSHOT, {**META, "title": "", "case": "Böschung, 33°\n"})
    assert read_meta(path).items() >= {"title": "", "case": "Böschung, 33°\n", "stage": "collapse"}.items()
    with h5py.File(path) as file:
        found = [name for name, data in file["mpmcol"].items() if h5py.check_string_dtype(data.dtype)]
        assert {"case", "title", "stage", "units"} <= set(found)
        assert all(h5py.check_string_dtype(file["mpmcol"][name].dtype).length for name in found)
