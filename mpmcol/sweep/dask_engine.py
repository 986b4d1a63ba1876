"""Sweeps on a dask.distributed cluster whose workers share a file system with this machine.

Each run is a child process of a worker, so that the worker's heartbeat continues. A worker executes as many runs at a
time as it has threads: `dask worker ADDRESS --nthreads 4` for four.
"""

from __future__ import annotations

import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from mpmcol.errors import OutputError, UsageError
from mpmcol.io.atomic import atomic_write, remove
from mpmcol.sweep.engine import Pool
from mpmcol.sweep.task import RETRIES
from mpmcol.sweep.worker import CONTINUE

CONNECT_SECONDS = 10


@dataclass(frozen=True)
class FileStopRequest:
    """A stop request for tasks on other machines: a file that contains its level."""

    path: Path

    def __call__(self) -> int:
        """The level in the file; CONTINUE while it does not exist."""
        try:
            return int(self.path.read_text("utf-8"))
        except (OSError, ValueError):
            return CONTINUE

    def set_level(self, level: int) -> None:
        """Write the file, or remove it for CONTINUE."""
        if level == CONTINUE:
            remove(self.path)
        else:
            atomic_write(self.path, str(level).encode())


@contextmanager
def dask_pool(scheduler: str, out: Path) -> Iterator[Pool]:
    """Workers of the cluster with a scheduler at an address such as tcp://10.0.0.1:8786, for a sweep in `out`.

    Raises:
        UsageError: dask.distributed is not installed, or the address is invalid.
        OutputError: no scheduler answers.
    """
    try:
        from distributed import Client
    except ImportError:
        raise UsageError("--engine dask requires dask.distributed: pip install 'mpmcol[dask]'") from None
    try:
        client = Client(scheduler, timeout=CONNECT_SECONDS, set_as_default=False)
    except (OSError, TimeoutError) as error:
        raise OutputError(
            f"no dask scheduler answers at {scheduler} ({error}); start one with `dask scheduler`"
        ) from None
    except ValueError as error:
        raise UsageError(f"--scheduler {scheduler}: {error}; expected an address such as tcp://10.0.0.1:8786") from None
    stop = FileStopRequest(out.resolve() / f".stop-{uuid.uuid4().hex}")
    with client:
        executor = client.get_executor(pure=False, retries=RETRIES)
        slots = max(sum(client.nthreads().values()), 1)  # an adaptive cluster starts without workers
        yield Pool(executor, slots, stop, stop.set_level)
