"""`python -m tests.soak.state_digests CASE FOLDER THREADS...`: digest of the final state for each number of threads."""

from __future__ import annotations

import json
import sys
from pathlib import Path

from numba import threading_layer

import mpmcol


def state_digests(case: str, folder: Path, threads: list[int]) -> dict[str, str]:
    """Digest of the final state for each number of threads, and the threading layer under "layer"."""
    found = {}
    for count in threads:
        results = mpmcol.run(mpmcol.load_case(case), folder / f"{count}", threads=count)
        assert results.summary["threads"] == count
        found[str(count)] = results.summary["state_sha256"]
    return {**found, "layer": threading_layer()}


if __name__ == "__main__":
    print(json.dumps(state_digests(sys.argv[1], Path(sys.argv[2]), [int(count) for count in sys.argv[3:]])))
