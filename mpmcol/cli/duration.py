"""Times on the command line."""

from __future__ import annotations

import re
from typing import Any

import click

SECONDS = {"s": 1.0, "min": 60.0, "h": 3600.0, "d": 86400.0}


class Duration(click.ParamType):
    """A time in s: "90", "90s", "5min", "2h", "1.5d"."""

    name = "time"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Seconds."""
        if isinstance(value, float):
            return value
        match = re.fullmatch(r"(\d++\.?\d*+|\.\d++)\s*+(s|min|h|d|)", value.strip(), re.ASCII)
        if not match or float(match[1]) == 0.0:
            self.fail(f"{value!r}: expected a time such as 90s, 5min, 2h or 1.5d", param, ctx)
        return float(match[1]) * SECONDS[match[2] or "s"]


DURATION = Duration()


def duration(seconds: float) -> str:
    """A time for a person."""
    if seconds < 120.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 7200.0 else f"{seconds / 3600.0:.1f} h"
