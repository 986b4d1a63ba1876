"""Two files written alternately, of which one is always valid."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mpmcol.io.checkpoint import Checkpoint, read_checkpoints, write_checkpoint
from mpmcol.io.names import CHECKPOINT_FILES


def checkpoint(serial: int) -> Checkpoint:
    rng = np.random.default_rng(serial)
    arrays = {"rows": rng.standard_normal(50), "ids": np.arange(serial, serial + 7, dtype=np.int32)}
    return Checkpoint(serial, {"stage": "collapse", "time": 0.1 * serial, "rows": [{"a": None}]}, arrays)


def equal(one: Checkpoint, other: Checkpoint) -> bool:
    assert {name: array.dtype for name, array in one.arrays.items()} == {n: a.dtype for n, a in other.arrays.items()}
    same = all(np.array_equal(one.arrays[name], array) for name, array in other.arrays.items())
    return same and (one.serial, one.values) == (other.serial, other.values)


def test_the_newest_is_read_first(tmp_path: Path) -> None:
    assert read_checkpoints(tmp_path) == ([], [])
    for serial in range(5):
        write_checkpoint(tmp_path, checkpoint(serial))
        found, damaged = read_checkpoints(tmp_path)
        assert equal(found[0], checkpoint(serial)) and len(found) == min(serial + 1, 2) and not damaged
    assert sorted(path.name for path in tmp_path.iterdir()) == list(CHECKPOINT_FILES)


@pytest.mark.parametrize("how", ["flip", "truncate", "empty", "garbage"])
def test_if_the_newest_is_damaged_the_previous_one_is_read(how: str, tmp_path: Path) -> None:
    for serial in (6, 7):
        path = write_checkpoint(tmp_path, checkpoint(serial))
    content = bytearray(path.read_bytes())
    for position in range(0, len(content), 97):
        changed = bytearray(content)
        changed[position] ^= 0x10
        path.write_bytes({"flip": changed, "truncate": content[:position], "empty": b"", "garbage": b"x" * 500}[how])
        found, damaged = read_checkpoints(tmp_path)
        assert len(found) == 1 and equal(found[0], checkpoint(6)) and damaged == [path.name]
