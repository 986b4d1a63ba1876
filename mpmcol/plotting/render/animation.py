"""Animations as GIF and MP4."""

from __future__ import annotations

import io
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PIL import Image

from mpmcol.errors import OutputError, UsageError

FRAME_MS, LAST_FRAME_MS = 120, 1500
RATE = 25  # pictures per second of an MP4; each image is repeated
SAMPLED = 5  # images from which the colours of a GIF are chosen


def gif(images: Sequence[Image.Image]) -> bytes:
    """The images as an endless GIF, with a palette of some of them."""
    sampled = [images[i] for i in np.linspace(0, len(images) - 1, min(SAMPLED, len(images))).astype(int)]
    width, height = images[0].size
    together = Image.new("RGB", (width, height * len(sampled)))
    for i, image in enumerate(sampled):
        together.paste(image, (0, i * height))
    # MAXCOVERAGE, because the colour bar has few pixels but needs all of its colours.
    return gif_with(together.quantize(256, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE), images)


def gif_with(palette: Image.Image, images: Sequence[Image.Image]) -> bytes:
    """The images as an endless GIF with the palette of an image."""
    frames = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images]
    durations = [FRAME_MS] * (len(frames) - 1) + [LAST_FRAME_MS]
    buffer = io.BytesIO()
    frames[0].save(buffer, "GIF", save_all=True, append_images=frames[1:], duration=durations, loop=0)
    return buffer.getvalue()


def mp4(images: Sequence[Image.Image]) -> bytes:
    """The images as an MP4 (H.264), with an odd last row or column repeated, since its sizes must be even.

    Raises OutputError if ffmpeg fails.
    """
    import imageio_ffmpeg

    width, height = images[0].size
    size = width + width % 2, height + height % 2
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "movie.mp4"
        try:
            writer = imageio_ffmpeg.write_frames(
                str(file), size, fps=RATE, quality=8, macro_block_size=2, ffmpeg_log_level="error"
            )
            writer.send(None)
            for i, image in enumerate(images):
                pixels = np.pad(np.asarray(image), ((0, height % 2), (0, width % 2), (0, 0)), mode="edge")
                shown = LAST_FRAME_MS if i == len(images) - 1 else FRAME_MS
                for _ in range(round(shown * RATE / 1000)):
                    writer.send(np.ascontiguousarray(pixels))
            writer.close()
            return file.read_bytes()
        except OSError as error:
            raise OutputError(
                f"ffmpeg could not write the MP4 ({error}); --gif writes an animation without it"
            ) from None


def require_mp4() -> None:
    """Raises UsageError with the remedy if no ffmpeg is installed."""
    try:
        import imageio_ffmpeg

        imageio_ffmpeg.get_ffmpeg_exe()
    except (ImportError, RuntimeError):
        raise UsageError(
            "an MP4 needs imageio-ffmpeg: pip install imageio-ffmpeg, or `mpmcol[movie]`; --gif needs nothing more"
        ) from None
