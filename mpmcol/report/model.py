"""Content of a report, without its layout."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Picture:
    """An image as a data URI.

    alt: what it shows, for readers who do not see it. size: width and height, pixels. still: of an animation, one of
    its frames as a data URI, for print.
    """

    source: str
    alt: str
    caption: str
    size: tuple[int, int]
    still: str = ""


@dataclass(frozen=True)
class Table:
    """A table; the first cell of each row is its header."""

    columns: Sequence[str]
    rows: Sequence[Sequence[str]]
    caption: str = ""
    texts: int = 1  # number of the first columns that hold text; the others hold numbers


@dataclass(frozen=True)
class Section:
    """A part of a report; what is empty is left out. Its parts follow each other in this order."""

    title: str
    lines: Sequence[str] = ()
    tables: Sequence[Table] = ()
    pictures: Sequence[Picture] = ()
    listings: Sequence[tuple[str, str]] = ()  # name and text of files
    html: str = ""  # made by the Markdown library
    is_wide: bool = False  # pictures below each other, not side by side


@dataclass(frozen=True)
class Figure:
    """A key figure of a run."""

    name: str
    value: str
    note: str = ""


@dataclass(frozen=True)
class Page:
    """A report. kind: of what; facts: short lines below the title."""

    title: str
    kind: str
    facts: Sequence[str] = ()
    figures: Sequence[Figure] = ()
    sections: Sequence[Section] = ()
