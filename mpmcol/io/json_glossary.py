"""What JSON output holds: meaning and unit of each key that a command with --json prints, or writes to a JSON file.

Names are as in `glossary.py`: those of nested keys, joined by dots, in which parts in capitals vary. Keys that hold the
content of another table are in CONTENTS.
"""

from __future__ import annotations

from mpmcol.io.accuracy_glossary import ACCURACY, ERROR_BARS
from mpmcol.io.file_glossary import FILES, SNAPSHOT
from mpmcol.io.fit_glossary import FIT
from mpmcol.io.glossary import MEASURE, NAMES, RESULT, SLOPES, TABLE, Names
from mpmcol.io.study_glossary import MAP, PAPER, PARETO, PLAN, SCHEMA, STABILITY, VALIDATE, WRITTEN
from mpmcol.io.term_glossary import TERMS
from mpmcol.io.uncertainty_glossary import RECORD_NAMES
from mpmcol.provenance import DEPENDENCIES

_RUNS: Names = {
    "runs.folder": ("", "folder of the run in that of the sweep"),
    "runs.inputs": ("", "values of the keys that vary; of a single run empty"),
    "runs.inputs.NAME": ("", "value of a key that varies"),
}
_MACHINE: Names = {
    "mpmcol": ("", "version of mpmcol, with a digest of its sources"),
    **dict.fromkeys(("python", *DEPENDENCIES), ("", "version with which numbers are computed")),
    "machine": ("", "architecture of the processor"),
    "cpu": ("", "name of the processor"),
    "cores": ("", "number of logical cores"),
    "system": ("", "operating system"),
}
_SPREAD: Names = {
    "median": ("ns", "median of repeated timings, per point and step"),
    "min": ("ns", "shortest of them"),
    "max": ("ns", "longest of them"),
}
_ESTIMATE: Names = {
    **SCHEMA,
    **{name: NAMES[RESULT][name] for name in ("points", "column_points", "dt", "warnings")},
    "nodes": ("", "number of grid nodes near material at the start"),
    "tiles_of_group": ("", "occupied tiles of each group; those of a group are processed in parallel"),
    "steps": ("", "number of time steps, estimated"),
    "most_steps": ("", "number of time steps for the longest durations that the case allows"),
    "memory_bytes": ("bytes", "memory of the run, estimated"),
    "disk_bytes": ("bytes", "size of the results, estimated"),
    "ns_per_point_step": ("ns", "time per material point and step, measured now"),
    "seconds": ("s", "time for `steps`"),
    "most_seconds": ("s", "time for `most_steps`"),
    "compile_seconds": ("s", "time to compile the kernels, or to load them from the cache"),
}
_FORECAST: Names = {
    **SCHEMA,
    "jobs": ("", "runs at a time"),
    "threads": ("", "threads of each run"),
    "seconds": ("s", "time of all runs that are not finished, estimated"),
    "runs": ("", "one entry for each run"),
    **_RUNS,
    "runs.points": ("", "number of material points"),
    "runs.steps": ("", "number of time steps, estimated"),
    "runs.seconds": ("s", "time of the run, estimated; null if it is finished"),
}
_PLAN_FILE: Names = {
    **SCHEMA,
    "title": ("", "title of the case"),
    "version": ("", "version of mpmcol that planned the runs"),
    "jobs": ("", "runs at a time"),
    "threads": ("", "threads of each run"),
    "runs": ("", "one entry for each run"),
    **_RUNS,
    "runs.cost": ("", "material points times steps, estimated; those of slower methods and of 3D count more"),
    "runs.end": ("s", "time since release at the end of the collapse, estimated"),
}
_STATUS: Names = {
    **SCHEMA,
    "folder": ("", "folder of the sweep or of the run"),
    "version": ("", "version of mpmcol that planned the runs, or that ended a single run; null before its end"),
    "counts.STATUS": ("", "number of runs with a status"),
    "seconds_left": ("s", "time until all runs have ended, estimated from their speed; null if it is not known"),
    "runs": ("", "one entry for each run"),
    **_RUNS,
    "runs.status": ("", "done, failed, running, stopped, unfinished (killed), damaged or missing (not started)"),
    "runs.progress": ("", "share of the work of the run that is done"),
    "runs.seconds": ("s", "time of the run without compilation; while it is executed, since it started or resumed"),
    "runs.message": ("", "cause and remedy of a failure"),
}
_SWEEP: Names = {
    **SCHEMA,
    "folder": ("", "folder of the sweep"),
    "runs": ("", "rows of table.csv, which have also the values of the keys that vary"),
    "slopes": ("", "rows of slopes.csv"),
    "notes": ("", "warnings in the results, each once, with the number of its runs"),
    **WRITTEN,
}
_VERIFY: Names = {
    **SCHEMA,
    "intact": ("", "whether no file is damaged or missing"),
    "folders": ("", "one entry for each folder"),
    "folders.folder": ("", "path of the folder"),
    "folders.status": ("", "status of its run; empty if it holds no run itself"),
    "folders.files": ("", "number of files that were checked"),
    "folders.intact": ("", "whether no file of the folder is damaged or missing"),
    "folders.findings": ("", "problems that were found"),
    "folders.findings.file": ("", "path of the file in the folder"),
    "folders.findings.what": ("", "problem of the file"),
    "folders.findings.remedy": ("", "what to do"),
    "folders.findings.is_damage": ("", "whether the file is damaged or missing; otherwise a note"),
}
_BENCH: Names = {
    **SCHEMA,
    "date": ("", "date and time of the measurement, UTC"),
    "machine.NAME": ("", "processor, cores, system, and versions of the software that generates machine code"),
    "cases": ("", "one entry for each model, size and number of threads"),
    "cases.model": ("", "geometry.model"),
    "cases.points": ("", "number of material points that was asked for"),
    "cases.per_axis": ("", "points per cell along each axis"),
    "cases.n_points": ("", "number of material points"),
    "cases.threads": ("", "number of threads"),
    "cases.rows": ("", "one entry for each phase of the step"),
    "cases.rows.phase": ("", "phase of the step, or the whole step"),
    **{f"cases.rows.vector.{name}": entry for name, entry in _SPREAD.items()},
    "cases.rows.plain": ("", "the same of plain loops; null where they were not timed"),
    **{f"cases.rows.plain.{name}": entry for name, entry in _SPREAD.items()},
    "cases.rows.bound": ("ns", "lower bound of the time of the phase per point, from bandwidth and arithmetic"),
    "cases.rows.ratio": ("", "plain loops over vector kernels, median of paired rounds"),
    "cases.bytes_per_point": ("bytes", "memory of the arrays per point"),
    "cases.python_us": ("us", "additional time of a step if each step is a call from Python"),
    "cases.bandwidth": ("GB/s", "memory bandwidth of the machine for as many bytes"),
    "cases.vector_rate": ("1/ns", "multiply-adds of eight lanes that the machine carries out"),
    "cases.bound": ("ns", "lower bound of the time of a step per point, from bandwidth and arithmetic"),
}
_SCALING: Names = {
    **{name: _BENCH[name] for name in ("schema", "date", "machine.NAME", "cases.model")},
    "cases": ("", "one entry for each model, kind of scaling and size"),
    "cases.kind": ("", "strong: the same points with any number of threads; weak: points for each thread"),
    "cases.points": ("", "number of material points that was asked for, in all or for each thread"),
    "cases.rows": ("", "one entry for each number of threads"),
    "cases.rows.threads": ("", "number of threads"),
    "cases.rows.n_points": ("", "number of material points"),
    "cases.rows.step": ("", "time of the whole step; null, as speed-ups and efficiency, if it was not measured"),
    **{f"cases.rows.step.{name}": entry for name, entry in _SPREAD.items()},
    "cases.rows.speedup": ("", "time per point with one thread over that with these, median of paired rounds"),
    "cases.rows.fastest_speedup": ("", "the same ratio of the fastest steps"),
    "cases.rows.efficiency": ("", "speed-up over number of threads"),
    "cases.rows.model_speedup": ("", "speed-up that the model of the tiles gives"),
    "cases.rows.groups": ("", "groups of tiles; those of a group are processed in parallel"),
    "cases.rows.mean_tiles": ("", "mean number of tiles in a group"),
    "cases.rows.fewest_tiles": ("", "tiles in the smallest group"),
}

