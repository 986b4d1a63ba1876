"""Which snapshots a run has, and the choice of one of them."""

from __future__ import annotations

from pathlib import Path

from mpmcol.errors import OutputError, UsageError
from mpmcol.io.checksums import listed_checksums
from mpmcol.io.names import SNAPSHOT_FOLDER
from mpmcol.io.snapshot import RESTORE, list_snapshots


def run_snapshots(folder: Path) -> list[Path]:
    """The snapshot files of a run in the order of writing, with missing ones that SHA256SUMS lists.

    Thus the last one is the state at the end of the run, and a removed file does not change the index of the others.
    """
    listed = (folder / name for name in listed_checksums(folder) if name.startswith(f"{SNAPSHOT_FOLDER}/"))
    numbered = (path for path in listed if path.stem.isdecimal())
    return sorted({*list_snapshots(folder), *numbered}, key=lambda path: int(path.stem))


def find_snapshot(folder: Path, index: int) -> Path:
    """The snapshot of a run with an index from 0; negative ones count from the end.

    Raises UsageError if there is none with this index, OutputError if it is missing, or if there are no snapshots.
    """
    paths = run_snapshots(folder)
    if not paths:
        raise OutputError(
            f"{folder}: no snapshots ({SNAPSHOT_FOLDER}/*.vtkhdf); give the folder of a run, or run the case again"
        )
    if not -len(paths) <= index < len(paths):
        raise UsageError(f"{folder}: there is no snapshot {index}; expected 0 to {len(paths) - 1}, or -1 for the last")
    path = paths[index]
    if not path.exists():
        raise OutputError(f"{path}: snapshot {index % len(paths)} is missing; {RESTORE}")
    return path
