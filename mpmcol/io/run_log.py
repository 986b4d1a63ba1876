"""run.log: the messages and the progress of a run as lines with the time of day, appended when it resumes."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from logging.handlers import MemoryHandler
from pathlib import Path

from mpmcol.errors import MpmcolError
from mpmcol.io.atomic import cannot_write
from mpmcol.io.names import LOG_FILE
from mpmcol.units import duration_text

LINE = logging.Formatter("%(asctime)s %(levelname)-7s %(message)s", "%Y-%m-%d %H:%M:%S")
MOST_EARLY_LINES = 1000  # before the folder is ready


class TimeLeft:
    """Remaining time of a stage, from the speed since it started, or resumed: what was done before took other time.

    fraction: of the stage that is done at the start.
    """

    def __init__(self, fraction: float) -> None:
        self._fraction, self._started = fraction, time.monotonic()

    def text(self, fraction: float) -> str:
        """The remaining time when `fraction` is done, in words; "" if nothing was done since the start."""
        done = fraction - self._fraction
        if done <= 0.0:
            return ""
        return f"about {duration_text((time.monotonic() - self._started) * (1.0 - fraction) / done)} left"


class ProgressLines:
    """Reports progress as text: one line for each stage that starts, and one for each ten per cent of it."""

    def __init__(self, write: Callable[[str], object]) -> None:
        self._write = write
        self._stage, self._tenths = "", 0
        self._left = TimeLeft(0.0)

    def __call__(self, stage: str, fraction: float) -> None:
        """Receive the fraction of a stage that is done."""
        tenths = int(10.0 * fraction)
        if stage != self._stage:
            if not self._stage.startswith(f"{stage}:"):  # "equilibrate: preparing kernels" has announced "equilibrate"
                self._write(stage)
            self._stage, self._tenths, self._left = stage, tenths, TimeLeft(fraction)
        elif tenths > self._tenths and fraction < 1.0:  # the end of a stage has a message of its own
            self._tenths = tenths
            self._write(", ".join(filter(None, (f"{stage} {10 * tenths} %", self._left.text(fraction)))))


class _FileHandler(logging.FileHandler):
    """A log on a disk that fails must not end the run, which reports the failure of its own files."""

    def handleError(self, record: logging.LogRecord) -> None:
        """Omit the line."""

    def close(self) -> None:
        """Close the file, also if its last lines cannot be written."""
        with suppress(OSError):
            super().close()


class RunLog:
    """The log of one run; lines that precede `open` are kept until then."""

    def __init__(self) -> None:
        self._logger = logging.Logger("mpmcol.run", logging.INFO)  # unregistered: runs in two threads have one each
        self._lines = MemoryHandler(MOST_EARLY_LINES, logging.CRITICAL)
        self._logger.addHandler(self._lines)
        self.progress = ProgressLines(self._logger.info)

    def open(self, folder: Path) -> None:
        """Append to the log in a folder from now on. Raises OutputError."""
        path = folder / LOG_FILE
        try:
            file = _FileHandler(path, encoding="utf-8", errors="backslashreplace")
        except OSError as error:
            raise cannot_write(path, error) from error
        file.setFormatter(LINE)
        self._lines.setTarget(file)
        self._lines.flush()
        self._lines.close()
        self._logger.handlers[:] = [file]

    def message(self, line: str) -> None:
        """Log a message for the user; those that begin with "note:" are warnings."""
        text = line.removeprefix("note: ")
        self._logger.log(logging.INFO if text == line else logging.WARNING, text)

    def error(self, text: str) -> None:
        """Log why the run ended."""
        self._logger.error(text)

    def close(self) -> None:
        """Close the file."""
        for handler in self._logger.handlers:
            handler.close()


@contextmanager
def run_log() -> Iterator[RunLog]:
    """A log for the context, which ends with the error that leaves the context."""
    log = RunLog()
    try:
        yield log
    except MpmcolError as error:
        log.error(str(error))
        raise
    except KeyboardInterrupt:
        log.error("aborted")
        raise
    finally:
        log.close()
