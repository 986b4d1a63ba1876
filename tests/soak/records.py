"""What came of trials: a line of JSON each, written as they end, and the table over them."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path

from tests.soak.figures import Figure

HEAD = "| figure | promise | trials | failures | seconds | version | machine |\n|---|---|---|---|---|---|---|\n"


@dataclass(frozen=True)
class Record:
    """One trial; `wrong` is None if all was well."""

    seed: int
    wrong: str | None
    seconds: float
    version: str
    machine: str


class Records:
    """The trials of all figures, kept in a folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        folder.mkdir(parents=True, exist_ok=True)

    def add(self, name: str, record: Record) -> None:
        """Keep one."""
        with (self.folder / f"{name}.jsonl").open("a") as file:
            file.write(json.dumps(asdict(record)) + "\n")

    def of(self, name: str) -> list[Record]:
        """All of a figure that can be read: the last line may be half written."""
        path, found = self.folder / f"{name}.jsonl", []
        for line in path.read_text().splitlines() if path.exists() else []:
            try:
                found.append(Record(**json.loads(line)))
            except (ValueError, TypeError):
                continue
        return found

    def tried(self, figure: Figure) -> set[int]:
        """Seeds that were tried with the present code."""
        return {one.seed for one in self.of(figure.name) if one.version == figure.version}

    def failed(self, figure: Figure) -> set[int]:
        """Seeds of them that went wrong, if only once."""
        return {one.seed for one in self.of(figure.name) if one.version == figure.version and one.wrong is not None}

    def table(self, figures: Iterable[Figure]) -> str:
        """A row for each figure that was tried: what came of the version that was tried last."""
        return HEAD + "".join(_row(figure, records) for figure in figures if (records := self.of(figure.name)))


def _row(figure: Figure, records: list[Record]) -> str:
    last = records[-1]
    latest = [one for one in records if one.version == last.version]
    trials, failures = {one.seed for one in latest}, {one.seed for one in latest if one.wrong is not None}
    seconds = sum(one.seconds for one in latest)
    numbers = f"{len(trials):,}", f"{len(failures):,}", f"{seconds:,.0f}"
    return f"| {' | '.join((figure.name, figure.promise, *numbers, last.version, last.machine))} |\n"
