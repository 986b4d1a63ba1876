"""Which simulations a sweep consists of, what their folders are called, and that all problems are told at once."""

from __future__ import annotations

import itertools
from pathlib import Path

import pytest

from mpmcol.case import load_case
from mpmcol.errors import CaseError
from mpmcol.io.names import GIVEN_CASE_FILE
from mpmcol.setup.memory import memory_bytes
from mpmcol.sweep import runs as module
from mpmcol.sweep.axes import parse_axes
from mpmcol.sweep.runs import PlannedRun, freeze, notes, plan_runs
from mpmcol.sweep.scheduling import Allocation, allocate
from mpmcol.sweep.series import arrange, choose_axis

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


def test_the_product_of_the_axes() -> None:
    points = plan("material.friction_deg=30,36", aspect="1,2", case="lube-channel")
    assert [tuple(point.inputs.values()) for point in points] == [(1, 30), (1, 36), (2, 30), (2, 36)]
    assert [point.name for point in points] == [f"a{a}-friction_deg{phi}" for a in (1, 2) for phi in (30, 36)]
    assert [point.case.material.friction_deg for point in points] == [30, 36, 30, 36]
    assert len({point.folder for point in points}) == 4


def test_zipped_axes_go_side_by_side() -> None:
    points = plan("grid.spacing=4 mm,8 mm", "material.friction_deg=30", aspect="1,2", zipped=True)
    assert [tuple(point.inputs.values()) for point in points] == [(1, 0.004, 30), (2, 0.008, 30)]
    assert [point.name for point in points] == ["a1-spacing0.004", "a2-spacing0.008"]


def test_names_of_words_and_of_keys_that_share_their_last_word() -> None:
    (point, _) = plan("method.transfer=pic,flip")
    assert point.name == "transfer-pic"
    points = plan("stages.equilibrate.damping=0.5,0.6", "stages.collapse.damping=0.1")
    assert points[0].name == "damping0.5"
    points = plan("stages.equilibrate.damping=0.5,0.6", "stages.collapse.damping=0.1,0.2")
    assert points[0].name == "stages.equilibrate.damping0.5-stages.collapse.damping0.1"
    assert "/" not in plan("title=a/b,c", "geometry.aspect=1,2", zipped=True)[0].folder.name


def test_the_folder_is_that_of_case_and_code(monkeypatch: pytest.MonkeyPatch) -> None:
    (folder,) = (point.folder for point in plan(aspect="1"))
    assert folder == plan(aspect="1.0")[0].folder == plan("geometry.height=0.097")[0].folder.with_name(folder.name)
    others = [plan(setting, aspect="1")[0].folder for setting in ("grid.spacing=0.006", "output.snapshots=3")]
    monkeypatch.setattr(module, "code_version", lambda: "another")
    others.append(plan(aspect="1")[0].folder)
    assert len({other.name.rpartition("-")[2] for other in (folder, *others)}) == 4
    assert all(other.name.startswith("a1-") for other in others)


def test_a_frozen_case_is_the_points(tmp_path: Path) -> None:
    (point,) = plan_runs("lube-cylinder", parse_axes("0.55", ["time.cfl=0.3"])[0], tmp_path)
    assert load_case(freeze(point)) == point.case
    (point.folder / GIVEN_CASE_FILE).write_text("kept")
    assert freeze(point).read_text() == "kept"


def test_all_problems_are_told_at_once() -> None:
    told = problems_of("grid.spacng=1", "grid.spacing=-1,0.01", "a", "time.cfl=3:1", aspect="-1,1")
    for part in (
        "--set a: expected KEY=VALUES",
        "time.cfl=3:1: 3:1: a range must rise",
        'unknown key "spacng"',
        "spacing = -1: expected a number > 0",
        "aspect = -1: expected a number > 0",
        "5 problems; nothing was run",
    ):
        assert part in told


def test_axes_that_do_not_go_together_are_told_with_all_else() -> None:
    told = problems_of("grid.spacing=-1,0.01", aspect="1,2,3", zipped=True)
    assert "--zip takes axes of one length, or of one value; these have: geometry.aspect 3, grid.spacing 2" in told
    assert "spacing = -1" in told


