"""Planned runs of a sweep: combinations, folders, problems, and the allocation of cores."""

from __future__ import annotations

import itertools
import json
from pathlib import Path
from typing import Any

import pytest

from mpmcol.case import key_names, load_case
from mpmcol.errors import CaseError, OutputError
from mpmcol.io.names import GIVEN_CASE_FILE
from mpmcol.setup.memory import memory_bytes
from mpmcol.sweep import runs as sweep_runs
from mpmcol.sweep.axes import parse_axes
from mpmcol.sweep.compile_cache import kernel_variant
from mpmcol.sweep.names import run_name, safe_name, short_names, sweep_name
from mpmcol.sweep.notes import counted_warnings, notes_on_plan
from mpmcol.sweep.plan import PLAN_FILE, PLAN_SCHEMA, read_plan
from mpmcol.sweep.runs import PlannedRun, plan_runs, write_case
from mpmcol.sweep.scheduling import Allocation, allocate
from mpmcol.sweep.series import choose_axis, group_rows

OUT = Path("sweeps/x")


def plan(
    *settings: str, aspect: str | None = None, zipped: bool = False, case: str = "lube-cylinder"
) -> list[PlannedRun]:
    axes, problems = parse_axes(aspect, settings)
    return plan_runs(case, axes, OUT, zipped, problems)


def problems_of(*settings: str, **options) -> str:
    with pytest.raises(CaseError) as raised:
        plan(*settings, **options)
    return str(raised.value)


def test_axes_are_combined_in_all_ways() -> None:
    runs = plan("material.friction_deg=30,36", aspect="1,2", case="lube-channel")
    assert [tuple(run.inputs.values()) for run in runs] == [(1, 30), (1, 36), (2, 30), (2, 36)]
    assert [run.name for run in runs] == [f"a{a}-friction{phi}deg" for a in (1, 2) for phi in (30, 36)]
    assert [run.case.material.friction_deg for run in runs] == [30, 36, 30, 36]
    assert len({run.folder for run in runs}) == 4


def test_zipped_axes_are_combined_in_order() -> None:
    runs = plan("grid.spacing=4 mm,8 mm", "material.friction_deg=30", aspect="1,2", zipped=True)
    assert [tuple(run.inputs.values()) for run in runs] == [(1, 0.004, 30), (2, 0.008, 30)]
    assert [run.name for run in runs] == ["a1-spacing4mm", "a2-spacing8mm"]


def test_names_of_text_values_and_of_keys_that_share_their_last_part() -> None:
    (run, _) = plan("method.transfer=pic,flip")
    assert run.name == "transfer-pic"
    runs = plan("stages.equilibrate.damping=0.5,0.6", "stages.collapse.damping=0.1")
    assert runs[0].name == "equilibrate.damping0.5"
    runs = plan("stages.equilibrate.damping=0.5,0.6", "stages.collapse.damping=0.1,0.2")
    assert runs[0].name == "equilibrate.damping0.5-collapse.damping0.1"
    assert "/" not in plan("title=a/b,c", "geometry.aspect=1,2", zipped=True)[0].folder.name


def test_a_short_name_is_that_of_one_key() -> None:
    """Of a key of the column it is the last part; no other key has that name."""
    indexed = ["walls.0.height", "walls.1.height", "layers.0.material.friction_deg", "layers.1.to"]
    tables = {name.rpartition(".")[0] for name in key_names()}
    single = [name for name in key_names() if name not in tables and not name.startswith(("walls.", "layers."))]
    names = {key: short_names([key])[key] for key in (*single, *indexed)}
    assert len(set(names.values())) == len(names)
    assert (names["geometry.height"], names["material.friction_deg"]) == ("height", "friction_deg")
    assert short_names(["walls.0.height"]) == {"walls.0.height": "walls.0.height"}
    assert short_names(["base_material.friction_deg"])["base_material.friction_deg"] == "base_material.friction_deg"


