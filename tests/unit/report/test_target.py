"""The file of a report: its place, and what may be replaced."""

from __future__ import annotations

from pathlib import Path

import pytest

from mpmcol.errors import OutputError, UsageError
from mpmcol.report.model import Page
from mpmcol.report.page import render_page
from mpmcol.report.target import default_target, write_page

PAGE = render_page(Page("title", "kind"))


def test_default_place() -> None:
    assert default_target([Path("runs/a")]) == Path("runs/a/report.html")
    assert default_target([Path("runs/a"), Path("runs/b")]) == Path("report.html")


def test_an_earlier_report_is_replaced(tmp_path: Path) -> None:
    target = tmp_path / "report.html"
    write_page(target, lambda: PAGE, overwrite=False)
    write_page(target, lambda: "new", overwrite=False)
    assert target.read_text() == "new"


@pytest.mark.parametrize("content", ["", "<!doctype html><title>thesis</title>", "\xff\xfe", f"{' ' * 2000}{PAGE}"])
def test_another_file_is_kept(tmp_path: Path, content: str) -> None:
    target = tmp_path / "report.html"
    target.write_bytes(content.encode("latin-1"))
    with pytest.raises(UsageError, match="is not a report of mpmcol; use --overwrite"):
        write_page(target, pytest.fail, overwrite=False)  # nothing is computed before
    assert target.read_bytes() == content.encode("latin-1")
    write_page(target, lambda: PAGE, overwrite=True)
    assert target.read_text() == PAGE


def test_a_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="is a folder; give the HTML file"):
        write_page(tmp_path, lambda: PAGE, overwrite=True)


def test_a_missing_folder_is_reported(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="does not exist; create it"):
        write_page(tmp_path / "no/report.html", lambda: PAGE, overwrite=False)


def test_an_error_leaves_the_earlier_report(tmp_path: Path) -> None:
    target = tmp_path / "report.html"
    write_page(target, lambda: PAGE, overwrite=False)

    def fail() -> str:
        raise OutputError("damaged")

    with pytest.raises(OutputError):
        write_page(target, fail, overwrite=False)
    assert target.read_text() == PAGE and list(tmp_path.iterdir()) == [target]
