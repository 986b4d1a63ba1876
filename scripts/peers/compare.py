"""Compare the speed of mpmcol with that of the same scheme in Taichi and Warp, on the same problem in the same session.

    python -m scripts.peers.compare [--problem MODEL:POINTS ...] [--threads N ...] [--json FILE]

All codes of a case run in separate processes and step in turn, so that every round is a paired measurement.
`optimized` is Taichi with sorted points and coloured blocks, `example` Taichi as in its own examples,
`warp` the latter in Warp, which runs on one thread only.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Collection, Sequence
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import Any

from mpmcol.bench.report import Spread, describe_machine

CASES = ("plane:20000", "plane:200000", "quarter:20000")
Code = tuple[str, str]  # name and precision
CODES: tuple[Code, ...] = (
    ("mpmcol", "f64"),
    ("optimized", "f64"),
    ("optimized", "f32"),
    ("example", "f64"),
    ("example", "f32"),
    ("warp", "f64"),
    ("warp", "f32"),
)
NAMES = {"mpmcol": "mpmcol", "optimized": "Taichi, optimized", "example": "Taichi, example", "warp": "Warp"}
ONE_THREAD = ("warp",)
POINT_STEPS = 2_000_000  # points times steps in a round


@dataclass(frozen=True)
class Row:
    """One code on one problem: ns per point and step, and the ratio to mpmcol in the same round."""

    model: str
    points: int
    threads: int
    code: str
    precision: str
    ns: Spread
    ratio: Spread | None  # None if mpmcol was left out
    kinetic_energy: float  # of all points at the end, J: equal for all codes


class Worker:
    """A process that steps one code on one problem."""

    def __init__(self, code: str, precision: str, model: str, points: int, threads: int) -> None:
        command = [sys.executable, "-m", "scripts.peers.worker", code, precision, model, str(points), str(threads)]
        environment = {**os.environ, "NUMBA_NUM_THREADS": str(threads)}
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment
        )
        self.points: int = self._answer()["points"]
        self.kinetic_energy = 0.0

    def _answer(self) -> dict[str, Any]:
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if not line:
            raise RuntimeError(f"{self._process.args}: ended with code {self._process.wait()}")
        return json.loads(line)

    def step(self, steps: int) -> float:
        """Do `steps` steps; returns the seconds."""
        assert self._process.stdin is not None
        print(steps, file=self._process.stdin, flush=True)
        answer = self._answer()
        self.kinetic_energy = answer["kinetic_energy"]
        return answer["seconds"]

    def close(self) -> None:
        """End the process."""
        assert self._process.stdin is not None
        self._process.stdin.close()
        self._process.wait()


def select(names: Collection[str], threads: int) -> list[Code]:
    """The codes of these names in all their precisions, without those that cannot use so many threads."""
    return [code for code in CODES if code[0] in names and (threads == 1 or code[0] not in ONE_THREAD)]


def measure(model: str, points: int, threads: int, rounds: int, warm_up: int, codes: Sequence[Code]) -> list[Row]:
    """Rows of all codes on one problem."""
    workers = {code: Worker(*code, model, points, threads) for code in codes}
    steps = max(POINT_STEPS // points, 3)
    for worker in workers.values():
        worker.step(warm_up)
    ns: dict[Code, list[float]] = {code: [] for code in codes}
    for k in range(rounds):
        for code in (*codes[k % len(codes) :], *codes[: k % len(codes)]):  # the first code changes from round to round
            ns[code].append(1e9 * workers[code].step(steps) / (steps * workers[code].points))
    for worker in workers.values():
        worker.close()
    return [_make_row(model, threads, code, workers[code], ns[code], ns.get(CODES[0])) for code in codes]


def _make_row(model: str, threads: int, code: Code, worker: Worker, ns: list[float], own: list[float] | None) -> Row:
    """The timings of one code; `own`: those of mpmcol in the same rounds."""
    ratio = Spread.of([a / b for a, b in zip(ns, own, strict=True)]) if own else None
    return Row(model, worker.points, threads, *code, Spread.of(ns), ratio, worker.kinetic_energy)


HEADER = (
    "| problem | points | threads | code | precision | ns per point and step | ratio to mpmcol |",
    "|---|---|---|---|---|---|---|",
)


def table_line(row: Row) -> str:
    """One line of the Markdown table: medians, and minimum to maximum of all rounds."""
    ns = f"{row.ns.median:.1f} ({row.ns.min:.1f}-{row.ns.max:.1f})"
    ratio = "-" if row.ratio is None else f"{row.ratio.median:.2f} ({row.ratio.min:.2f}-{row.ratio.max:.2f})"
    return f"| {row.model} | {row.points} | {row.threads} | {NAMES[row.code]} | {row.precision} | {ns} | {ratio} |"


def disagreement(rows: list[Row]) -> float:
    """Largest relative difference between the final kinetic energies of the codes in double precision."""
    energies: dict[tuple[str, int, int], list[float]] = {}
    for row in rows:
        if row.precision == "f64":
            energies.setdefault((row.model, row.points, row.threads), []).append(row.kinetic_energy)
    return max(1.0 - min(values) / max(values) for values in energies.values())


def write_json(path: Path, rows: list[Row], rounds: int, warm_up: int) -> None:
    """Write all numbers with machine and versions."""
    machine = {**describe_machine(), **{name: metadata.version(name) for name in ("taichi", "warp-lang")}}
    report = {
        "date": datetime.now(UTC).isoformat(timespec="seconds"), "machine": machine, "rounds": rounds,
        "warm_up": warm_up, "point_steps": POINT_STEPS, "rows": [asdict(row) for row in rows],
    }  # fmt: skip
    path.write_text(json.dumps(report, indent=1) + "\n")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--problem", nargs="+", default=CASES, metavar="MODEL:POINTS", help="plane or quarter")
    parser.add_argument("--threads", nargs="+", type=int, default=[1, 2])
    parser.add_argument("--code", nargs="+", choices=NAMES, default=list(NAMES))
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--warm-up", type=int, default=120, help="steps before the timing")
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    if not all(select(options.code, threads) for threads in options.threads):
        parser.error("Warp runs on one thread only: use --threads 1, or add another code")
    rows: list[Row] = []
    print(*HEADER, sep="\n", flush=True)
    for problem in options.problem:
        model, points = problem.split(":")
        for threads in options.threads:
            codes = select(options.code, threads)
            found = measure(model, int(points), threads, options.rounds, options.warm_up, codes)
            print(*map(table_line, found), sep="\n", flush=True)
            rows += found
            if options.json:
                write_json(options.json, rows, options.rounds, options.warm_up)
    print(f"\nKinetic energies at the end differ by {disagreement(rows):.0e} at most (double precision).")


if __name__ == "__main__":
    main()
