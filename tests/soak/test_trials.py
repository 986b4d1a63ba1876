"""A few trials of every promise, and the runner of the trials."""

from __future__ import annotations

from math import inf
from pathlib import Path

import pytest

from tests.soak.__main__ import plan
from tests.soak.runner.promise import find_promises, load_promise
from tests.soak.runner.records import Record, Records
from tests.soak.runner.workers import carry_out_all

PROMISES = find_promises()
TRIALS = [(name, seed) for name, promise in PROMISES.items() for seed in range(promise.small_count)]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "seed"), TRIALS)
def test_trial(name: str, seed: int, tmp_path: Path) -> None:
    assert PROMISES[name].attempt(seed, tmp_path / "trial") is None


def test_every_promise_has_trials() -> None:
    assert all(promise.count > 0 and callable(promise.module.trial) for promise in PROMISES.values())


def test_after_a_failure_an_exception_or_a_crash_the_next_trial_is_carried_out(tmp_path: Path) -> None:
    tasks = [("_failing", seed) for seed in (3, 2, 1, 0)]
    ended = {seed: failure for (_, seed), failure, _ in carry_out_all(tasks, 1, tmp_path, inf)}
    assert (ended[0], ended[1], ended[3]) == (None, "failed", "the process of the trial died")
    assert "ValueError: an exception" in str(ended[2])
    assert sorted(path.name for path in tmp_path.iterdir()) == ["_failing-1", "_failing-2", "_failing-3"]
    assert not list(carry_out_all(tasks, 1, tmp_path, -inf))


def test_a_seed_is_tried_once_and_its_failure_is_kept(tmp_path: Path) -> None:
    promise, records = load_promise("_failing"), Records(tmp_path)
    for seed, failure, version in ((0, None, "0+older"), (1, "failed", promise.version), (1, None, promise.version)):
        records.add("_failing", Record(seed, failure, 1.0, version, "this"))
    with (tmp_path / "_failing.jsonl").open("a") as file:
        file.write('{"seed": 2, "fa')
    assert records.tried(promise) == records.failed(promise) == {1}
    assert plan({"_failing": promise}, 0, None, {"_failing": {1}}) == [("_failing", seed) for seed in (0, 2, 3)]
    row = records.table([promise]).splitlines()[-1]
    assert row.startswith("| _failing | Trials that fail in every way, for the tests of the runner. | 1 | 1 | 2 |")
