"""Small cases that run in a fraction of a second, and the comparison of two runs bit by bit."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import mpmcol
from mpmcol.io.results import Results

TINY = ("grid.spacing=0.015", "output.snapshots=3", "stages.collapse.max_time_factor=1.0")  # of the case coarse-channel
SHORT = ("stages.collapse.max_time_factor=1.2", "output.snapshots=4")
BRITTLE = ("material.cohesion=20", "material.failure_strain=1e-3")
SMALL_CASES = {  # name -> shipped case and overrides, to be cut short with SHORT
    "plane": ("channel", "grid.spacing=0.015"),
    "softening": ("lube-channel-dense", "grid.spacing=0.015"),
    "lifted gate": ("coarse-channel", "grid.spacing=0.0125", "stages.gate_speed=0.5"),
    "slope": ("inclined-channel", "grid.spacing=0.02"),
    "vertical sides": ("inclined-channel", "grid.spacing=0.02", "geometry.sides=vertical", "stages.gate_speed=0.5"),
    "axisymmetric": ("lube-cylinder", "grid.spacing=0.0139"),
    "base deactivated": ("lube-cylinder", "grid.spacing=0.0139", "method.deactivate_base=true"),
    "layers": ("layered-column", "grid.spacing=0.015"),
    "outline": (
        "channel",
        "grid.spacing=0.015",
        "geometry.outline=[[0, 0], [0.2, 0], [0, 0.2]]",
        "stages.gate=false",
        "layers=[{ from = 0.05, to = 0.1, material = { density = 1500 } }]",
    ),
    "granular bed": ("granular-bed", "grid.spacing=0.015"),
    "mu(I)": ("mu-i-cylinder", "grid.spacing=0.0194", "grid.points_per_cell=4", *BRITTLE),
    "failure in tension": ("cohesive-column", "grid.spacing=0.125", "material.failure_strain=1e-3"),
    "random field": ("random-friction", "grid.spacing=0.2", "geometry.aspect=1", "grid.points_per_cell=4"),
    "quarter": ("quarter", "grid.spacing=0.0194", "geometry.aspect=0.4", "stages.initial_stress=k0"),
    "friction": (
        "frictional-floor",
        "grid.spacing=0.015",
        "friction.back_wall=0.2",
        "friction.side_walls=0.3",
        "friction.channel_width=0.1",
        "stages.gate_speed=0.5",
    ),
    "walls": ("dam", "grid.spacing=0.015", "walls.0.from=0.135", "walls.0.height=0.03"),
    "friction in 3D": (
        "quarter",
        "grid.spacing=0.0194",
        "geometry.aspect=0.4",
        "stages.initial_stress=k0",
        "geometry.base=rigid",
        "friction.floor=0.3",
        "output.wall_forces=true",
        "method.wall_impulse=true",
    ),
    "musl": ("cylinder", "grid.spacing=0.0194", "method.stress_order=musl", "method.transfer=apic"),
}
MACHINE_DEPENDENT = {"wall_s", "core_seconds", "ns_per_point_step", "peak_memory_bytes", "resumed", "threads"}


def small_case(name: str, *overrides: str) -> mpmcol.Case:
    """One of SMALL_CASES, cut short."""
    source, *values = SMALL_CASES[name]
    return mpmcol.load_case(source, [*values, *SHORT, *overrides])


def assert_equal_runs(one: Path, other: Path) -> None:
    """Snapshots, histories and results of two runs are equal bit by bit, except for times and threads."""
    mine, others = Results(one), Results(other)
    assert [path.name for path in mine.snapshots] == [path.name for path in others.snapshots]
    for k in range(len(mine.snapshots)):
        a, b = mine.snapshot(k), others.snapshot(k)
        assert (a.time, a.stage) == (b.time, b.stage)
        for name, array in a.arrays.items():
            assert np.array_equal(array, b.arrays[name]), (k, name)
    assert (one / "history.csv").read_bytes() == (other / "history.csv").read_bytes()
    summaries = [{k: v for k, v in run.summary.items() if k not in MACHINE_DEPENDENT} for run in (mine, others)]
    assert summaries[0] == summaries[1]
