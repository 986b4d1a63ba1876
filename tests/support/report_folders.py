"""Folders of which reports can be made, changed in ways that a simulation would take long to produce."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

from PIL import Image

from mpmcol.case import case_hash, load_case

STUDY_TEXT = """\
# A study

Some text with <script>alert(1)</script>.

![chart](a%20chart.png)

## Values

| case | zeta |
|---|---|
| channel | 1.5 |
"""


def copy_run(source: Path, target: Path, change: Callable[[dict[str, Any]], object], *edits: tuple[str, str]) -> Path:
    """Copy a run, replace texts in its case as if that had been simulated, and change its result."""
    shutil.copytree(source, target)
    case = target / "case.resolved.toml"
    for old, new in edits:
        assert old in case.read_text()
        case.write_text(case.read_text().replace(old, new))
    result = json.loads((target / "result.json").read_text()) | {"case_hash": case_hash(load_case(case))}
    change(result)
    (target / "result.json").write_text(json.dumps(result))
    return target


def write_study(folder: Path) -> Path:
    """A folder as `mpmcol pareto` leaves it."""
    folder.mkdir()
    (folder / "study.md").write_text(STUDY_TEXT)
    Image.new("RGB", (900, 300), "white").save(folder / "a chart.png")
    (folder / "environment.json").write_text(json.dumps({"mpmcol": "0.1.0+abc", "cores": 2}))
    return folder
