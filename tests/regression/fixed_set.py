"""Digests and measured numbers of a fixed set of runs, to compare before and after a change that must not change them.

    python -m tests.regression.fixed_set --write FILE [NAME ...]
    python -m tests.regression.fixed_set --compare FILE [NAME ...]

The set covers every model, law, shape function, transfer, stress order and variant of the method, a resumed and a
retried run, a sweep and a quick figure of the paper. `state_sha256` covers every bit of points, clock and ledger, so
equal digests mean equal runs, step by step. Each run uses one thread; results do not depend on their number.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import mpmcol
from mpmcol.errors import Interrupted
from mpmcol.sweep.table import read_table

Numbers = dict[str, Any]

MEASURED = (
    "state_sha256", "status", "steps", "time", "dt", "points", "zeta", "front", "height", "beta", "area_factor",
    "undisturbed_radius", "stop_time", "at_rest", "ledger", "worst_J",
)  # fmt: skip

PLANE = ("coarse-channel", "grid.spacing=0.01", "stages.collapse.max_time_factor=1.5", "output.snapshots=2")
RIGID = (*PLANE, "geometry.base=rigid", "method.wall_impulse=true")
AXISYMMETRIC = ("lube-cylinder", "grid.spacing=0.01", *PLANE[2:])
QUARTER = ("lube-quarter", "grid.spacing=0.02", "stages.collapse.max_time_factor=1.0", "output.snapshots=2")
FULL = (*QUARTER, "geometry.model=full", "geometry.base=rigid")
SOFTENING = ("lube-channel-dense", "grid.spacing=0.01", "geometry.aspect=1", *PLANE[2:])
HARSH = ("coarse-channel", "grid.spacing=0.015", "output.snapshots=8", "stages.collapse.max_time_factor=1.0")

ELASTIC = (
    "material={law='elastic', density=2650.0, youngs_modulus=10e6, poissons_ratio=0.2}",
    "stages.collapse.max_time_factor=0.5",
)

RUNS: dict[str, tuple[str, ...]] = {
    "plane": PLANE,
    "plane-rigid": RIGID,
    "plane-two-sided": (*RIGID, "geometry.release=two-sided"),
    "plane-whole-way": ("coarse-channel", "grid.spacing=0.01"),
    "plane-cohesion": (*RIGID, "material.cohesion=200", "material.dilatancy_deg=5"),
    "plane-elastic": (*RIGID, *ELASTIC),
    "plane-elastic-first": (*PLANE, "stages.equilibrate.law=elastic"),
    "plane-softening-dense": SOFTENING,
    "plane-softening-loose": ("lube-channel-loose", *SOFTENING[1:]),
    "plane-k0": (*RIGID, "stages.initial_stress=k0"),
    "plane-gate": (*RIGID, "stages.gate_speed=1.0"),
    "plane-deactivated-base": (*PLANE, "method.deactivate_base=true"),
    "plane-nine-points": (*RIGID, "grid.points_per_cell=9"),
    "plane-linear": (*RIGID, "method.basis=linear"),
    "plane-cubic": (*RIGID, "method.basis=cubic"),
    "plane-no-correction": (*RIGID, "method.kernel_correction=false"),
    "plane-flip": (*RIGID, "method.transfer=flip", "method.flip_fraction=0.98"),
    "plane-pic": (*RIGID, "method.transfer=pic"),
    "plane-tpic": (*RIGID, "method.transfer=tpic"),
    "plane-apic": (*RIGID, "method.transfer=apic"),
    "plane-usf": (*RIGID, "method.stress_order=usf"),
    "plane-musl": (*RIGID, "method.stress_order=musl"),
    "plane-position-paper": (*RIGID, "method.position_update=paper"),
    "plane-position-end": (*RIGID, "method.position_update=end"),
    "plane-exponential-volume": (*RIGID, "method.volume_update=exponential"),
    "plane-cell-strain": (*RIGID, "method.volumetric_strain=cell"),
    "plane-no-opening": (*RIGID, "method.opening_strain=false"),
    "plane-no-filter": (*PLANE, "method.stress_filter=none"),
    "plane-strong-filter": (*PLANE, "method.filter_strength=2"),
    "plane-softening-dense-filter": ("channel-dense", *SOFTENING[1:]),
    "plane-rods": ("bui-rods", "grid.spacing=0.01", *PLANE[2:]),
    "axisymmetric": AXISYMMETRIC,
    "axisymmetric-rigid": (*AXISYMMETRIC, "geometry.base=rigid", "method.wall_impulse=true"),
    "axisymmetric-softening": (*SOFTENING, "geometry.model=axisymmetric"),
    "axisymmetric-filter": ("cylinder", *AXISYMMETRIC[1:]),
    "axisymmetric-filter-musl": ("cylinder", *AXISYMMETRIC[1:], "method.stress_order=musl"),
    "axisymmetric-cubic": (*AXISYMMETRIC, "method.basis=cubic"),
    "axisymmetric-apic": (*AXISYMMETRIC, "method.transfer=apic"),
    "axisymmetric-cell-strain": (*AXISYMMETRIC, "method.volumetric_strain=cell"),
    "axisymmetric-musl": (*AXISYMMETRIC, "method.stress_order=musl"),
    "quarter": QUARTER,
    "quarter-deactivated-base": (*QUARTER, "method.deactivate_base=true"),
    "quarter-cubic": (*QUARTER, "method.basis=cubic"),
    "quarter-linear": (*QUARTER, "method.basis=linear"),
    "quarter-apic": (*QUARTER, "method.transfer=apic"),
    "quarter-usf": (*QUARTER, "method.stress_order=usf"),
    "quarter-musl": (*QUARTER, "method.stress_order=musl"),
    "quarter-cell-strain": (*QUARTER, "method.volumetric_strain=cell"),
    "quarter-softening": ("lube-channel-dense", *QUARTER[1:], "geometry.model=quarter", "grid.points_per_cell=8"),
    "quarter-filter": ("quarter", *QUARTER[1:]),
    "quarter-filter-apic": ("quarter", *QUARTER[1:], "method.transfer=apic"),
    "full": FULL,
    "full-box": (*FULL, "geometry.section=box", "geometry.depth=0.06"),
    "full-gate": (*FULL, "stages.gate_speed=1.0"),
}


def resumed(folder: Path) -> Numbers:
    """A run that is interrupted in the collapse and then resumed."""

    def interrupt(stage: str, share: float) -> None:
        if stage == "collapse" and share > 0.3:
            os.kill(os.getpid(), signal.SIGUSR1)

    case = mpmcol.load_case(PLANE[0], PLANE[1:])
    try:
        mpmcol.run(case, folder, threads=1, progress=interrupt)
    except Interrupted:
        return measured(mpmcol.run(case, folder, threads=1).summary)
    raise RuntimeError("the run was not interrupted")


def retried(folder: Path) -> Numbers:
    """A run that fails with its time step and completes with half of it."""
    case = mpmcol.load_case(HARSH[0], [*HARSH[1:], "time.cfl=1.0"])
    return measured(mpmcol.run(case, folder, threads=1, on_instability="retry").summary)


def sweep(folder: Path) -> Numbers:
    """The table of a sweep over two aspect ratios and two models."""
    _command(
        "sweep", "lube-cylinder", "--aspect", "0.6,1", "--set", "geometry.model=plane,axisymmetric", "--set", PLANE[1],
        "--set", PLANE[2], "--out", str(folder), "--threads", "1", "--jobs", "1", "--quiet",
    )  # fmt: skip
    left_out = (
        "seconds",
        "ns_",
        "core_",
        "peak_",
        "case_hash",
        "version",
        "threads",
        "message",
        "folder",
        "unverified",
    )
    return {
        f"{k}.{name}": value
        for k, row in enumerate(read_table(folder / "table.csv"))
        for name, value in row.items()
        if not any(part in name for part in left_out)
    }


def figure(folder: Path) -> Numbers:
    """The table of Figure 5 on its coarse grids."""
    _command("paper", "fig5", "--quick", "--out", str(folder), "--threads", "1", "--jobs", "1", "--quiet")
    rows = _rows(folder / "fig5.csv")
    return {f"{k}.{name}": row[name] for k, row in enumerate(rows) for name in ("h_mm", "points", "steps", *row)
            if not any(part in name for part in ("cost", "seconds", "time_", "second"))}  # fmt: skip


SPECIAL: dict[str, Callable[[Path], Numbers]] = {
    "resumed": resumed, "retried": retried, "sweep": sweep, "figure": figure
}  # fmt: skip


def measured(summary: Numbers) -> Numbers:
    """What must be equal of a result."""
    errors = {
        "/".join((entry["experiment"], entry["quantity"], entry["front_definition"])): entry["error"]
        for entry in summary["errors"]
        if entry["error"] is not None
    }
    scores = {entry["experiment"]: entry["rms_mm"] for entry in summary["profile_scores"]}
    return {name: summary.get(name) for name in MEASURED} | {"errors": errors, "rms_mm": scores}


def compute(name: str, folder: Path) -> Numbers:
    """The numbers of one member of the set."""
    if name in SPECIAL:
        return SPECIAL[name](folder)
    shipped, *overrides = RUNS[name]
    return measured(mpmcol.run(mpmcol.load_case(shipped, overrides), folder, threads=1).summary)


def differing(expected: Numbers, computed: Numbers) -> list[str]:
    """One line for each number that is not equal."""
    return [
        f"{key}: {expected.get(key)} expected, {computed.get(key)} computed"
        for key in expected | computed
        if expected.get(key) != computed.get(key)
    ]


def _command(*arguments: str) -> None:
    subprocess.run([sys.executable, "-m", "mpmcol", *arguments], check=True)


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def main() -> int:
    """Write or compare; the exit code is the number of members that differ, at most 1."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    action = parser.add_mutually_exclusive_group(required=True)
    action.add_argument("--write", type=Path, metavar="FILE")
    action.add_argument("--compare", type=Path, metavar="FILE")
    parser.add_argument("names", nargs="*", metavar="NAME")
    asked = parser.parse_args()
    names = asked.names or [*RUNS, *SPECIAL]
    expected = json.loads(asked.compare.read_text()) if asked.compare else {}
    found, failures = {}, 0
    for name in names:
        with tempfile.TemporaryDirectory() as folder:
            found[name] = json.loads(json.dumps(compute(name, Path(folder) / name)))
        lines = differing(expected[name], found[name]) if asked.compare else []
        failures += bool(lines)
        print(f"{name:28s} {'DIFFERS' if lines else 'equal' if asked.compare else 'written'}", flush=True)
        for line in lines:
            print(f"    {line}", flush=True)
        if asked.write:
            asked.write.write_text(json.dumps(found, indent=1) + "\n")
    print(f"{len(names) - failures} of {len(names)} equal" if asked.compare else f"{len(names)} written")
    return min(failures, 1)


if __name__ == "__main__":
    sys.exit(main())
