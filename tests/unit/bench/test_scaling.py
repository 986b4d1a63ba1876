"""Scaling with the number of threads: the model of the tiles, the rounds, and the command."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from mpmcol.bench.measure import QUICK
from mpmcol.bench.scaling import MODELLED, MOST_POINTS, ReleasedCase, Threads, choose_threads, measure_scaling
from mpmcol.bench.scaling_report import measured_row
from mpmcol.bench.tile_model import model_speedup, points_of_groups
from mpmcol.mpm.grid import Tiles, no_tiles
from mpmcol.mpm.threads import set_threads
from tests.support.cli import invoke

# Four tiles with 5, 1, 20 and 9 points; the points from 35 on are inactive. The second group has no tile.
TILES = no_tiles()._replace(
    start=np.array([0, 5, 6, 26, 35]), grouped=np.array([0, 3, 1, 2]), group_start=np.array([0, 2, 2, 4])
)


def tiles_of(groups: list[list[int]]) -> Tiles:
    """Groups of tiles with these numbers of points."""
    points = [n for group in groups for n in group]
    return no_tiles()._replace(
        start=np.concatenate(([0], np.cumsum(points))),
        grouped=np.arange(len(points)),
        group_start=np.concatenate(([0], np.cumsum([len(group) for group in groups]))),
    )


@pytest.fixture(scope="module")
def released() -> ReleasedCase:
    return ReleasedCase("plane", 2000, QUICK)


def test_tiles_are_taken_in_the_order_of_their_groups() -> None:
    assert [group.tolist() for group in points_of_groups(TILES)] == [[5, 9], [1, 20]]
    assert model_speedup(TILES, 2) == pytest.approx(35 / (9 + 20))


@pytest.mark.parametrize(
    ("threads", "time"),
    [(1, 15), (2, 5 + 4), (3, 5 + 4), (64, 5 + 4), (10**12, 5 + 4)],
)
def test_each_group_waits_for_its_busiest_thread(threads: int, time: int) -> None:
    assert model_speedup(tiles_of([[5, 1, 1], [4, 4]]), threads) == pytest.approx(15 / time)


def test_equal_tiles_scale_up_to_their_number() -> None:
    tiles = tiles_of([[50] * 12, [50] * 12])
    assert [model_speedup(tiles, n) for n in (1, 2, 3, 4, 5, 12, 24)] == pytest.approx([1, 2, 3, 4, 4, 12, 12])


def test_the_tiles_of_a_case_hold_all_of_its_points(released: ReleasedCase) -> None:
    groups = points_of_groups(released.tiles)
    assert sum(group.sum() for group in groups) == released.n_points
    assert 1.0 < model_speedup(released.tiles, 2) < 2.0


def test_threads_are_measured_up_to_the_cores_and_modelled_beyond() -> None:
    assert choose_threads(None, 2) == Threads((1, 2), MODELLED)
    assert choose_threads(None, 1) == Threads((1,), MODELLED)
    assert choose_threads(None, 12) == Threads((1, 2, 4, 8, 12), (16, 32, 64))
    assert choose_threads(None, 96) == Threads((1, 2, 4, 8, 16, 32, 64, 96), ())
    assert choose_threads((3, 2, 3), 2) == Threads((1, 2), (3,))


def test_every_round_repeats_the_same_steps(released: ReleasedCase) -> None:
    assert (released.step_seconds(1, 3) > 0.0).all()
    rows, dt = released.solver.points.rows.copy(), released.solver.dt
    assert (rows != released.rows).any()
    released.step_seconds(2, 3)
    np.testing.assert_array_equal(released.solver.points.rows, rows)
    assert released.solver.dt == dt


def test_ratios_are_those_of_paired_rounds_and_of_the_fastest_steps() -> None:
    times, single = np.array([[1.0, 0.5, 1.5], [4.0, 4.0, 5.0], [2.0, 1.0, 3.0]]), np.array([[3.0], [4.0], [8.0]])
    row = measured_row(2, 35, TILES, times, single)
    assert row.speedup == 3.0 and row.efficiency == 1.5 and row.fastest_speedup == 3.0 / 0.5
    assert row.step is not None and (row.step.median, row.step.min, row.step.max) == (2.0, 1.0, 4.0)
    assert (row.groups, row.mean_tiles, row.fewest_tiles) == (2, 2.0, 2)


def test_weak_cases_grow_with_the_threads_and_large_ones_are_left_out() -> None:
    threads = Threads((1,), (3, MOST_POINTS))
    weak = measure_scaling("plane", "weak", 2000, threads, QUICK)
    assert [row.threads for row in weak.rows] == [1, 3]
    assert weak.rows[1].n_points == pytest.approx(6000, rel=0.1)
    strong = measure_scaling("plane", "strong", 2000, threads, QUICK)
    assert [row.threads for row in strong.rows] == [1, 3, MOST_POINTS]
    assert len({row.n_points for row in strong.rows}) == 1


def test_the_command_prints_and_writes_tables(tmp_path: Path) -> None:
    done = invoke("bench", "--scaling", "--quick", "--model", "plane", "--points", "1500", "--out", tmp_path, "--json")
    assert done.exit_code == 0, done.output
    record = json.loads(done.stdout)
    assert record == json.loads((tmp_path / "scaling.json").read_text())
    expected = choose_threads(None, set_threads(None))
    for kind, case in zip(("strong", "weak"), record["cases"], strict=True):
        assert case["kind"] == kind and f"plane, {kind} scaling" in done.stderr
        assert [row["threads"] for row in case["rows"] if row["step"]] == list(expected.measured)
        assert [row["threads"] for row in case["rows"] if not row["step"]] == list(expected.modelled)
        assert case["rows"][0]["speedup"] == case["rows"][0]["model_speedup"] == 1.0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--against", "bench.json"], "--against compares times of the kernels"),
        (["--points", "9" * 12], "give fewer --points or --threads"),
        (["--threads", "0"], "expected integers > 0"),
    ],
)
def test_wrong_options_are_refused(arguments: list[str], message: str) -> None:
    done = invoke("bench", "--scaling", *arguments)
    assert done.exit_code == 2 and message in done.output
