"""`--engine commands`: the runs as shell commands and as a Slurm array job."""

from __future__ import annotations

import os
import shlex
from collections.abc import Sequence
from math import ceil
from pathlib import Path

from mpmcol.io.atomic import atomic_write
from mpmcol.setup.memory import memory_bytes
from mpmcol.sweep.runs import PlannedRun, write_case
from mpmcol.sweep.scheduling import PROCESS_BYTES
from mpmcol.sweep.task import run_command

COMMANDS_FILE, SLURM_FILE = "commands.sh", "slurm.sh"

SLURM = """\
#!/bin/bash
# One task for each line of commands.sh; afterwards the same `mpmcol sweep` command writes table and charts.
#SBATCH --job-name={name}
#SBATCH --array=1-{count}
#SBATCH --cpus-per-task={threads}
#SBATCH --mem={megabytes}M
#SBATCH --output={log}
#SBATCH --requeue
eval "$(sed -n "${{SLURM_ARRAY_TASK_ID}}p" {quoted})"
"""


def write_commands(runs: Sequence[PlannedRun], threads: int, out: Path) -> list[str]:
    """Write the cases of the runs, commands.sh and slurm.sh; return the shell commands, largest run first.

    The commands contain absolute paths of the interpreter and of the resolved cases, so that they work from any folder
    and later edits of the case file have no effect on them.
    """
    ordered = sorted(runs, key=lambda run: run.cost, reverse=True)
    for run in ordered:
        write_case(run)
    lines = [shlex.join(run_command(run.folder.resolve(), threads)) for run in ordered]
    commands = out.resolve() / COMMANDS_FILE
    atomic_write(commands, os.fsencode("".join(line + "\n" for line in lines)))
    script = SLURM.format(
        quoted=shlex.quote(str(commands)),
        name=shlex.quote(f"mpmcol-{out.name}"),
        count=len(lines),
        threads=threads,
        megabytes=ceil(max(memory_bytes(run.discretization) + PROCESS_BYTES for run in ordered) / 1e6),
        log=shlex.quote(str(out.resolve()).replace("%", "%%") + "/slurm-%a.log"),  # % begins a pattern
    )
    atomic_write(out.resolve() / SLURM_FILE, os.fsencode(script))
    return lines
