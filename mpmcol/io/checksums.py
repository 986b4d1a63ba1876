"""SHA256SUMS: the digests of all files of a run, in the form that `sha256sum --check` reads."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path

from mpmcol.errors import OutputError
from mpmcol.io.atomic import DIGEST_FILE, atomic_write


def digest_of(path: Path) -> str:
    """SHA-256 of a file, in hexadecimal. Raises OutputError if it cannot be read."""
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise OutputError(f"{path}: cannot be read: {error.strerror}; check the disk and the folder") from error


def has_digest(path: Path, digest: str) -> bool:
    """Whether a file is there, can be read, and holds what this is the digest of."""
    try:
        return digest_of(path) == digest
    except OutputError:
        return False


def write_digests(folder: Path, digests: Mapping[str, str]) -> None:
    """Write the digests of files, by their names inside the folder. Raises OutputError."""
    atomic_write(folder / DIGEST_FILE, _text(digests))


def read_digests(folder: Path) -> dict[str, str]:
    """What `write_digests` wrote; FileNotFoundError without it, ValueError if a single byte of it is another."""
    content = (folder / DIGEST_FILE).read_bytes()
    lines = [line.split("  ", 1) for line in content.decode().splitlines() if not line.startswith("#")]
    digests = {name: digest for digest, name in lines}
    if _text(digests) != content:
        raise ValueError("the digest in its last line is another")
    return digests


def _text(digests: Mapping[str, str]) -> bytes:
    """The last line, a comment for `sha256sum`, tells a damaged list from a damaged file."""
    lines = "".join(f"{digest}  {name}\n" for name, digest in sorted(digests.items()))
    return f"{lines}# {hashlib.sha256(lines.encode()).hexdigest()}  the lines above\n".encode()
