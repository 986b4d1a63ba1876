"""Read charts, tables and texts completely, by the suffix of their names."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import h5py
from PIL import Image, ImageSequence


def read_error(path: Path) -> str:
    """Why a file cannot be read; "" if it can be, or if its suffix is not known."""
    reader = READERS.get(path.suffix)
    try:
        if reader is not None:
            reader(path)
    except Exception as error:  # the libraries raise many types of errors on damaged files
        return f"it cannot be read ({type(error).__name__}: {error})"
    return ""


def _json(path: Path) -> None:
    json.loads(path.read_bytes())


def _table(path: Path) -> None:
    with path.open(encoding="utf-8", newline="") as file:
        lengths = {len(row) for row in csv.reader(file, strict=True)}
    if len(lengths) != 1:
        raise ValueError("rows differ in length")


def _hdf5(path: Path) -> None:
    def read(name: str, item: h5py.Dataset | h5py.Group) -> None:
        if isinstance(item, h5py.Dataset):
            item[()]

    with h5py.File(path, "r", locking=False) as file:
        file.visititems(read)


def _png(path: Path) -> None:
    with Image.open(path) as picture:
        picture.verify()  # checksums of all chunks


def _gif(path: Path) -> None:
    with Image.open(path) as picture:
        for frame in ImageSequence.Iterator(picture):
            frame.load()


READERS: dict[str, Callable[[Path], object]] = {
    ".json": _json, ".csv": _table, ".h5": _hdf5, ".png": _png, ".gif": _gif, ".svg": ElementTree.parse,
    ".md": lambda path: path.read_text("utf-8"), ".txt": lambda path: path.read_text("utf-8"),
}  # fmt: skip
