"""Where results come from: case files, versions, and how the cases of several runs differ."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from mpmcol.case.values import leaf_values
from mpmcol.io.atomic import read_bytes
from mpmcol.io.names import CASE_FILE, GIVEN_CASE_FILE
from mpmcol.io.results import Results
from mpmcol.report.model import Table
from mpmcol.sweep.table import unit_of

ABSENT = "-"  # a key that a case does not have, or without a value


def case_files(results: Results) -> list[tuple[str, str]]:
    """Name and text of the case with all defaults, and before it of the case as given, if it is kept and differs."""
    paths = [path for name in (GIVEN_CASE_FILE, CASE_FILE) if (path := results.folder / name).is_file()]
    texts = [(path.name, read_bytes(path).decode(errors="replace")) for path in paths]
    same = len({_without_comments(text) for _, text in texts}) == 1
    return texts[-1:] if same else texts


def case_differences(runs: Sequence[Results], names: Sequence[str]) -> Table:
    """The keys whose values differ between the runs, or that only some of the cases have."""
    values = [leaf_values(results.case) for results in runs]
    keys = dict.fromkeys(key for one in values for key in one if key != "title")
    texts = {key: [_shown(one.get(key)) for one in values] for key in keys}
    rows = [(with_unit(key), *cells) for key, cells in texts.items() if len(set(cells)) > 1]
    return Table(("Key", *names), rows or [("none", *("" for _ in names))])


def _without_comments(text: str) -> str:
    return "\n".join(line for line in text.splitlines() if line and not line.startswith("#"))


def with_unit(key: str) -> str:
    """A key of the case, with the unit of its values."""
    unit = unit_of(key)
    return key if unit == "1" else f"{key} ({unit})"


def _shown(value: Any) -> str:
    if value is None:
        return ABSENT
    return f"{value:.10g}" if isinstance(value, float) else str(value)


def version_table(runs: Sequence[Results], names: Sequence[str]) -> Table:
    """Versions of program and packages, and the digests that identify case and result."""
    summaries = [results.summary for results in runs]
    packages = dict.fromkeys(name for summary in summaries for name in summary["versions"])
    rows = [(name, *(summary["versions"].get(name, "") for summary in summaries)) for name in packages]
    digests = {"case_hash": "Digest of the case", "state_sha256": "Digest of the final state (SHA-256)"}
    rows += [(text, *(str(summary.get(key, "")) for summary in summaries)) for key, text in digests.items()]
    return Table(("Item", *names), rows, texts=1 + len(names))
