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
COARSE = {
    "quickstart": ("grid.spacing=0.01",),
    "lube-channel": ("grid.spacing=0.01", "geometry.aspect=2"),
    "lube-channel-loose": ("grid.spacing=0.01", "geometry.aspect=1"),
    "lube-channel-dense": ("grid.spacing=0.01", "geometry.aspect=1"),
    "lube-cylinder": ("grid.spacing=0.01",),
    "lube-quarter": ("grid.spacing=0.02",),
    "bui-rods": ("grid.spacing=0.01",),
}
# steps, zeta by front_max, front_connected, front_height, beta
EXPECTED: dict[str, tuple[int, float, float, float, float]] = {
    "quickstart": (3769, 0.860991478, 0.860991478, 0.7776888, 0.978959627),
    "lube-channel": (5714, 2.008260687, 2.008260687, 1.95977179, 0.656082867),
    "lube-channel-loose": (3815, 0.87781373, 0.87781373, 0.709667268, 0.993304975),
    "lube-channel-dense": (3936, 0.702208016, 0.702208016, 0.690879446, 0.992793285),
    "lube-cylinder": (3678, 0.649021641, 0.649021641, 0.596467617, 0.972122909),
    "lube-quarter": (2207, 0.437980102, 0.437980102, 0.329851514, 0.999920231),
    "bui-rods": (1532, 0.668632489, 0.668632489, 0.650019636, 0.998548517),
}


def test_every_case_has_its_numbers() -> None:
    assert set(shipped_cases()) == set(COARSE) == set(EXPECTED)


@pytest.mark.parametrize("name", list(COARSE))
def test_case_gives_its_numbers(name: str, tmp_path: Path) -> None:
    summary = mpmcol.run(mpmcol.load_case(name, [*SHORT, *COARSE[name]]), tmp_path / name).summary
    zeta = [summary["zeta"][front] for front in FRONTS]
    zeta = [value["mean"] if isinstance(value, dict) else value for value in zeta]  # over azimuth in 3D
    got = (summary["steps"], *zeta, summary["beta"])
    assert got == pytest.approx(EXPECTED[name], rel=1e-6), f'"{name}": {tuple(round(v, 9) for v in got)},'
    assert abs(summary["ledger"]["residual"]) < 1e-9 * abs(summary["ledger"]["potential"])
