"""Whole numbers on the command line."""

from __future__ import annotations

import click

JOBS = THREADS = click.IntRange(1, 1024)  # the system would not make far more than there are cores


def whole(text: str) -> int:
    """A whole number of at most twelve digits, 0 for any other text: Python refuses to read thousands of digits."""
    return int(text) if text.isdecimal() and len(text) <= 12 else 0
