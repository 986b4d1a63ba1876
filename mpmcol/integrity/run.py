"""Check the files of one run: every byte by SHA256SUMS, and the content where there is no checksum."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from shlex import quote
from typing import Any

from mpmcol.integrity.content import case_problem, history_problem, index_problem, result_problem, snapshot_problems
from mpmcol.integrity.readable import read_error
from mpmcol.integrity.report import Finding, FolderReport
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
    LOG_FILE,
    RESULT_FILE,
    SNAPSHOT_FOLDER,
)
from mpmcol.io.run_status import read_status
from mpmcol.io.snapshot import list_snapshots

Problems = Mapping[str, str]  # file name: problem
UNCHECKED = (LOCK_FILE, LOG_FILE)  # the log also has the end of the run, which follows the checksums
INDEX = INDEX_FILES[0]
FOREIGN = "it does not belong to this run"
CHANGED = "its checksum does not match"


def check_run(folder: Path) -> FolderReport:
    """Check all files of a run, which need not have ended."""
    files = [path for path in folder.rglob("*") if path.is_file() and path.name not in UNCHECKED]
    status = read_status(folder)
    if status.name == "running":
        note = Finding(LOCK_FILE, "a run is writing here", "verify it after it has ended", is_damage=False)
        return FolderReport(folder, status.name, len(files), (note,))
    is_lost = _has_lost_result(folder)
    if (folder / RESULT_FILE).exists() or is_lost:  # it is written last
        checksums, problems = _changed_files(folder)
    else:
        checksums, problems = {}, _changed_snapshots(folder)
    problems |= _content_problems(folder, checksums, problems, status.result)
    findings = [Finding(name, what, _remedy(folder, name, problems)) for name, what in sorted(problems.items())]
    findings += [] if is_lost else _checkpoints(folder)
    findings += [*_charts(folder), *_temporary_files(folder)]
    return FolderReport(folder, "damaged" if is_lost else status.name, len(files), tuple(findings))


def _has_lost_result(folder: Path) -> bool:
    """Whether a run has ended, since it has checksums, and its result was removed.

    A process that was killed may leave checksums without a result as well: between the writing of the two, or while a
    new run removes them. It also leaves checkpoints, or has removed the log.
    """
    exists = {name: (folder / name).exists() for name in (CHECKSUM_FILE, LOG_FILE, RESULT_FILE, *CHECKPOINT_FILES)}
    return {name for name, found in exists.items() if found} == {CHECKSUM_FILE, LOG_FILE}


def _changed_files(folder: Path) -> tuple[dict[str, str], dict[str, str]]:
    """The checksums of a run that has ended, and the problems of files that do not match them."""
    try:
        checksums = read_checksums(folder)
    except FileNotFoundError:
        return {}, {CHECKSUM_FILE: "it is missing; without it changed bytes cannot be found"}
    except (OSError, ValueError) as error:
        return {}, {CHECKSUM_FILE: f"it is damaged ({error}); without it changed bytes cannot be found"}
    problems = {}
    for name, checksum in checksums.items():
        if not (folder / name).exists():
            problems[name] = "it is missing"
        elif not has_checksum(folder / name, checksum):
            problems[name] = CHANGED
    for path in list_snapshots(folder):
        if (name := path.relative_to(folder).as_posix()) not in checksums:
            problems[name] = FOREIGN
    return checksums, problems


def _changed_snapshots(folder: Path) -> dict[str, str]:
    """Problems of snapshots that the checkpoints of an unfinished run refer to."""
    checkpoints = [known for known in read_checkpoints(folder)[0] if known.values.get("format") == FORMAT]
    what = f"it is missing, or {CHANGED}"
    return {name: what for checkpoint in checkpoints for name in damaged_snapshots(folder, checkpoint)}


def _content_problems(
    folder: Path, checksums: Problems, known: Problems, result: dict[str, Any] | None
) -> dict[str, str]:
    """Problems of the content of files that are not known to be damaged, on which HDF5 may crash.

    A case whose checksum matches is not read: its keys may be those of another version.
    """
    problems: dict[str, str] = {}
    if RESULT_FILE in known or not isinstance(result, dict):
        result = None
    for name, problem_of in (
        (RESULT_FILE, result_problem), (HISTORY_FILE, history_problem), (CASE_FILE, case_problem),
        (GIVEN_CASE_FILE, case_problem),
    ):  # fmt: skip
        is_settled = name in known or (problem_of is case_problem and name in checksums)
        if not is_settled and (folder / name).exists() and (what := problem_of(folder / name, result)):
            problems[name] = what
    problems |= snapshot_problems(folder, known, result)
    if not any(name.startswith((f"{SNAPSHOT_FOLDER}/", INDEX)) for name in {**known, **problems}):
        what = index_problem(folder, is_complete=result is not None)
        problems |= {INDEX: what} if what else {}
    return problems


def _remedy(folder: Path, name: str, problems: Problems) -> str:
    """How to restore a file at the least cost."""
    if name.startswith(INDEX) and not any(other.startswith(f"{SNAPSHOT_FOLDER}/") for other in problems):
        call = (
            f"from pathlib import Path; from mpmcol.io.snapshot import write_index; write_index(Path({str(folder)!r}))"
        )
        return f"only viewers need it, and the snapshots are intact; write it again with: python -c {quote(call)}"
    if problems[name] == FOREIGN:
        return "delete it"
    sources = [folder / case for case in (CASE_FILE, GIVEN_CASE_FILE) if case not in problems]
    source = next((path for path in sources if path.exists()), None)
    if source is None:
        return "restore it from a copy, or run the case again with --fresh"
    command = f"mpmcol run {quote(str(source))} --out {quote(str(folder))} --fresh"
    return f"restore it from a copy, or run the case again: {command}"


def _checkpoints(folder: Path) -> Iterator[Finding]:
    """Damaged checkpoints, by their own checksums; a note if an unfinished run has none."""
    valid, damaged = read_checkpoints(folder)
    consequence = "resumes from the other one" if valid else "restarts from scratch"
    for name in damaged:
        yield Finding(name, "this checkpoint is damaged", f"repeat the command of the run, which {consequence}")
    if not valid and not damaged and not (folder / RESULT_FILE).exists():
        remedy = "repeat the command of the run, which restarts from scratch"
        yield Finding(CHECKPOINT_FILES[0], "the run has written no checkpoint yet", remedy, is_damage=False)


def _charts(folder: Path) -> Iterator[Finding]:
    for path in sorted(folder.iterdir()):
        if path.suffix in (".png", ".gif", ".svg") and (what := read_error(path)):
            yield Finding(path.name, what, "delete it, and plot or render again")


def _temporary_files(folder: Path) -> Iterator[Finding]:
    for path in temporary_files(folder):
        what, remedy = "a temporary file of a process that was killed", "delete it; the next run here does so as well"
        yield Finding(path.relative_to(folder).as_posix(), what, remedy, is_damage=False)
