"""Pieces of Markdown reports."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path


def table(columns: Sequence[str], rows: Iterable[Iterable[str]]) -> Iterator[str]:
    """Yield the lines of a table."""
    yield _line(columns)
    yield "|---" * len(columns) + "|"
    yield from map(_line, rows)


def images(charts: Iterable[Path]) -> Iterator[str]:
    """Yield a line for each chart in the folder of the report."""
    return (f"![{chart.stem}]({chart.name})" for chart in charts)


def document(*sections: Iterable[str]) -> str:
    """Join sections, each given by its lines, with an empty line between them; empty sections are left out."""
    texts = ("\n".join(section) for section in sections)
    return "\n\n".join(text for text in texts if text) + "\n"


def _line(cells: Iterable[str]) -> str:
    return f"| {' | '.join(cells)} |"
