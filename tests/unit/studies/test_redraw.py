"""The script that draws charts of the paper's figures again from their tables."""

from __future__ import annotations

import csv
import shutil
import subprocess
import sys
from pathlib import Path

SCRIPT = Path(__file__).parents[3] / "scripts" / "paper" / "redraw.py"


def test_every_chart_with_a_table_is_drawn(tmp_path: Path) -> None:
    for name in ("fig5", "fig6", "fig8"):
        shutil.copy(SCRIPT.with_name(f"{name}.csv"), tmp_path)
    done = subprocess.run([sys.executable, SCRIPT, tmp_path], capture_output=True, text=True, check=True)
    expected = {"fig5.png", "fig6.png", "fig6-beta.png", "fig8-zeta.png", "fig8-beta.png"}
    assert {Path(line).name for line in done.stdout.splitlines()} == expected
    assert all((tmp_path / name).stat().st_size > 10_000 for name in expected)


def test_the_shipped_tables_state_which_runs_came_to_rest() -> None:
    for path in (*SCRIPT.parent.rglob("fig6.csv"), *SCRIPT.parent.rglob("fig8.csv")):
        with path.open(newline="") as file:
            assert {row["at_rest"] for row in csv.DictReader(file)} <= {"true", "false"}, path