OUTPUTS: dict[str, Names] = {  # command or file -> its names
    "run --json": ERROR_BARS | ACCURACY,
    "run --dry-run --json": _ESTIMATE,
    "sweep --json": _SWEEP,
    "sweep --dry-run --json": _FORECAST,
    "fit --dry-run --json": _FORECAST,
    "sweep --uncertain --json": {**RECORD_NAMES, **{name: _SWEEP[name] for name in ("folder", "notes")}, **WRITTEN},
    "uncertainty.json": RECORD_NAMES,
    "sweep.json": _PLAN_FILE,
    "fit --json": FIT,
    "status --json": _STATUS,
    "verify --json": _VERIFY,
    "paper --json": PAPER,
    "validate --json": VALIDATE,
    "stability --json": STABILITY,
    "stability --map --json": MAP,
    "pareto --json": PARETO,
    "plan --json": PLAN,
    "bench --json": _BENCH,
    "bench --scaling --json": _SCALING,
    "environment.json": _MACHINE,
}
CONTENTS = {  # command -> its key -> table whose names that key holds; "": it prints the content of the table itself
    "run --json": {"": RESULT},
    "measure --json": {"": MEASURE},
    "sweep --json": {"runs": TABLE, "slopes": SLOPES},
}
ALL_NAMES = {**NAMES, "snapshots": SNAPSHOT, "the folder of a run": FILES, "the output of mpmcol run": TERMS, **OUTPUTS}
