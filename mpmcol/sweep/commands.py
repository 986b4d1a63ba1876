"""`--engine commands`: the points as shell lines and as a Slurm array, for whatever else shall run them."""

from __future__ import annotations

import os
import shlex
from collections.abc import Sequence
from math import ceil
from pathlib import Path

from mpmcol.io.atomic import atomic_write
from mpmcol.setup.memory import memory_bytes
from mpmcol.sweep.runs import PlannedRun, freeze
from mpmcol.sweep.scheduling import BYTES_OF_PROCESS
from mpmcol.sweep.task import run_command

COMMANDS_FILE, SLURM_FILE = "commands.sh", "slurm.sh"

SLURM = """\
#!/bin/bash
# One task for each line of {commands}; afterwards the same `mpmcol sweep` command makes table and charts.
#SBATCH --job-name={name}
#SBATCH --array=1-{count}
#SBATCH --cpus-per-task={threads}
#SBATCH --mem={megabytes}M
#SBATCH --output={out}/slurm-%a.log
#SBATCH --requeue
eval "$(sed -n "${{SLURM_ARRAY_TASK_ID}}p" {quoted})"
"""


def write_commands(points: Sequence[PlannedRun], threads: int, out: Path) -> list[str]:
    """Freeze the cases of the points, write commands.sh and slurm.sh into the folder, and return the shell lines.

    The lines name the interpreter and the folders in full and the resolved cases, so that they can be run from
    anywhere and later edits of the case file change nothing. Largest points first.
    """
    ordered = sorted(points, key=lambda point: point.work, reverse=True)
    for point in ordered:
        freeze(point)
    lines = [shlex.join(run_command(point.folder.resolve(), threads)) for point in ordered]
    commands = out.resolve() / COMMANDS_FILE
    atomic_write(commands, os.fsencode("".join(line + "\n" for line in lines)))
    script = SLURM.format(
        commands=commands,
        quoted=shlex.quote(str(commands)),
        name=f"mpmcol-{out.name}",
        count=len(lines),
        threads=threads,
        megabytes=ceil(max(memory_bytes(point.discretization) + BYTES_OF_PROCESS for point in ordered) / 1e6),
        out=out.resolve(),
    )
    atomic_write(out.resolve() / SLURM_FILE, os.fsencode(script))
    return lines
