"""Chromium without a window: what it finds on a page, its console, its print.

`make browser` installs it on Debian; without it the tests that use it are skipped, or fail
where `.ci/run` could install it.
"""

from __future__ import annotations

import html
import json
import os
import re
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome")
INSTALL = "no Chromium here; on Debian, as root: make browser"
REQUIRED = "MPMCOL_REQUIRE_BROWSER"
OPTIONS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
    "--disable-background-networking", "--enable-logging=stderr", "--v=0",
)  # fmt: skip
PATIENCE = 120.0  # s
# Added to a copy of the page: it reports to the page with the frames.
PROBE = """
<script>
addEventListener("load", () => {
  const root = document.documentElement;
  const images = [...document.images].map(image => ({
    alt: image.alt, natural: image.naturalWidth, right: image.getBoundingClientRect().right}));
  const content = Math.max(root.scrollWidth, document.body.scrollWidth);
  parent.postMessage({width: innerWidth, content: content, images: images}, "*");
});
</script>
"""
# A window is at least 500 pixels wide; a frame may be narrower.
FRAMES = """<!doctype html><meta charset="utf-8"><pre id="found"></pre>
<script>
const found = [];
addEventListener("message", event => {
  found.push(event.data);
  document.getElementById("found").textContent = JSON.stringify(found);
});
</script>
"""
FRAME = '<iframe src="{page}" style="width: {width}px; height: 900px; border: 0"></iframe>\n'


@dataclass(frozen=True)
class Loaded:
    """A page as loaded: widths in pixels, and its images with `alt`, `natural` width and `right` end."""

    width: int  # of the frame
    content: int  # of the page; larger than that of the frame if it has to be scrolled sideways
    images: list[dict[str, Any]]


def find_browser() -> str:
    """The program; the test is skipped if there is none, or fails where REQUIRED is set."""
    found = next(filter(None, map(shutil.which, NAMES)), None)
    if found is None and os.environ.get(REQUIRED):
        pytest.fail(f"{INSTALL} ({REQUIRED} is set)")
    if found is None:
        pytest.skip(INSTALL)
    return found


def load(page: Path, widths: Sequence[int], folder: Path) -> tuple[list[Loaded], list[str]]:
    """The page as loaded from a file in frames of these widths, and the lines of the console.

    folder: for a copy of the page with a script that reports what it finds.
    """
    copy, frames = folder / "copy.html", folder / "frames.html"
    copy.write_text(page.read_text().replace("</body>", f"{PROBE}</body>"))
    frames.write_text(FRAMES + "".join(FRAME.format(page=copy.as_uri(), width=width) for width in widths))
    done = _run("--virtual-time-budget=10000", "--window-size=1400,1000", "--dump-dom", frames.as_uri())
    found = re.search(r'<pre id="found">(.+?)</pre>', done.stdout, re.DOTALL)
    assert found, done.stderr
    loaded = [Loaded(**one) for one in json.loads(html.unescape(found[1]))]
    return loaded, [line for line in done.stderr.splitlines() if "CONSOLE" in line]


def print_to_pdf(page: Path, target: Path) -> bytes:
    """The page as printed."""
    _run(f"--print-to-pdf={target}", "--no-pdf-header-footer", page.as_uri())
    return target.read_bytes()


def _run(*arguments: str) -> subprocess.CompletedProcess[str]:
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        command = [find_browser(), *OPTIONS, f"--user-data-dir={profile}", *arguments]
        return subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=True)
