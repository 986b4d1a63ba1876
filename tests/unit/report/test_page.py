"""HTML of a report: escaping, structure for screen readers, and no reference to anything outside the file."""

from __future__ import annotations

import re

import pytest

from mpmcol.report.model import Figure, Page, Picture, Section, Table
from mpmcol.report.page import render_page

HOSTILE = '<script>alert("1")</script>&amp;'
ESCAPED = "&lt;script&gt;alert(&#34;1&#34;)&lt;/script&gt;&amp;amp;"
PICTURE = Picture("data:image/png;base64,AAAA", HOSTILE, HOSTILE, (400, 300), "data:image/png;base64,BBBB")


def whole_page(text: str) -> Page:
    """A page with this text in every place."""
    table = Table((text, text, text), [(text, text, text)], text, texts=2)
    section = Section(text, lines=[text], tables=[table], pictures=[PICTURE], listings=[(text, text)])
    return Page(text, text, facts=[text], figures=[Figure(text, text, text)], sections=[section])


def test_text_is_escaped_everywhere() -> None:
    page = render_page(whole_page(HOSTILE))
    assert "<script" not in page
    # title twice, kind, fact, figure 3, contents, heading, line, region, caption, cells 6, alt 2, caption, listing 2
    assert page.count(ESCAPED) == 23


def test_a_page_has_what_screen_readers_use() -> None:
    page = render_page(whole_page("text"))
    assert '<html lang="en">' in page and page.count("<h1") == 1
    assert page.count('<th scope="col"') == 3 and page.count('<th scope="row">') == 1
    assert all(re.search(r'alt="[^"]+"', image) for image in re.findall("<img[^>]*>", page))
    assert re.findall(r'href="#([^"]*)"', page) == re.findall(r'<section id="([^"]*)"', page) == ["section-1"]


def test_columns_of_numbers_are_marked() -> None:
    page = render_page(whole_page("text"))
    assert page.count('<th scope="col" class="number">') == page.count('<td class="number">') == 1


def test_what_is_empty_leaves_no_element() -> None:
    page = render_page(Page("title", "kind", sections=[Section("empty")]))
    assert not re.search("<(ul|dl|table|figure|pre|h3|img)", page)


@pytest.mark.parametrize("name", ["src", "href", "action", "data"])
def test_a_page_loads_nothing_from_elsewhere(name: str) -> None:
    page = render_page(whole_page("text"))
    assert all(value.startswith(("data:", "#")) for value in re.findall(rf'\b{name}="([^"]*)"', page))
    assert "url(" not in page and "@import" not in page
