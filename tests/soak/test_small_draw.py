"""A small draw of every promise of this folder, and the frame that tries them."""

from __future__ import annotations

from math import inf
from pathlib import Path

import pytest

from tests.soak.__main__ import plan
from tests.soak.figures import find_figures, load_figure
from tests.soak.records import Record, Records
from tests.soak.workers import carry_out_all

FIGURES = find_figures()
DRAW = [(name, seed) for name, figure in FIGURES.items() for seed in range(figure.draw)]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "seed"), DRAW)
def test_small_draw(name: str, seed: int, tmp_path: Path) -> None:
    assert FIGURES[name].attempt(seed, tmp_path / "trial") is None


def test_a_trial_that_fails_raises_or_dies_is_told_and_the_next_one_tried(tmp_path: Path) -> None:
    tasks = [("_broken", seed) for seed in (3, 2, 1, 0)]
    ended = {seed: wrong for (_, seed), wrong, _ in carry_out_all(tasks, 1, tmp_path, inf)}
    assert (ended[0], ended[1], ended[3]) == (None, "wrong", "its process died")
    assert "ValueError: an exception" in str(ended[2])
    assert sorted(path.name for path in tmp_path.iterdir()) == ["_broken-1", "_broken-2", "_broken-3"]
    assert not list(carry_out_all(tasks, 1, tmp_path, -inf))


def test_a_seed_is_tried_once_and_a_failure_stands(tmp_path: Path) -> None:
    figure, records = load_figure("_broken"), Records(tmp_path)
    for seed, wrong, version in ((0, None, "0+older"), (1, "wrong", figure.version), (1, None, figure.version)):
        records.add("_broken", Record(seed, wrong, 1.0, version, "this"))
    with (tmp_path / "_broken.jsonl").open("a") as file:
        file.write('{"seed": 2, "wr')
    assert records.tried(figure) == records.failed(figure) == {1}
    assert plan({"_broken": figure}, 0, None, {"_broken": {1}}) == [("_broken", seed) for seed in (0, 2, 3)]
    row = records.table([figure]).splitlines()[-1]
    assert row.startswith("| _broken | Trials that go wrong in every way, for the tests of the frame. | 1 | 1 | 2 |")
