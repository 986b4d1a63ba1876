"""Snapshots and their index: read back by this package, by VTK and by pyvista with equal arrays."""

from __future__ import annotations

import json
from pathlib import Path

import h5py
import numpy as np
import pytest

from mpmcol.errors import OutputError
from mpmcol.io.snapshot import (
    Meta,
    Snapshot,
    as_stored,
    describe_snapshot,
    list_snapshots,
    read_meta,
    read_snapshot,
    step_of,
    write_index,
    write_snapshot,
)

N = 300
META: Meta = {
    "model": "plane",
    "spacing": 0.004,
    "point_size": 0.002,
    "threads": 2,
    "case": 'title = "a"\n[grid]\n',
}
# 0.1 + 0.2 differs from 0.3: a reader that rounds times would find the wrong step.
TIMES = (-0.25, 0.0, 0.1, 0.1 + 0.2, 1.5)


def make(step: int, n: int = N, **history: np.ndarray) -> Snapshot:
    rng = np.random.default_rng(step)
    arrays: dict[str, np.ndarray] = {
        "position": rng.random((n, 3)),
        "velocity": rng.standard_normal((n, 3)),
        "displacement": rng.standard_normal((n, 3)),
        "stress": 1e4 * rng.standard_normal((n, 6)),
        "volume_ratio": rng.random(n),
        "opening_strain": rng.random(n),
        "mass": rng.random(n),
        "volume": rng.random(n),
        "material": (np.arange(n) >= n // 2).astype(np.uint8),
        "id": np.arange(n, dtype=np.int32),
    }
    return Snapshot(TIMES[step], 100 * step, "collapse" if step else "equilibrate", arrays | history)


def single(values: np.ndarray) -> np.ndarray:
    return values.astype(np.float32) if values.dtype.kind == "f" else values


@pytest.fixture(params=["none", "gzip"])
def run(request: pytest.FixtureRequest, tmp_path: Path) -> tuple[Path, list[Snapshot]]:
    snapshots = [make(step) for step in range(len(TIMES))]
    for step, snapshot in enumerate(snapshots):
        write_snapshot(tmp_path, step, snapshot, META, request.param)
        write_index(tmp_path)
    return tmp_path, snapshots


@pytest.fixture(scope="module")
def pyvista():
    return pytest.importorskip("pyvista")


def assert_same_mesh(mesh, snapshot: Snapshot) -> None:
    assert mesh.n_cells == 1
    assert np.array_equal(mesh.points, single(snapshot.arrays["position"]))
    assert set(mesh.point_data) == set(snapshot.arrays) - {"position"}
    for name in mesh.point_data:
        assert np.array_equal(mesh.point_data[name], single(snapshot.arrays[name])), name
    assert mesh.GetPointData().GetTensors().GetName() == "stress"
    assert mesh.GetPointData().GetVectors().GetName() == "velocity"
    assert mesh.GetPointData().GetGlobalIds().GetName() == "id"


def test_read_back(run):
    folder, snapshots = run
    paths = list_snapshots(folder)
    assert [path.name for path in paths] == [f"{step:06d}.vtkhdf" for step in range(len(TIMES))]
    for path, snapshot in zip(paths, snapshots, strict=True):
        found = read_snapshot(path)
        assert (found.time, found.step, found.stage) == (snapshot.time, snapshot.step, snapshot.stage)
        assert found.arrays.keys() == snapshot.arrays.keys()
        for name, values in found.arrays.items():
            assert values.dtype == single(snapshot.arrays[name]).dtype
            assert np.array_equal(values, single(snapshot.arrays[name])), name


def test_meta_survives_with_its_types(run):
    meta = read_meta(list_snapshots(run[0])[3])
    moment = {"time": TIMES[3], "step": 300, "stage": "collapse"}
    assert meta == {**META, **moment, "schema": 1, "units": "SI"}
    assert isinstance(meta["threads"], int) and isinstance(meta["spacing"], float)


def test_single_file_in_pyvista(run, pyvista, monkeypatch: pytest.MonkeyPatch):
    folder, snapshots = run
    monkeypatch.chdir("/")
    for path, snapshot in zip(list_snapshots(folder), snapshots, strict=True):
        mesh = pyvista.read(path)
        assert_same_mesh(mesh, snapshot)
        assert mesh.field_data["TimeValue"] == [snapshot.time]
        assert list(mesh.field_data["stress_components"]) == ["xx", "yy", "zz", "xy", "yz", "xz"]
        assert list(mesh.field_data["stress_sign"]) == ["tension positive"]
        assert list(mesh.field_data["material_ids"]) == ["0 column", "1 base", "2 first layer of the column"]
        assert {"position m", "stress Pa", "mass kg/m"} <= set(mesh.field_data["units"])


@pytest.mark.parametrize("relative", [False, True])
def test_every_step_through_the_index(run, pyvista, monkeypatch: pytest.MonkeyPatch, relative: bool):
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
    from vtkmodules.vtkIOHDF import vtkHDFReader

    folder, snapshots = run
    monkeypatch.chdir(folder.parent if relative else "/")
    reader = vtkHDFReader()
    reader.SetFileName(f"{folder.name}/run.vtkhdf" if relative else str(folder / "run.vtkhdf"))
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    assert times == TIMES
    # Forward and backward, as with the time slider of a viewer.
    for step in (*range(len(times)), *reversed(range(len(times)))):
        reader.UpdateTimeStep(times[step])
        assert_same_mesh(pyvista.wrap(reader.GetOutput()), snapshots[step])


def test_every_step_through_the_series(run, pyvista, monkeypatch: pytest.MonkeyPatch):
    folder, snapshots = run
    monkeypatch.chdir("/")
    reader = pyvista.get_reader(str(folder / "run.vtkhdf.series"))
    assert tuple(reader.time_values) == TIMES
    for step, snapshot in enumerate(snapshots):
        reader.set_active_time_point(step)
        mesh = reader.read()
        points = mesh[0] if isinstance(mesh, pyvista.MultiBlock) else mesh
        assert_same_mesh(points, snapshot)
        assert list(points.field_data["material_ids"]) == ["0 column", "1 base", "2 first layer of the column"]


def test_a_moved_run_still_opens(run, pyvista, tmp_path_factory: pytest.TempPathFactory):
    folder, snapshots = run
    moved = folder.rename(tmp_path_factory.mktemp("elsewhere") / "run")
    reader = pyvista.get_reader(str(moved / "run.vtkhdf")).reader
    reader.UpdateTimeStep(TIMES[4])
    assert_same_mesh(pyvista.wrap(reader.GetOutput()), snapshots[4])
    folder.mkdir()


def test_points_are_sorted_by_id(tmp_path: Path):
    snapshot = make(1)
    shuffled = np.random.default_rng(7).permutation(N)
    arrays = {name: values[shuffled] for name, values in snapshot.arrays.items()}
    path = write_snapshot(tmp_path, 0, Snapshot(0.0, 0, "collapse", arrays), META)
    for name, values in read_snapshot(path).arrays.items():
        assert np.array_equal(values, single(snapshot.arrays[name])), name


def test_a_snapshot_in_memory_equals_the_one_read_back(tmp_path: Path):
    snapshot = make(1)
    shuffled = np.random.default_rng(7).permutation(N)
    arrays = {name: values[shuffled] for name, values in snapshot.arrays.items()}
    snapshot = Snapshot(0.1, 3, "collapse", arrays)
    found, stored = read_snapshot(write_snapshot(tmp_path, 0, snapshot, META)), as_stored(snapshot)
    assert (found.time, found.step, found.stage) == (stored.time, stored.step, stored.stage)
    assert found.arrays.keys() == stored.arrays.keys()
    for name, values in found.arrays.items():
        assert values.dtype == stored.arrays[name].dtype and np.array_equal(values, stored.arrays[name]), name


def test_files_are_ordered_by_number_and_other_files_are_ignored(tmp_path: Path):
    for index in (1000000, 2, 999999):
        write_snapshot(tmp_path, index, make(0), META)
    (tmp_path / "snapshots" / "notes.vtkhdf").touch()
    (tmp_path / "snapshots" / ".000001.vtkhdf.1.tmp").touch()
    assert [int(path.stem) for path in list_snapshots(tmp_path)] == [2, 999999, 1000000]
    assert list_snapshots(tmp_path / "nowhere") == []


def test_units_follow_the_model(tmp_path: Path):
    for model, per in {"plane": "/m", "axisymmetric": "/rad", "quarter": "", "full": ""}.items():
        path = write_snapshot(tmp_path, 0, make(0), {**META, "model": model})
        with h5py.File(path) as file:
            units = {name: values.attrs["units"] for name, values in file["VTKHDF/PointData"].items()}
            assert file["VTKHDF/Points"].attrs["units"] == "m"
        assert units["stress"] == "Pa" and units["velocity"] == "m/s"
        assert units["mass"] == "kg" + per and units["volume"] == "m3" + per


def test_gzip_is_smaller_and_none_is_the_default(tmp_path: Path):
    snapshot = make(0, n=5000)
    sizes = {kind: write_snapshot(tmp_path, 0, snapshot, META, kind).stat().st_size for kind in ("none", "gzip")}
    plain = sum(single(values).nbytes for values in snapshot.arrays.values())
    assert sizes["gzip"] < sizes["none"] and sizes["none"] > plain
    assert write_snapshot(tmp_path, 0, snapshot, META).stat().st_size == sizes["none"]


def test_history_variables_that_not_all_snapshots_have_are_left_out_of_the_index(tmp_path: Path, pyvista):
    write_snapshot(tmp_path, 0, make(0), META)
    later = write_snapshot(tmp_path, 1, make(1, plastic_strain=np.ones(N)), META)
    write_index(tmp_path)
    reader = pyvista.get_reader(str(tmp_path / "run.vtkhdf")).reader
    reader.UpdateTimeStep(TIMES[1])
    assert_same_mesh(pyvista.wrap(reader.GetOutput()), make(1))
    assert np.array_equal(read_snapshot(later).arrays["plastic_strain"], np.ones(N))


def test_index_lists_the_files_present(tmp_path: Path):
    for step in (0, 1, 2):
        write_snapshot(tmp_path, step, make(step), META)
    write_index(tmp_path)
    list_snapshots(tmp_path)[1].unlink()
    write_index(tmp_path)
    series = json.loads((tmp_path / "run.vtkhdf.series").read_text())
    assert series["file-series-version"] == "1.0"
    assert [(entry["name"], entry["time"]) for entry in series["files"]] == [
        ("snapshots/000000.vtkhdf", TIMES[0]),
        ("snapshots/000002.vtkhdf", TIMES[2]),
    ]
    with h5py.File(tmp_path / "run.vtkhdf") as file:
        assert file["VTKHDF/Steps"].attrs["NSteps"] == 2
        assert np.array_equal(file["VTKHDF/Points"][N:], single(make(2).arrays["position"]))


@pytest.mark.parametrize("model", ["plane", "axisymmetric", "quarter"])
def test_the_index_of_a_run_does_not_need_its_files(tmp_path: Path, model: str) -> None:
    meta, snapshots = {**META, "model": model}, [as_stored(make(step, plastic_strain=np.ones(N))) for step in (0, 1)]
    paths = [write_snapshot(tmp_path, step, snapshot, meta) for step, snapshot in enumerate(snapshots)]
    write_index(tmp_path)
    index = (tmp_path / "run.vtkhdf").read_bytes()
    steps = [step_of(path, snapshot, meta) for path, snapshot in zip(paths, snapshots, strict=True)]
    assert steps == [describe_snapshot(path) for path in paths]
    write_index(tmp_path, steps)
    assert (tmp_path / "run.vtkhdf").read_bytes() == index


def test_snapshots_of_different_runs_are_not_indexed(tmp_path: Path):
    with pytest.raises(OutputError, match="no snapshot to index"):
        write_index(tmp_path)
    write_snapshot(tmp_path, 0, make(0), META)
    write_snapshot(tmp_path, 1, make(1, n=N + 1), META)
    with pytest.raises(OutputError, match=r"000001.vtkhdf.*\(301.*000000.vtkhdf.*different runs"):
        write_index(tmp_path)
    list_snapshots(tmp_path)[1].write_bytes(b"")
    with pytest.raises(OutputError, match="000001.vtkhdf: not a readable snapshot"):
        write_index(tmp_path)


def test_properties():
    snapshot = make(2)
    assert np.array_equal(snapshot.x, snapshot.arrays["position"])
    snapshot.arrays["position"][:, 2] = 0.0
    assert np.array_equal(snapshot.x, snapshot.arrays["position"][:, :2])
    assert snapshot.column.sum() == N // 2 and snapshot.column[0]
    expected = np.sqrt((snapshot.arrays["displacement"] ** 2).sum(axis=1))
    assert np.allclose(snapshot.displacement_magnitude, expected, rtol=1e-15)
