"""Sweeps on an existing dask.distributed cluster whose workers share a file system with this machine.

A task is a process on a worker, so that the worker's heartbeat goes on while it computes. A worker runs as many points
at a time as it has threads: `dask worker ADDRESS --nthreads 4` for four.
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

CONNECT_SECONDS = 10


@dataclass(frozen=True)
class FileHalt:
    """Tells tasks on other machines to halt, by a file that holds the urgency."""

    path: Path

    def __call__(self) -> int:
        """What the file says; 0 while it is not there."""
        try:
            return int(self.path.read_text())
        except (OSError, ValueError):
            return 0

    def stop(self, urgent: int) -> None:
        """Write the file, or remove it at 0."""
        if urgent:
            atomic_write(self.path, str(urgent).encode())
        else:
            remove(self.path)


@contextmanager
def dask_pool(scheduler: str, out: Path) -> Iterator[Pool]:
    """The cluster of a scheduler, such as tcp://10.0.0.1:8786, for a sweep in the folder `out`.

    Raises:
        UsageError: dask.distributed is not installed, or the address is none.
        OutputError: no scheduler answers.
    """
    try:
        from distributed import Client
    except ImportError:
        raise UsageError("--engine dask needs dask.distributed: pip install 'mpmcol[dask]'") from None
    try:
        client = Client(scheduler, timeout=CONNECT_SECONDS, set_as_default=False)
    except (OSError, TimeoutError) as error:
        raise OutputError(
            f"no dask scheduler answers at {scheduler} ({error}); start one with `dask scheduler`"
        ) from None
    except ValueError as error:
        raise UsageError(f"--scheduler {scheduler}: {error}; expected an address such as tcp://10.0.0.1:8786") from None
    halt = FileHalt(out.resolve() / f".halt-{uuid.uuid4().hex}")
    with client:
        executor = client.get_executor(pure=False, retries=RETRIES)
        slots = max(sum(client.nthreads().values()), 1)  # an adaptive cluster starts without workers
        yield Pool(executor, slots, halt, halt.stop)
