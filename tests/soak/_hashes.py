"""`python -m tests.soak._hashes CASE FOLDER THREADS...`: digest of a run's last state for each number of threads."""

from __future__ import annotations

import json
import sys
from pathlib import Path

from numba import threading_layer

import mpmcol


def hashes(case: str, folder: Path, threads: list[int]) -> dict[str, str]:
    """Number of threads -> digest of the last state; and the layer that carried the threads."""
    found = {}
    for count in threads:
        results = mpmcol.run(mpmcol.load_case(case), folder / f"{count}", threads=count)
        assert results.summary["threads"] == count
        found[str(count)] = results.summary["state_sha256"]
    return {**found, "layer": threading_layer()}


if __name__ == "__main__":
    print(json.dumps(hashes(sys.argv[1], Path(sys.argv[2]), [int(word) for word in sys.argv[3:]])))
