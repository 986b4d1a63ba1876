"""The whole state of a run in two files of its folder that are written in turn: one of them is always whole."""

from __future__ import annotations

import hashlib
import io
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from mpmcol.io.atomic import CHECKPOINT_FILES, atomic_write
from mpmcol.io.checksums import has_digest

DIGEST = hashlib.sha256().digest_size  # bytes at the end of a file
FORMAT = 4  # in the meta of a state; the program goes on from no other
META = "meta"  # name of the array that holds what is not an array, as JSON


@dataclass(frozen=True)
class Checkpoint:
    """A state: arrays, and everything else as plain values. The larger `serial` is the later one."""

    serial: int
    meta: Mapping[str, Any]
    arrays: Mapping[str, np.ndarray]


def write_checkpoint(folder: Path, checkpoint: Checkpoint) -> Path:
    """Write a state over the one before the last, whole or not at all; raises OutputError."""
    meta = json.dumps({"serial": checkpoint.serial, **checkpoint.meta}).encode()
    arrays: dict[str, Any] = {META: np.frombuffer(meta, np.uint8), **checkpoint.arrays}
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)
    buffer.write(hashlib.sha256(buffer.getbuffer()).digest())
    path = folder / CHECKPOINT_FILES[checkpoint.serial % len(CHECKPOINT_FILES)]
    atomic_write(path, buffer.getvalue())
    return path


def read_checkpoints(folder: Path) -> tuple[list[Checkpoint], list[str]]:
    """The whole states in a folder, the latest first; and the names of files that are damaged."""
    found, damaged = [], []
    for name in CHECKPOINT_FILES:
        try:
            found.append(_read(folder / name))
        except FileNotFoundError:
            continue
        except (OSError, ValueError, KeyError):
            damaged.append(name)
    return sorted(found, key=lambda one: one.serial, reverse=True), damaged


def lost_snapshots(folder: Path, state: Checkpoint) -> list[str]:
    """Names of the snapshots taken before a state of this FORMAT that are missing or not as they were written."""
    digests: dict[str, str] = state.meta["recorder"]["snapshots"]
    return [name for name, digest in digests.items() if not has_digest(folder / name, digest)]


def _read(path: Path) -> Checkpoint:
    content = path.read_bytes()
    if hashlib.sha256(memoryview(content)[:-DIGEST]).digest() != content[-DIGEST:]:
        raise ValueError("its digest is another")
    with np.load(io.BytesIO(content), allow_pickle=False) as file:
        arrays = {name: file[name] for name in file.files}
    meta = json.loads(arrays.pop(META).tobytes())
    return Checkpoint(meta.pop("serial"), meta, arrays)