def test_names_of_folders_have_the_wall_and_the_layer() -> None:
    walls = plan_runs("dam", parse_axes(None, ["walls.0.height=20 mm,30 mm"])[0], Path("s"))
    assert [run.name for run in walls] == ["walls.0.height20mm", "walls.0.height30mm"]
    layers = plan_runs("layered-column", parse_axes(None, ["layers.0.material.friction_deg=22,25"])[0], Path("s"))
    assert [run.name for run in layers] == ["layers.0.material.friction22deg", "layers.0.material.friction25deg"]


def test_the_folder_depends_on_case_and_code(monkeypatch: pytest.MonkeyPatch) -> None:
    (folder,) = (run.folder for run in plan(aspect="1"))
    assert folder == plan(aspect="1.0")[0].folder == plan("geometry.height=0.097")[0].folder.with_name(folder.name)
    others = [plan(setting, aspect="1")[0].folder for setting in ("grid.spacing=0.006", "output.snapshots=3")]
    monkeypatch.setattr(sweep_runs, "code_version", lambda: "another")
    others.append(plan(aspect="1")[0].folder)
    assert len({other.name.rpartition("-")[2] for other in (folder, *others)}) == 4
    assert all(other.name.startswith("a1-") for other in others)


def test_the_written_case_is_that_of_the_run_and_is_kept(tmp_path: Path) -> None:
    (run,) = plan_runs("lube-cylinder", parse_axes("0.55", ["time.cfl=0.3"])[0], tmp_path)
    assert load_case(write_case(run)) == run.case
    (run.folder / GIVEN_CASE_FILE).write_text("already there")
    assert write_case(run).read_text() == "already there"


def test_all_problems_are_reported_at_once() -> None:
    text = problems_of("grid.spacng=1", "grid.spacing=-1,0.01", "a", "time.cfl=3:1", aspect="-1,1")
    for part in (
        "--set a: expected KEY=VALUES",
        "time.cfl=3:1: 3:1: the end of a range must be greater than its start",
        'unknown key "spacng"',
        "spacing = -1: expected a number > 0",
        "aspect = -1: expected a number > 0",
        "5 problems; nothing was run",
    ):
        assert part in text


def test_unequal_axes_are_reported_with_all_other_problems() -> None:
    text = problems_of("grid.spacing=-1,0.01", aspect="1,2,3", zipped=True)
    assert (
        "--zip requires axes with equal numbers of values, or with one value; found: geometry.aspect 3, grid.spacing 2"
        in text
    )
    assert "spacing = -1" in text


@pytest.mark.parametrize(
    ("settings", "options", "message"),
    [
        ((), {}, "no key to vary"),
        (("geometry.aspect=2",), {"aspect": "1"}, "geometry.aspect is given twice"),
        (("geometry.domain_length=0.1",), {"aspect": "1,2"}, "run a1: geometry.domain_length = 0.1 m is too small"),
        (
            ("score.experiment=paper,lube-2004",),
            {},
            "experiment-paper and experiment-lube-2004 are the same simulation",
        ),
        (("time.cfl=0.1:0.4/200",), {"aspect": "1:2/200"}, "40,000 runs are too many"),
        (("grid.spacing=1e-6",), {"aspect": "1"}, "GB"),
    ],
)
def test_invalid_sweeps_are_refused(settings: tuple[str, ...], options: dict, message: str) -> None:
    assert message in problems_of(*settings, **options)


def test_notes_state_the_number_of_runs_they_apply_to() -> None:
    lines = notes_on_plan(plan("grid.spacing=0.0097,0.02", aspect="1"))
    assert any("0.0194 m" in note and note.endswith("(1 of 2 runs)") for note in lines)
    assert all("runs)" not in note for note in notes_on_plan(plan("grid.spacing=0.02", aspect="1,2")))


def test_warnings_that_differ_in_numbers_are_reported_once() -> None:
    (line,) = notes_on_plan(
        plan(
            "material.dilatancy_deg=0,8,12",
            "grid.spacing=0.0097",
            "geometry.base=rigid",
            "method.wall_impulse=true",
            aspect="1,2",
        )
    )
    assert line.startswith("material.dilatancy_deg = 8: ")
    assert line.endswith("(4 of 6 runs, with the numbers of the first)")


