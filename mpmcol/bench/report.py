"""Report of `mpmcol bench`: table, JSON, comparison with an earlier report."""

from __future__ import annotations

import json
import os
import platform
import statistics
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from mpmcol.case.small_file import read_small
from mpmcol.errors import UsageError
from mpmcol.provenance import cpu_name

SCHEMA = 4
LARGEST_FILE = 1_000_000  # bytes
EXPECTED = "expected a report that `mpmcol bench --out` wrote"
SLOWDOWN = 1.5


@dataclass(frozen=True)
class Spread:
    """Median, minimum and maximum of repeated timings, ns per point and step."""

    median: float
    min: float
    max: float

    @classmethod
    def of(cls, values: list[float]) -> Spread:
        """From the timings."""
        return cls(statistics.median(values), min(values), max(values))

    def __str__(self) -> str:
        return f"{self.median:7.1f} ({self.min:.1f}-{self.max:.1f})"


@dataclass(frozen=True)
class Row:
    """One phase of the step; `ratio`: plain loops over vector kernels, median of paired rounds.

    bound: lower bound of the time from memory traffic and arithmetic of this machine, ns per point and step.
    """

    phase: str
    vector: Spread
    plain: Spread | None
    ratio: float | None
    bound: float | None


@dataclass(frozen=True)
class BenchmarkCase:
    """Timings of one model, size and number of threads; `points` were requested, `n_points` is the actual number."""

    model: str
    points: int
    per_axis: int  # points per cell and axis
    n_points: int
    threads: int
    rows: tuple[Row, ...]
    bytes_per_point: float
    python_us: float  # additional time of a step if every step is a call from Python
    bandwidth: float  # of this machine for as many bytes, GB/s
    vector_rate: float  # of this machine, multiply-adds of eight lanes per ns

    @property
    def key(self) -> tuple[str, int, int, int]:
        """Identifies the case in another report."""
        return self.model, self.points, self.per_axis, self.threads

    @property
    def per_cell(self) -> int:
        """Points per cell."""
        return int(self.per_axis ** (3 if self.model == "quarter" else 2))

    @property
    def step(self) -> float:
        """Median of the whole step with vector kernels, ns per point."""
        return next(row.vector.median for row in self.rows if row.phase == "step")

    @property
    def python_share(self) -> float:
        """Time of a call from Python over that of a step."""
        return 1e3 * self.python_us / (self.step * self.n_points)


@dataclass(frozen=True)
class Report:
    """All cases, with machine and date."""

    date: str
    machine: dict[str, Any]
    cases: tuple[BenchmarkCase, ...]

    def to_json(self) -> str:
        """One JSON object."""
        return json.dumps({"schema": SCHEMA, **asdict(self)}, indent=1) + "\n"


def make_report(cases: list[BenchmarkCase]) -> Report:
    """Report of these cases on this machine, now."""
    return Report(datetime.now(UTC).isoformat(timespec="seconds"), describe_machine(), tuple(cases))


def load_report(path: Path) -> Report:
    """Read a report written by `--json`; raises UsageError if the file is not one."""
    try:
        content = read_small(path, LARGEST_FILE, "a report")
    except (OSError, ValueError) as error:
        raise UsageError(f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}; {EXPECTED}") from None
    try:
        data = json.loads(content)
        if data["schema"] != SCHEMA:
            raise ValueError(f"schema {data['schema']}, expected {SCHEMA}")
        return Report(data["date"], data["machine"], tuple(_read_case(case) for case in data["cases"]))
    except (ValueError, KeyError, TypeError, AttributeError):
        raise UsageError(f"{path}: is damaged, or no such report; {EXPECTED}") from None


def _read_case(data: dict[str, Any]) -> BenchmarkCase:
    rows = tuple(
        Row(row["phase"], Spread(**row["vector"]), row["plain"] and Spread(**row["plain"]), row["ratio"], row["bound"])
        for row in data["rows"]
    )
    return BenchmarkCase(**{**data, "rows": rows})


def describe_machine() -> dict[str, Any]:
    """Processor, cores and versions of the software that generates machine code."""
    import llvmlite
    import numba
    import numpy as np
    from llvmlite import binding

    return {
        "cpu": cpu_name(),
        "llvm_cpu": binding.get_host_cpu_name(),
        "cores": os.cpu_count(),
        "system": platform.platform(terse=True),
        "python": platform.python_version(),
        "numba": numba.__version__,
        "llvmlite": llvmlite.__version__,
        "llvm": ".".join(map(str, binding.llvm_version_info)),
        "numpy": np.__version__,
    }


def table_lines(case: BenchmarkCase) -> list[str]:
    """The table of one case."""
    head = f"{case.model}, {case.n_points} points, {case.per_cell} per cell, {case.threads} thread"
    head += "s" if case.threads > 1 else ""
    columns = f"{'phase':<16}{'vector kernels':<26}{'plain loops':<26}plain/vector   bound"
    return [
        f"{head}: ns per point and step, median (min-max)",
        columns,
        *(_row_line(row) for row in case.rows),
        f"{'memory':<16}{case.bytes_per_point:7.0f} bytes per point",
        f"{'machine':<16}{case.bandwidth:7.0f} GB/s and {case.vector_rate:.1f} vector multiply-adds per ns",
        f"{'Python':<16}{case.python_us:7.1f} us per call of one step, {100.0 * case.python_share:.1f} % of the step",
        "",
    ]


def _row_line(row: Row) -> str:
    plain = "" if row.plain is None else str(row.plain)
    ratio = "" if row.ratio is None else f"{row.ratio:8.2f}"
    bound = "" if row.bound is None else f"{row.bound:15.1f} ({100.0 * row.bound / row.vector.median:.0f} %)"
    return f"{row.phase:<16}{row.vector!s:<26}{plain:<26}{ratio}{bound}".rstrip()


@dataclass(frozen=True)
class Slowdown:
    """A phase that is slower than before, beyond the noise of both reports."""

    case: BenchmarkCase
    phase: str
    ratio: float
    plain_ratio: float | None

    def __str__(self) -> str:
        """The ratio of the plain loops shows whether the machine or the code is slower."""
        case = self.case
        where = f"{case.model}, {case.points} points, {case.per_cell} per cell, {case.threads} threads, {self.phase}"
        plain = "" if self.plain_ratio is None else f" (plain loops: {self.plain_ratio:.2f} times)"
        return f"{where}: {self.ratio:.2f} times as slow as before{plain}"


def compare(old: Report, new: Report) -> list[Slowdown]:
    """Phases at least SLOWDOWN times slower than in `old` whose fastest round is slower than the slowest one there."""
    before = {(case.key, row.phase): row for case in old.cases for row in case.rows}
    found = []
    for case in new.cases:
        for row in case.rows:
            was = before.get((case.key, row.phase))
            if was and row.vector.median >= SLOWDOWN * was.vector.median and row.vector.min > was.vector.max:
                plain = row.plain.median / was.plain.median if row.plain and was.plain else None
                found.append(Slowdown(case, row.phase, row.vector.median / was.vector.median, plain))
    return found
