"""SHA256SUMS: the SHA-256 of all files of a run, in the format of `sha256sum --check`."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path

from mpmcol.errors import OutputError
from mpmcol.io.atomic import atomic_write
from mpmcol.io.names import CHECKSUM_FILE


def checksum_of(path: Path) -> str:
    """SHA-256 of a file in hexadecimal. Raises OutputError if the file cannot be read."""
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise OutputError(f"{path}: cannot be read: {error.strerror}; check the disk and the folder") from error


def has_checksum(path: Path, checksum: str) -> bool:
    """Whether a file exists, is readable, and has this SHA-256."""
    try:
        return checksum_of(path) == checksum
    except OutputError:
        return False


def write_checksums(folder: Path, checksums: Mapping[str, str]) -> None:
    """Write the checksums of files, given by their path relative to the folder. Raises OutputError."""
    atomic_write(folder / CHECKSUM_FILE, _text(checksums))


def read_checksums(folder: Path) -> dict[str, str]:
    """Read SHA256SUMS. Raises FileNotFoundError if it is missing, ValueError if any byte of it was changed."""
    content = (folder / CHECKSUM_FILE).read_bytes()
    lines = [line for line in content.decode(errors="replace").splitlines() if not line.startswith("#")]
    checksums = {name: checksum for checksum, _, name in (line.partition("  ") for line in lines)}
    if _text(checksums) != content:
        raise ValueError("the checksum in its last line is missing or does not match")
    return checksums


def listed_checksums(folder: Path) -> dict[str, str]:
    """As `read_checksums`; empty if there is no list, as of a run that has not ended, or if the list is damaged."""
    try:
        return read_checksums(folder)
    except (OSError, ValueError):
        return {}


def _text(checksums: Mapping[str, str]) -> bytes:
    """The list, closed by a comment line with its own checksum: a damaged list is distinguished from a damaged file."""
    lines = "".join(f"{checksum}  {name}\n" for name, checksum in sorted(checksums.items()))
    return f"{lines}# {hashlib.sha256(lines.encode()).hexdigest()}  the lines above\n".encode()