def test_work_increases_with_the_size_of_the_column() -> None:
    runs = plan(aspect="0.5:7")
    assert all(small.work < large.work for small, large in itertools.pairwise(runs))


MEMORY = 64e9


def allocation(runs: list[PlannedRun], cores: int, **options) -> tuple[int, int]:
    chosen = allocate(runs, cores=cores, **{"memory": MEMORY, **options})
    return chosen.jobs, chosen.threads


def test_small_runs_are_executed_concurrently() -> None:
    runs = plan(aspect="0.5:7")
    assert allocation(runs, 1) == (1, 1)
    assert allocation(runs, 2) == (2, 1)
    assert allocation(runs, 8) == (8, 1)
    assert allocation(runs[:2], 16)[0] == 2


def test_few_large_runs_get_threads() -> None:
    runs = plan(case="lube-quarter", aspect="7")
    assert allocation(runs, 8) == (1, 8)
    assert allocation(plan(case="lube-quarter", aspect="0.55,7"), 8) in ((1, 8), (2, 4))


@pytest.mark.parametrize("cores", [1, 2, 3, 7, 16, 64])
def test_never_more_threads_than_cores(cores: int) -> None:
    for runs in (plan(aspect="0.5:7"), plan(case="lube-quarter", aspect="0.55,0.9,1.7,2.75,7")):
        jobs, threads = allocation(runs, cores)
        assert 1 <= jobs * threads <= cores


def test_memory_limits_the_number_of_concurrent_runs() -> None:
    runs = plan(case="lube-quarter", aspect="6,6.5,7")
    enough = sum(memory_bytes(run.discretization) + 250e6 for run in runs) / 0.8
    assert allocation(runs, 3, memory=1.01 * enough, threads=1) == (3, 1)
    assert allocation(runs, 3, memory=0.99 * enough, threads=1) == (2, 1)
    assert allocation(runs, 3, memory=1.0, threads=1) == (1, 1)


def test_prescribed_jobs_and_threads_are_kept() -> None:
    runs = plan(aspect="0.5:7")
    assert allocation(runs, 2, jobs=5) == (5, 1)
    assert allocation(runs, 4, threads=2) == (2, 2)
    assert allocation(runs, 2, jobs=3, threads=3) == (3, 3)
    assert str(Allocation(2, 1)) == "2 runs at a time, 1 thread per run" and str(Allocation(1, 4)).endswith(
        "4 threads per run"
    )


def rows(**columns: list) -> list[dict]:
    return [dict(zip(columns, values, strict=True)) for values in zip(*columns.values(), strict=True)]


def test_the_axis_is_the_aspect_ratio_or_the_first_key_that_varies() -> None:
    keys = ["geometry.aspect", "material.friction_deg"]
    both = {"geometry.aspect": [1, 1, 2, 2], "material.friction_deg": [30, 36, 30, 36], "a": [1, 1, 2, 2]}
    assert choose_axis(rows(**both), keys) == "a"
    series = group_rows(rows(**both), keys, "a")
    assert [line.label for line in series] == ["friction_deg = 30", "friction_deg = 36"]
    assert [[row["a"] for row in line.rows] for line in series] == [[1, 2], [1, 2]]
    angles = both | {"geometry.aspect": [1] * 4, "a": [1] * 4, "material.friction_deg": [30, 32, 34, 36]}
    assert choose_axis(rows(**angles), keys) == "material.friction_deg"
    assert [line.label for line in group_rows(rows(**angles), keys, "material.friction_deg")] == [""]
    assert choose_axis(rows(**angles)[:1], keys) == "a"


def test_zipped_axes_form_one_series() -> None:
    zipped = rows(**{"geometry.aspect": [1, 2], "grid.spacing": [0.01, 0.02], "a": [1, 2]})
    (line,) = group_rows(zipped, ["geometry.aspect", "grid.spacing"], "a")
    assert line.label == "" and len(line.rows) == 2


