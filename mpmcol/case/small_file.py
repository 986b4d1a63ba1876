"""Reading of files that a user gives, which may be devices or links to anything."""

from __future__ import annotations

from pathlib import Path


def read_small(path: Path, limit: int, kind: str) -> bytes:
    """Content of a file of at most `limit` bytes, the limit of `kind` in the message.

    Raises OSError, or ValueError if the file is larger; no more than that is read.
    """
    with path.open("rb") as file:
        content = file.read(limit + 1)
    if len(content) > limit:
        raise ValueError(f"larger than {limit // 1000:,} kB, the limit of {kind}")
    return content
