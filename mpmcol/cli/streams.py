"""Output to terminals, files and pipes that may have no room, no reader, or another encoding."""

from __future__ import annotations

import errno
import io
import os
import sys
from contextlib import suppress

import click

READER_GONE = 141  # exit code: what shells report for a command that ends because the reader of its pipe has ended
FAILURES = (errno.ENOSPC, errno.EDQUOT, errno.EIO)  # possible errors of a write to a stream
# A write to a closed pipe is refused with another error in Windows.
CLOSED_PIPE = (errno.EPIPE, errno.EINVAL) if sys.platform == "win32" else (errno.EPIPE,)


def accept_any_text() -> None:
    """Write characters that the encoding of a console lacks as escapes; file names may have any encoding."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def report(message: str) -> None:
    """Print a line on stderr if that is possible."""
    with suppress(OSError):  # there is no other place; the exit code remains
        click.echo(message, err=True)


def has_no_reader(error: OSError) -> bool:
    """Whether a write failed because the reader of the pipe has ended."""
    return error.errno in CLOSED_PIPE and error.filename is None


def discard_unwritten() -> None:
    """Discard what a stream could not write; Python would try it again at its end, and fail with another exit code."""
    for stream in filter(None, (sys.stdout, sys.stderr)):
        try:
            stream.flush()
        except OSError:
            nothing = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nothing, stream.fileno())
            os.close(nothing)