def test_the_folder_of_a_sweep_names_its_keys() -> None:
    def name(*settings: str, aspect: str | None = "1,2", accuracy: float | None = None, corrected: bool = False) -> str:
        return sweep_name("lube-channel", parse_axes(aspect, settings)[0], accuracy, corrected)

    assert name() == "lube-channel"
    assert name("material.friction_deg=30,33", "time.cfl=0.4") == "lube-channel-friction_deg-cfl-0.4"
    assert name(accuracy=0.05) == "lube-channel-accuracy0.05"
    assert name(accuracy=0.05, corrected=True) == "lube-channel-accuracy0.05-corrected"
    assert name("material.friction_deg=30,33", aspect="2") == "lube-channel-a2-friction_deg"
    assert name("grid.spacing=4 mm").startswith("lube-channel-spacing-4_mm-")


def test_values_that_look_alike_in_a_name_have_different_folders() -> None:
    def name(times: str) -> str:
        overrides = [f"output.times={times}"]
        return run_name("coarse-channel", load_case("coarse-channel", overrides), overrides)

    assert len({name("[0.1, 0.2]"), name("[0.1, 0.3]"), name("[0.1]")}) == 3
    assert name("[0.1,0.2]") == name("[0.1, 0.2]")
    long = [safe_name("x" * 90 + end) for end in "ab"]
    assert long[0] != long[1] and len(long[0]) < 90


def test_the_cost_of_a_run_is_its_work_at_the_pace_of_its_method() -> None:
    """A point and step takes longer in 3D, and with two passes over the points (scripts/peers/README.md)."""
    plane, slow, solid = (
        PlannedRun({}, load_case(name, values), Path())
        for name, values in (("channel", []), ("channel", ["method.stress_order=musl"]), ("quarter", []))
    )
    assert plane.cost == plane.work
    assert slow.work == plane.work and slow.cost > 1.5 * slow.work
    assert solid.cost > 1.3 * solid.work


BED = "base_material={law='drucker-prager', density=1600, youngs_modulus=1e6, friction_deg=30}"


@pytest.mark.parametrize("setting", ["walls=[{from=0.2}]", "geometry.base=granular", BED])
def test_runs_that_need_other_kernels_are_not_one_variant(setting: str) -> None:
    base = ["geometry.base=granular"] if setting == BED else ["geometry.base=rigid", "method.wall_impulse=true"]

    def variant(*keys: str) -> tuple[object, ...]:
        return kernel_variant(PlannedRun({}, load_case("channel", [*base, *keys]), OUT))

    assert variant() != variant(setting) and variant() == variant("grid.spacing=0.01")


@pytest.mark.parametrize(
    "change", [{"runs": []}, {"jobs": 0}, {"cost": 0.0}, {"cost": "2"}, {"end": 0.0}, {"end": -1.0}, {"runs": None}]
)
def test_a_damaged_plan_is_refused_in_words(change: dict[str, Any], tmp_path: Path) -> None:
    run = {"folder": "a1", "inputs": {}, "cost": 1.0, "end": 1.0}
    content = {"schema": PLAN_SCHEMA, "title": "", "version": "1", "jobs": 1, "threads": 1, "runs": [run]}
    (tmp_path / PLAN_FILE).write_text(json.dumps(content))
    assert read_plan(tmp_path).runs[0].folder == "a1"
    run |= {key: value for key, value in change.items() if key in run}
    content |= {key: value for key, value in change.items() if key in content}
    (tmp_path / PLAN_FILE).write_text(json.dumps(content))
    with pytest.raises(OutputError, match="cannot be read"):
        read_plan(tmp_path)


def test_each_kind_of_warning_has_the_number_of_its_runs() -> None:
    """Also of a kind that a run has twice, as of two layers."""
    by_run = [["5 cells only", "layer 1 is thin", "layer 2 is thin"], ["5 cells only"], [], ["5 cells only", "soft"]]
    assert counted_warnings(by_run) == [
        "5 cells only (3 of 4 runs)",
        "layer 1 is thin (1 of 4 runs)",
        "soft (1 of 4 runs)",
    ]
    assert counted_warnings([["2 cells"], ["3 cells"]]) == ["2 cells (2 of 2 runs, with the numbers of the first)"]
