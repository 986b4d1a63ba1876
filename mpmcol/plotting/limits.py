"""Choices and limits of images, which the command line states without loading a library for drawing."""

from __future__ import annotations

from mpmcol.errors import UsageError

LEAST_PIXELS, MOST_PIXELS = 200, 8000
COLORS = ("displacement", "velocity", "pressure", "shear", "inertial", "friction")


def require_image(color: str, size: tuple[int, int] | None) -> None:
    """Raise UsageError for a colour or a size (width and height in pixels) that no image can have."""
    if color not in COLORS:
        raise UsageError(f"color = {color!r}: expected one of {', '.join(COLORS)}")
    if size is not None and not (len(size) == 2 and all(LEAST_PIXELS <= pixels <= MOST_PIXELS for pixels in size)):
        raise UsageError(
            f"size = {size!r}: expected width and height in pixels, each {LEAST_PIXELS} to {MOST_PIXELS}, for example "
            "(1280, 720)"
        )
