"""Whatever file of a run is damaged, `verify` names it, and every command ends with a message and a documented code."""

from __future__ import annotations

import random
import shutil
import time
from pathlib import Path

from mpmcol.io.results import Results
from tests.soak.trials.power_loss import CASE, STARTS, reference_run
from tests.support.cli import invoke, set_options
from tests.support.runs import assert_equal_runs

COUNT = 10_000
SMALL_COUNT = 60
READERS = (
    ["status"],
    ["status", "--json"],
    ["measure"],
    ["measure", "--json"],
    ["measure", "--csv", "--snapshot", "1"],
)
PLOT_EVERY, RUN_EVERY = 100, 25  # trials; plotting and running take longer
CODES = (0, 2, 5)
TIME_LIMIT = 1.0  # s of CPU time


def trial(seed: int, folder: Path) -> str | None:
    """Damage one file in one way, and give commands."""
    draw, run = random.Random(seed), folder / "run"
    if seed % 2:
        shutil.copytree(reference_run(), run)
    else:
        STARTS["stopped"](run)
    path = draw.choice(
        sorted(path for path in run.rglob("*") if path.is_file() and path.name not in (".lock", "run.log"))
    )
    kind, name = damage(draw, path), path.relative_to(run).as_posix()
    code, output = command("verify", run)
    if code != 5 or f"  {name}: " not in output:
        return f"verify did not find {name} {kind}: exit code {code}, {output}"
    for arguments in commands(seed, draw, run):
        started = time.process_time()
        code, output = command(*arguments)
        seconds = time.process_time() - started
        is_crash = "internal error" in output or "Traceback" in output or (code and not output.strip())
        if code not in CODES or is_crash:
            return f"{name} {kind}: {arguments[0]} ended with exit code {code}, {output}"
        if arguments[0] not in ("run", "plot") and seconds > TIME_LIMIT:
            return f"{name} {kind}: {arguments[0]} took {seconds:.1f} s"
        if arguments[0] == "run" and code == 0 and (failure := difference(run)):
            return f"{name} {kind}: the run was repeated with another result: {failure}"
    return None


def damage(draw: random.Random, path: Path) -> str:
    """Change a file; return how."""
    content = path.read_bytes()
    position, size = draw.randrange(len(content)), draw.choice((1, 1, 1, 8, 512))
    kind = draw.choice(("flipped", "cut short", "overwritten", "zeroed", "emptied", "lengthened"))
    noise = draw.randbytes(size) if kind == "overwritten" else bytes(size)
    changed = {
        "flipped": content[:position] + bytes([content[position] ^ 1 << draw.randrange(8)]) + content[position + 1 :],
        "cut short": content[:position],
        "overwritten": content[:position] + noise + content[position + size :],
        "zeroed": content[:position] + noise + content[position + size :],
        "emptied": b"",
        "lengthened": content + draw.randbytes(size),
    }[kind]
    path.write_bytes(changed if changed != content else content[:-1])
    return f"{kind} at byte {position}"


def commands(seed: int, draw: random.Random, run: Path) -> list[list[str | Path]]:
    """Commands that a user may give for the folder."""
    source, values = CASE
    first, *more = draw.choice(READERS)
    chosen: list[list[str | Path]] = [[first, run, *more], ["check", run / "case.resolved.toml"]]
    if seed % PLOT_EVERY == 0:
        chosen.append(["plot", run])
    if seed % RUN_EVERY in (0, 1):
        chosen.append(["run", source, *set_options(values), "--out", run])
    return chosen


def command(*arguments: str | Path) -> tuple[int, str]:
    """Exit code and output of a command."""
    done = invoke(*arguments)
    return done.exit_code, done.output


def difference(run: Path) -> str | None:
    """How a completed run differs from the undisturbed one."""
    try:
        assert_equal_runs(reference_run(), run)
    except AssertionError as error:
        return str(error)
    return None if Results(run).status == "done" else "it is not done"
