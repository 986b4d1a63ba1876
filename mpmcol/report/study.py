"""Content of the report of a study: its Markdown files with their pictures."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from urllib.parse import unquote

from markdown_it import MarkdownIt
from markdown_it.token import Token

from mpmcol.errors import OutputError
from mpmcol.io.names import ENVIRONMENT_FILE
from mpmcol.report.model import Page, Section, Table
from mpmcol.report.pictures import file_picture

SCROLLED = {"table_open": '<div class="scroll" tabindex="0"><table>', "table_close": "</table></div>"}


def is_study(folder: Path) -> bool:
    """Whether a study has written its report into a folder."""
    return (folder / ENVIRONMENT_FILE).is_file() and bool(_documents(folder))


def study_page(folder: Path) -> Page:
    """The report of a study: one section for each of its Markdown files."""
    sections = [_section(folder, path.stem, _read(path)) for path in _documents(folder)]
    title = f"Study: {folder.resolve().name}"
    if len(sections) == 1:
        title, sections = sections[0].title, [replace(sections[0], title="Tables and charts")]
    return Page(
        title=title,
        kind="mpmcol: report of a study",
        sections=[*sections, Section("Versions and machine", tables=[_environment(folder / ENVIRONMENT_FILE)])],
    )


def _documents(folder: Path) -> list[Path]:
    """The texts of a study."""
    return [path for path in sorted(folder.glob("*.md")) if path.stem != "README"]


def _section(folder: Path, name: str, text: str) -> Section:
    """A document with its pictures; its first heading is the title, the others are moved down by one level."""
    markdown = MarkdownIt("commonmark", {"html": False}).enable("table")
    for rule, tag in SCROLLED.items():
        markdown.add_render_rule(rule, lambda *_, tag=tag: tag)
    tokens = markdown.parse(text)
    title = name
    if tokens and tokens[0].tag == "h1":
        title, tokens = tokens[1].content, tokens[3:]
    for token in _all(tokens):
        _adapt(token, folder)
    return Section(title, html=markdown.renderer.render(tokens, markdown.options, {}))


def _all(tokens: list[Token]) -> Iterator[Token]:
    for token in tokens:
        yield token
        yield from _all(token.children or [])


def _adapt(token: Token, folder: Path) -> None:
    """Headers of columns for screen readers, pictures as data, headings below that of the section."""
    if token.type == "th_open":
        token.attrSet("scope", "col")
    elif token.type in ("heading_open", "heading_close"):
        token.tag = f"h{min(int(token.tag[1]) + 1, 6)}"
    elif token.type == "image":
        picture = file_picture(folder / unquote(str(token.attrGet("src"))), "", "")
        token.attrs |= {"src": picture.source, "width": picture.size[0], "height": picture.size[1]}


def _environment(path: Path) -> Table:
    try:
        values = json.loads(path.read_bytes())
        rows = [(name, str(value)) for name, value in values.items()]
    except (OSError, ValueError, AttributeError) as error:
        raise OutputError(f"{path} cannot be read ({error}); repeat the command of the study") from None
    return Table(("Item", "Value"), rows, texts=2)


def _read(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, ValueError) as error:
        raise OutputError(f"{path} cannot be read ({error}); repeat the command of the study") from None
