"""The rows of a map: places that differ only in the value across, as tables and charts show them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from mpmcol.studies.method_map.verdict import Judged


@dataclass(frozen=True)
class Panel:
    """A panel of the chart: a run for each value down (rows) and across."""

    block: str
    title: str
    down: str  # key
    across: str
    rows: Sequence[Sequence[Judged]]

    @property
    def values_down(self) -> list[str]:
        """Of the rows, from the top."""
        return [row[0].place.choices[self.down] for row in self.rows]

    @property
    def values_across(self) -> list[str]:
        """Of the columns, from the left."""
        return [one.place.choices[self.across] for one in self.rows[0]]


def panels_of(judged: Sequence[Judged]) -> Iterator[Panel]:
    """Panels in their order."""
    by_panel: dict[tuple[str, str], dict[str, list[Judged]]] = {}
    for one in judged:
        place = one.place
        rows = by_panel.setdefault((place.block, place.panel), {})
        rows.setdefault(place.choices[place.down], []).append(one)
    for (block, title), rows in by_panel.items():
        place = next(iter(rows.values()))[0].place
        yield Panel(block, title, place.down, place.across, list(rows.values()))


def stands_up_to(row: Sequence[Judged]) -> Judged | None:
    """The last place of a row that stands, and all before it do; None if the first does not."""
    last = None
    for one in row:
        if one.verdict.name != "stands":
            break
        last = one
    return last
