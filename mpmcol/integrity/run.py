"""The files of one run: byte for byte by its list of digests, and what is in them where that is not possible."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from shlex import quote
from typing import Any

from mpmcol.integrity.content import case_problem, history_problem, index_problem, result_problem, snapshot_problems
from mpmcol.integrity.finding import Finding, Report
from mpmcol.integrity.readable import unreadable
from mpmcol.io.atomic import temporary_files
from mpmcol.io.checkpoint import FORMAT, damaged_snapshots, read_checkpoints
from mpmcol.io.checksums import has_checksum, read_checksums
from mpmcol.io.names import (
    CASE_FILE,
    CHECKPOINT_FILES,
    CHECKSUM_FILE,
    GIVEN_CASE_FILE,
    HISTORY_FILE,
    INDEX_FILES,
    LOCK_FILE,
    RESULT_FILE,
)
from mpmcol.io.run_status import read_status
from mpmcol.io.snapshot import list_snapshots

Problems = Mapping[str, str]  # name of a file: what is wrong with it
INDEX = INDEX_FILES[0]
FOREIGN = "it is not of this run"


def check_run(folder: Path) -> Report:
    """Check all files of the folder of a run, which need not have ended."""
    files = [path for path in sorted(folder.rglob("*")) if path.is_file() and path.name != LOCK_FILE]
    state = read_status(folder)
    if state.name == "running":
        note = Finding(LOCK_FILE, "a run is writing here", "verify it when it has ended", is_damage=False)
        return Report(folder, state.name, len(files), (note,))
    if (folder / RESULT_FILE).exists():  # it is written last
        digests, problems = _changed(folder)
    else:
        digests, problems = {}, _lost(folder)
    problems |= _content(folder, digests, problems, state.result)
    found = [Finding(name, what, _remedy(folder, name, problems)) for name, what in sorted(problems.items())]
    return Report(folder, state.name, len(files), (*found, *_states(folder), *_charts(folder), *_rests(folder)))


def _changed(folder: Path) -> tuple[dict[str, str], dict[str, str]]:
    """The digests of a run that has ended, and the files that are not as it wrote them."""
    try:
        digests = read_checksums(folder)
    except FileNotFoundError:
        return {}, {CHECKSUM_FILE: "it is missing, and without it a changed byte cannot be found"}
    except (OSError, ValueError) as error:
        return {}, {CHECKSUM_FILE: f"it is damaged ({error}), and without it a changed byte cannot be found"}
    problems = {}
    for name, digest in digests.items():
        if not (folder / name).exists():
            problems[name] = "it is missing"
        elif not has_checksum(folder / name, digest):
            problems[name] = "its bytes are not those that the run wrote"
    for path in list_snapshots(folder):
        if (name := path.relative_to(folder).as_posix()) not in digests:
            problems[name] = FOREIGN
    return digests, problems


def _lost(folder: Path) -> dict[str, str]:
    """Snapshots that the states of an unfinished run need and that are not as they were."""
    known = [state for state in read_checkpoints(folder)[0] if state.values.get("format") == FORMAT]
    what = "it is missing, or its bytes are not those that the run wrote"
    return {name: what for state in known for name in damaged_snapshots(folder, state)}


def _content(folder: Path, digests: Problems, known: Problems, result: dict[str, Any] | None) -> dict[str, str]:
    """What is wrong inside of the files that are not known to be damaged: on those HDF5 may end the whole process.

    A case whose digest is right is left alone, since its words may be those of another version.
    """
    problems: dict[str, str] = {}
    if RESULT_FILE in known or not isinstance(result, dict):
        result = None
    for name, problem in (
        (RESULT_FILE, result_problem), (HISTORY_FILE, history_problem), (CASE_FILE, case_problem),
        (GIVEN_CASE_FILE, case_problem),
    ):  # fmt: skip
        is_vouched = name in known or (problem is case_problem and name in digests)
        if not is_vouched and (folder / name).exists() and (what := problem(folder / name, result)):
            problems[name] = what
    problems |= snapshot_problems(folder, known, result)
    if not any(name.startswith(("snapshots/", INDEX)) for name in {**known, **problems}):
        broken = index_problem(folder, is_complete=result is not None)
        problems |= {INDEX: broken} if broken else {}
    return problems


def _remedy(folder: Path, name: str, problems: Problems) -> str:
    """How to get a file back at the least cost."""
    if name.startswith(INDEX) and not any(other.startswith("snapshots/") for other in problems):
        call = (
            f"from pathlib import Path; from mpmcol.io.snapshot import write_index; write_index(Path({str(folder)!r}))"
        )
        return f"only viewers read it, and the snapshots are whole: python -c {quote(call)} writes it again"
    if problems[name] == FOREIGN:
        return "delete it"
    sources = [folder / case for case in (CASE_FILE, GIVEN_CASE_FILE) if case not in problems]
    source = next((path for path in sources if path.exists()), None)
    if source is None:
        return "copy it back, or run the case again with --fresh"
    return f"copy it back, or run it again: mpmcol run {quote(str(source))} --out {quote(str(folder))} --fresh"


def _states(folder: Path) -> Iterator[Finding]:
    """States are kept with digests of their own."""
    whole, damaged = read_checkpoints(folder)
    left = "the same command goes on from the other one" if whole else "the same command begins anew"
    for name in damaged:
        yield Finding(name, "this state is damaged", f"{left}, and writes it again")
    if not whole and not damaged and not (folder / RESULT_FILE).exists():
        yield Finding(CHECKPOINT_FILES[0], "the run has kept no state yet", "the same command begins anew", False)


def _charts(folder: Path) -> Iterator[Finding]:
    for path in sorted(folder.iterdir()):
        if path.suffix in (".png", ".gif", ".svg") and (what := unreadable(path)):
            yield Finding(path.name, what, "delete it, and plot or render again")


def _rests(folder: Path) -> Iterator[Finding]:
    for path in temporary_files(folder):
        what, remedy = "a process was killed while it wrote this", "delete it; a run here removes it, too"
        yield Finding(path.relative_to(folder).as_posix(), what, remedy, is_damage=False)
