"""Names of the files in a results folder."""

from __future__ import annotations

CASE_FILE, RESULT_FILE, HISTORY_FILE = "case.resolved.toml", "result.json", "history.csv"
PRESSURE_FILE = "wall_pressure.csv"  # with output.wall_forces
SNAPSHOT_FOLDER = "snapshots"
INDEX_FILES = ("run.vtkhdf", "run.vtkhdf.series")
CHECKSUM_FILE = "SHA256SUMS"  # of all other files; written immediately before the result
CHECKPOINT_FILES = ("checkpoint-0.npz", "checkpoint-1.npz")  # written alternately
LOCK_FILE = ".lock"
RESUMED_AT = "resumed_at"  # comment in CASE_FILE: time since release at which the run was resumed last, s
# Files that may be in the folder before the run starts: its input case and its log.
GIVEN_CASE_FILE, LOG_FILE = "case.toml", "run.log"
ERROR_BARS_FILE, REPEATS_FOLDER = "error_bars.json", "repeats"  # of `mpmcol run --certify`
ACCURACY_FILE = "accuracy.json"  # of `mpmcol run --accuracy`
ENVIRONMENT_FILE = "environment.json"  # of a study: versions and machine
REPORT_FILE = "report.html"  # of `mpmcol report`
CHART_FILES = (
    "profile.png", "front.png", "energy.png", "profile.svg", "front.svg", "energy.svg", "collapse.gif", "collapse.mp4",
    "topview.png", "snapshot-*.png", "walls.png", "walls.svg",
)  # fmt: skip
# All files of a run, as patterns. The case is last, so that a partly emptied folder is still recognised as a run's.
OWN_FILES = (
    ERROR_BARS_FILE, ACCURACY_FILE, REPORT_FILE, RESULT_FILE, CHECKSUM_FILE, HISTORY_FILE, PRESSURE_FILE, *INDEX_FILES,
    SNAPSHOT_FOLDER, *CHART_FILES, *CHECKPOINT_FILES, CASE_FILE,
)  # fmt: skip
