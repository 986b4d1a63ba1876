"""Whatever is damaged in the folder of a run, `verify` names it, and every command ends with words and a known code."""

from __future__ import annotations

import random
import shutil
import time
from pathlib import Path

from mpmcol.io.results import Results
from tests.soak.writes import BEGINNINGS, CASE, undisturbed
from tests.support.cli import invoke, set_options
from tests.support.runs import assert_equal_runs

COUNT = 10_000
DRAW = 60
READERS = (
    ["status"],
    ["status", "--json"],
    ["measure"],
    ["measure", "--json"],
    ["measure", "--csv", "--snapshot", "1"],
)
PLOTTED, RUN = 100, 25  # one in so many is charted, or run again, which takes longer
CODES = (0, 2, 5)
HANG = 1.0  # s of this process


def trial(seed: int, folder: Path) -> str | None:
    """Damage one file in one way, and give commands."""
    draw, run = random.Random(seed), folder / "run"
    if seed % 2:
        shutil.copytree(undisturbed(), run)
    else:
        BEGINNINGS["stopped"](run)
    path = draw.choice(sorted(path for path in run.rglob("*") if path.is_file() and path.name != ".lock"))
    how, name = damage(draw, path), path.relative_to(run).as_posix()
    code, said = command("verify", run)
    if code != 5 or f"  {name}: " not in said:
        return f"verify did not find {name} {how}: exit code {code}, {said}"
    for words in commands(seed, draw, run):
        started = time.process_time()
        code, said = command(*words)
        if code not in CODES or "error of its own" in said or "Traceback" in said or (code and not said.strip()):
            return f"{name} {how}: {words[0]} ended with exit code {code}, {said}"
        if words[0] not in ("run", "plot") and time.process_time() - started > HANG:
            return f"{name} {how}: {words[0]} took {time.process_time() - started:.1f} s"
        if words[0] == "run" and code == 0 and (wrong := differs(run)):
            return f"{name} {how}: it was run again and ended otherwise: {wrong}"
    return None


def damage(draw: random.Random, path: Path) -> str:
    """Change a file; returns how."""
    content = path.read_bytes()
    place, size = draw.randrange(len(content)), draw.choice((1, 1, 1, 8, 512))
    how = draw.choice(("flipped", "cut short", "overwritten", "zeroed", "emptied", "lengthened"))
    noise = draw.randbytes(size) if how == "overwritten" else bytes(size)
    changed = {
        "flipped": content[:place] + bytes([content[place] ^ 1 << draw.randrange(8)]) + content[place + 1 :],
        "cut short": content[:place],
        "overwritten": content[:place] + noise + content[place + size :],
        "zeroed": content[:place] + noise + content[place + size :],
        "emptied": b"",
        "lengthened": content + draw.randbytes(size),
    }[how]
    path.write_bytes(changed if changed != content else content[:-1])
    return f"{how} at {place}"


def commands(seed: int, draw: random.Random, run: Path) -> list[list[str | Path]]:
    """What a user may do with the folder."""
    source, values = CASE
    first, *more = draw.choice(READERS)
    chosen: list[list[str | Path]] = [[first, run, *more], ["check", run / "case.resolved.toml"]]
    if seed % PLOTTED == 0:
        chosen.append(["plot", run])
    if seed % RUN == 0 or seed % RUN == 1:
        chosen.append(["run", source, *set_options(values), "--out", run])
    return chosen


def command(*words: str | Path) -> tuple[int, str]:
    """Exit code, and what is said."""
    done = invoke(*words)
    return done.exit_code, done.output


def differs(run: Path) -> str | None:
    """How a run that was completed differs from the one that nothing happened to."""
    try:
        assert_equal_runs(undisturbed(), run)
    except AssertionError as difference:
        return str(difference)
    return None if Results(run).status == "done" else "it is not done"
