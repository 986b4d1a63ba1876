"""Results of trials: one line of JSON each, written when the trial ends, and the table of all results."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path

from tests.soak.runner.promise import Promise

HEAD = "| trials of | promise | trials | failures | seconds | version | machine |\n|---|---|---|---|---|---|---|\n"


@dataclass(frozen=True)
class Record:
    """One trial; `failure` is None if it passed."""

    seed: int
    failure: str | None
    seconds: float
    version: str
    machine: str


class Records:
    """The results of all trials, kept in a folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        folder.mkdir(parents=True, exist_ok=True)

    def add(self, name: str, record: Record) -> None:
        """Append one result."""
        with (self.folder / f"{name}.jsonl").open("a") as file:
            file.write(json.dumps(asdict(record)) + "\n")

    def of(self, name: str) -> list[Record]:
        """All readable results of a promise; the last line of the file may be incomplete."""
        path, found = self.folder / f"{name}.jsonl", []
        for line in path.read_text().splitlines() if path.exists() else []:
            try:
                found.append(Record(**json.loads(line)))
            except (ValueError, TypeError):
                continue
        return found

    def tried(self, promise: Promise) -> set[int]:
        """Seeds tried with the present code."""
        return {record.seed for record in self.of(promise.name) if record.version == promise.version}

    def failed(self, promise: Promise) -> set[int]:
        """Seeds that failed at least once with the present code."""
        records = [record for record in self.of(promise.name) if record.version == promise.version]
        return {record.seed for record in records if record.failure is not None}

    def table(self, promises: Iterable[Promise]) -> str:
        """One row for each promise with results: those of the version that was tried last."""
        return HEAD + "".join(_row(promise, records) for promise in promises if (records := self.of(promise.name)))


def _row(promise: Promise, records: list[Record]) -> str:
    last = records[-1]
    latest = [record for record in records if record.version == last.version]
    trials, failures = {one.seed for one in latest}, {one.seed for one in latest if one.failure is not None}
    seconds = sum(one.seconds for one in latest)
    numbers = f"{len(trials):,}", f"{len(failures):,}", f"{seconds:,.0f}"
    return f"| {' | '.join((promise.name, promise.text, *numbers, last.version, last.machine))} |\n"
