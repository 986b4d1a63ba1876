"""Checkpoint files: the state of a run in two files of its folder that are written alternately; one is always valid."""

from __future__ import annotations

import hashlib
import io
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from mpmcol.io.atomic import atomic_write
from mpmcol.io.checksums import has_checksum
from mpmcol.io.names import CHECKPOINT_FILES

CHECKSUM_SIZE = hashlib.sha256().digest_size  # bytes at the end of a file
FORMAT = 6  # a run resumes from checkpoints of this format only
VALUES = "meta"  # name of the array that holds the plain values as JSON


@dataclass(frozen=True)
class Checkpoint:
    """A saved state: arrays, and all other values in a form that JSON holds. The newer one has the larger `serial`."""

    serial: int
    values: Mapping[str, Any]
    arrays: Mapping[str, np.ndarray]


def write_checkpoint(folder: Path, checkpoint: Checkpoint) -> Path:
    """Write a checkpoint atomically in place of the older of the two files; return its path. Raises OutputError."""
    values = json.dumps({"serial": checkpoint.serial, **checkpoint.values}).encode()
    arrays: dict[str, Any] = {VALUES: np.frombuffer(values, np.uint8), **checkpoint.arrays}
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)
    buffer.write(hashlib.sha256(buffer.getbuffer()).digest())
    path = folder / CHECKPOINT_FILES[checkpoint.serial % len(CHECKPOINT_FILES)]
    atomic_write(path, buffer.getvalue())
    return path


def read_checkpoints(folder: Path) -> tuple[list[Checkpoint], list[str]]:
    """The valid checkpoints in a folder, the newest first, and the names of damaged files."""
    found, damaged = [], []
    for name in CHECKPOINT_FILES:
        try:
            found.append(_read(folder / name))
        except FileNotFoundError:
            continue
        except (OSError, ValueError, KeyError):
            damaged.append(name)
    return sorted(found, key=lambda checkpoint: checkpoint.serial, reverse=True), damaged


def damaged_snapshots(folder: Path, checkpoint: Checkpoint) -> list[str]:
    """Names of the snapshots written before a checkpoint of this FORMAT that are now missing or changed."""
    checksums: dict[str, str] = checkpoint.values["recorder"]["snapshots"]
    return [name for name, checksum in checksums.items() if not has_checksum(folder / name, checksum)]


def _read(path: Path) -> Checkpoint:
    content = path.read_bytes()
    if hashlib.sha256(memoryview(content)[:-CHECKSUM_SIZE]).digest() != content[-CHECKSUM_SIZE:]:
        raise ValueError("its checksum does not match")
    with np.load(io.BytesIO(content), allow_pickle=False) as file:
        arrays = {name: file[name] for name in file.files}
    values = json.loads(arrays.pop(VALUES).tobytes())
    return Checkpoint(values.pop("serial"), values, arrays)