@pytest.mark.parametrize(
    ("settings", "options", "wrong"),
    [
        ((), {}, "there is nothing to vary"),
        (("geometry.aspect=2",), {"aspect": "1"}, "geometry.aspect is given twice"),
        (("geometry.domain_length=0.1",), {"aspect": "1,2"}, "point a1: geometry.domain_length = 0.1 m is too small"),
        (
            ("score.experiment=paper,lube-2004",),
            {},
            "experiment-paper and experiment-lube-2004 are the same simulation",
        ),
        (("time.cfl=0.1:0.4/200",), {"aspect": "1:2/200"}, "40,000 points are too many"),
        (("grid.spacing=1e-6",), {"aspect": "1"}, "GB"),
    ],
)
def test_what_cannot_be_run_is_refused(settings: tuple[str, ...], options: dict, wrong: str) -> None:
    assert wrong in problems_of(*settings, **options)


def test_notes_say_for_how_many_points_they_are_true() -> None:
    told = notes(plan("grid.spacing=0.0097,0.02", aspect="1"))
    assert any("0.0194 m" in note and note.endswith("(1 of 2 points)") for note in told)
    assert all("points)" not in note for note in notes(plan("grid.spacing=0.02", aspect="1,2")))


def test_work_grows_with_the_column() -> None:
    points = plan(aspect="0.5:7")
    assert all(small.work < large.work for small, large in itertools.pairwise(points))


MEMORY = 64e9


def shares(points: list[PlannedRun], cores: int, **options) -> tuple[int, int]:
    chosen = allocate(points, available=cores, **{"memory": MEMORY, **options})
    return chosen.jobs, chosen.threads


def test_small_points_run_side_by_side() -> None:
    points = plan(aspect="0.5:7")
    assert shares(points, 1) == (1, 1)
    assert shares(points, 2) == (2, 1)
    assert shares(points, 8) == (8, 1)
    assert shares(points[:2], 16)[0] == 2


def test_few_large_points_get_threads() -> None:
    points = plan(case="lube-quarter", aspect="7")
    assert shares(points, 8) == (1, 8)
    assert shares(plan(case="lube-quarter", aspect="0.55,7"), 8) in ((1, 8), (2, 4))


@pytest.mark.parametrize("cores", [1, 2, 3, 7, 16, 64])
def test_never_more_threads_than_cores(cores: int) -> None:
    for points in (plan(aspect="0.5:7"), plan(case="lube-quarter", aspect="0.55,0.9,1.7,2.75,7")):
        jobs, threads = shares(points, cores)
        assert 1 <= jobs * threads <= cores


def test_memory_limits_the_points_at_a_time() -> None:
    points = plan(case="lube-quarter", aspect="6,6.5,7")
    enough = sum(memory_bytes(point.discretization) + 250e6 for point in points) / 0.8
    assert shares(points, 3, memory=1.01 * enough, threads=1) == (3, 1)
    assert shares(points, 3, memory=0.99 * enough, threads=1) == (2, 1)
    assert shares(points, 3, memory=1.0, threads=1) == (1, 1)


def test_what_is_asked_for_is_done() -> None:
    points = plan(aspect="0.5:7")
    assert shares(points, 2, jobs=5) == (5, 1)
    assert shares(points, 4, threads=2) == (2, 2)
    assert shares(points, 2, jobs=3, threads=3) == (3, 3)
    assert str(Allocation(2, 1)) == "2 points at a time, 1 thread each" and str(Allocation(1, 4)).endswith("4 threads")


def rows(**columns: list) -> list[dict]:
    return [dict(zip(columns, values, strict=True)) for values in zip(*columns.values(), strict=True)]


def test_the_axis_is_the_aspect_ratio_or_what_varies_first() -> None:
    keys = ["geometry.aspect", "material.friction_deg"]
    both = {"geometry.aspect": [1, 1, 2, 2], "material.friction_deg": [30, 36, 30, 36], "a": [1, 1, 2, 2]}
    assert choose_axis(rows(**both), keys) == "a"
    series = arrange(rows(**both), keys, "a")
    assert [line.label for line in series] == ["friction_deg = 30", "friction_deg = 36"]
    assert [[row["a"] for row in line.rows] for line in series] == [[1, 2], [1, 2]]
    angles = both | {"geometry.aspect": [1] * 4, "a": [1] * 4, "material.friction_deg": [30, 32, 34, 36]}
    assert choose_axis(rows(**angles), keys) == "material.friction_deg"
    assert [line.label for line in arrange(rows(**angles), keys, "material.friction_deg")] == [""]
    assert choose_axis(rows(**angles)[:1], keys) == "a"


def test_zipped_axes_are_one_line() -> None:
    zipped = rows(**{"geometry.aspect": [1, 2], "grid.spacing": [0.01, 0.02], "a": [1, 2]})
    (line,) = arrange(zipped, ["geometry.aspect", "grid.spacing"], "a")
    assert line.label == "" and len(line.rows) == 2
