"""Every shipped case, coarse and cut short, against stored numbers.

A change of these numbers is a change of results: state the reason in the commit that changes them.
"""

from __future__ import annotations

from pathlib import Path

import pytest

import mpmcol
from mpmcol.case import shipped_cases
from mpmcol.measure import FRONTS

SHORT = ("stages.collapse.max_time_factor=2.5", "output.snapshots=2")
TWINS = ("channel", "channel-loose", "channel-dense", "cylinder", "quarter")  # of lube-*, with the stress filter
OF_PAPER = {
    "lube-channel": ("grid.spacing=0.01", "geometry.aspect=2"),
    "lube-channel-loose": ("grid.spacing=0.01", "geometry.aspect=1"),
    "lube-channel-dense": ("grid.spacing=0.01", "geometry.aspect=1"),
    "lube-cylinder": ("grid.spacing=0.01",),
    "lube-quarter": ("grid.spacing=0.02",),
}
COARSE = {
    "coarse-channel": ("grid.spacing=0.01",),
    "quickstart": ("grid.spacing=9.7 mm", "grid.points_per_cell=4"),
    "bui-rods": ("grid.spacing=0.01",),
    "heap": ("grid.spacing=0.02", "grid.points_per_cell=4"),
    "granular-bed": ("grid.spacing=0.0075", "geometry.aspect=1"),
    "inclined-channel": ("grid.spacing=0.02",),
    "layered-column": ("grid.spacing=0.01", "geometry.aspect=1"),
    "frictional-floor": ("grid.spacing=0.0075",),
    "dam": (),
    "cohesive-column": ("grid.spacing=0.1",),
    "mu-i-cylinder": ("grid.spacing=9.7 mm", "grid.points_per_cell=4"),
    "random-friction": ("grid.spacing=0.1", "grid.points_per_cell=4"),
    **OF_PAPER,
    **{twin: OF_PAPER[f"lube-{twin}"] for twin in TWINS},
}
# steps, zeta by front_max, front_connected, front_height, beta
EXPECTED: dict[str, tuple[int, float, float, float, float]] = {
    "coarse-channel": (3776, 0.774138735, 0.774138735, 0.759537404, 0.969332731),
    "channel": (5737, 2.010157771, 2.010157771, 1.994778671, 0.646857103),
    "channel-loose": (3816, 0.732495454, 0.732495454, 0.706741435, 0.988751676),
    "channel-dense": (3887, 0.603024065, 0.603024065, 0.593016889, 0.968188488),
    "cylinder": (3642, 0.61748003, 0.61748003, 0.593506011, 0.956975785),
    "quarter": (2243, 0.467671523, 0.467671523, 0.365814726, 0.974067484),
    "lube-channel": (5714, 2.007089787, 2.007089787, 1.959406912, 0.656061798),
    "lube-channel-loose": (3814, 0.86451643, 0.795965128, 0.705972722, 0.992881285),
    "lube-channel-dense": (3904, 0.724602805, 0.724602805, 0.634391181, 0.993994981),
    "lube-cylinder": (3678, 0.649031933, 0.649031933, 0.596461301, 0.972118983),
    "lube-quarter": (2207, 0.437980102, 0.437980102, 0.329851514, 0.999920231),
    "quickstart": (4754, 2.223691557, 2.223691557, 2.160848521, 0.369080814),
    "heap": (2986, -0.023231053, -0.023231053, -0.023231053, 0.938797915),
    "granular-bed": (2317, 1.028753042, 1.028753042, 1.028753042, 0.933558176),
    "frictional-floor": (2782, 1.215351515, 1.215351515, 1.215351515, 0.92135736),
    "dam": (2776, 0.619618654, 0.619618654, 0.619618654, 0.924730652),
    "cohesive-column": (1842, 0.195622937, 0.148745314, 0.195622937, 0.998552227),
    "mu-i-cylinder": (2620, 1.114527618, 1.114527618, 1.04803905, 0.630361786),
    "bui-rods": (1654, 0.654307258, 0.654307258, 0.6443832, 0.998293409),
    "random-friction": (2489, 1.64646616, 1.64646616, 1.627183692, 0.773803568),
    "layered-column": (1701, 1.094428093, 1.094428093, 1.094428093, 0.86145262),
    "inclined-channel": (1094, 0.886340247, 0.886340247, 0.886340247, 0.87517582),
}


def test_every_case_has_its_numbers() -> None:
    assert set(shipped_cases()) == set(COARSE) == set(EXPECTED)


SLOW = ("channel-loose", "lube-channel-loose", "lube-channel", "lube-cylinder", "lube-quarter")  # like others


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow) if name in SLOW else name for name in COARSE]
)
def test_case_gives_its_numbers(name: str, tmp_path: Path) -> None:
    summary = mpmcol.run(mpmcol.load_case(name, [*SHORT, *COARSE[name]]), tmp_path / name).summary
    zeta = [summary["zeta"][front] for front in FRONTS]
    zeta = [value["mean"] if isinstance(value, dict) else value for value in zeta]  # over azimuth in 3D
    got = (summary["steps"], *zeta, summary["beta"])
    assert got == pytest.approx(EXPECTED[name], rel=1e-6), f'"{name}": {tuple(round(v, 9) for v in got)},'
    assert abs(summary["ledger"]["residual"]) < 1e-9 * abs(summary["ledger"]["potential"])
