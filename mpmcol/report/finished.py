"""Finished runs: the only ones that are reported."""

from __future__ import annotations

from pathlib import Path

from mpmcol.errors import OutputError, UsageError
from mpmcol.io.names import RESULT_FILE
from mpmcol.io.results import Results

REQUIRED = {  # keys of result.json; the others may be missing
    "front", "zeta", "spread", "height", "beta", "area_factor", "at_rest", "time_over_tau", "errors", "points",
    "column_points", "spacing_used", "r_i", "base_used", "steps", "dt", "wall_s", "peak_memory_bytes", "threads",
    "versions",
}  # fmt: skip
RESUME = "repeat the `mpmcol run` command to resume it"
REPEAT = "run the case again with --fresh"


def finished_run(folder: Path) -> Results:
    """The results of a finished run.

    Raises UsageError if the run has not finished, OutputError if its result is missing parts or is damaged.
    """
    results = Results(folder)
    if results.status == "unfinished":
        raise _not_finished(folder, f"the run has not ended; wait for it, or {RESUME}")
    if results.status == "stopped":
        raise _not_finished(folder, f"the run was stopped; {RESUME}")
    if results.status == "failed":
        cause = results.summary.get("failure", {}).get("cause", "it diverged")
        raise _not_finished(folder, f"the run failed: {cause}; correct the case and run it again")
    if missing := sorted(REQUIRED - results.summary.keys()):
        raise OutputError(f"{folder / RESULT_FILE} lacks {', '.join(missing)}: an earlier version wrote it; {REPEAT}")
    if not results.snapshots:
        raise OutputError(f"{folder}: the run has no snapshots; {REPEAT}")
    return results


def _not_finished(folder: Path, what: str) -> UsageError:
    return UsageError(f"{folder}: {what}; a report requires a finished run")
