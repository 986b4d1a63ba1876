"""Mean height of a collapse on a floor with mu = 0.4, against that of the code Tesserae.jl.

python scripts/boundaries/mean_height.py runs/mean_height      # the table in friction.md, a minute

Set-up of its test `docs/literate/tutorials/collapse.jl` (github.com/KeitaNakamura/Tesserae.jl): 0.6 m x 0.8 m of sand,
released to both sides at t = 0 with the geostatic stress of a confined elastic layer, Drucker-Prager with phi = 32
degrees matched in plane strain and psi = 0, 1500 kg/m3, E = 1 MPa, nu = 0.3, mu = 0.4, h = 15 mm, four points per cell.
"""

from __future__ import annotations

import argparse
from math import asin, degrees, radians, sqrt, tan
from pathlib import Path

import mpmcol

WIDTH, HEIGHT, GRAVITY = 0.3, 0.8, 9.81  # half-width
TANGENT = tan(radians(32.0))
# in plane strain without dilatancy, |s| = 3 sqrt(2) tan(phi) p / sqrt(9 + 12 tan(phi)^2) is Mohr-Coulomb with this sine
FRICTION = degrees(asin(TANGENT / sqrt(1.0 + 4.0 / 3.0 * TANGENT**2)))
EXPECTED = {0.75: 0.1184, 1.5: 0.1085}  # time, s: mean height, m
CASE = (
    f"geometry.radius={WIDTH}", f"geometry.height={HEIGHT}", "geometry.release=two-sided",
    "geometry.domain_length=3", "material.density=1500", "material.youngs_modulus=1e6", "material.poissons_ratio=0.3",
    f"material.friction_deg={FRICTION}", "friction.floor=0.4", "stages.k0=0.42857", "stages.collapse.damping=0",
    "stages.collapse.end=time", "output.wall_forces=false", "method.stress_filter=none", "time.cfl=0.4",
)  # fmt: skip
VARIANTS = {
    "FLIP, h = 15 mm, as there": ("method.transfer=flip", "grid.spacing=0.015"),
    "the same, time.cfl = 0.2": ("method.transfer=flip", "grid.spacing=0.015", "time.cfl=0.2"),
    "the same, no gate: elastic until the release": (
        "method.transfer=flip", "grid.spacing=0.015", "stages.gate=false", "stages.equilibrate.law=elastic",
    ),
    "the same, h = 7.5 mm": ("method.transfer=flip", "grid.spacing=0.0075"),
    "Taylor-FLIP, h = 15 mm": ("grid.spacing=0.015",),
    "Taylor-FLIP, stress filter and damping, h = 15 mm": (
        "grid.spacing=0.015", "method.stress_filter=flow", "stages.collapse.damping=0.05",
    ),
}  # fmt: skip


def main(out: Path) -> None:
    """Print a row for each variant."""
    print("| variant | " + " | ".join(f"mean height at {time:g} s | difference" for time in EXPECTED) + " |")
    print("|---|" + "---|---|" * len(EXPECTED))
    for number, (name, overrides) in enumerate(VARIANTS.items()):
        row = [_mean_height(out / f"{number}-{time:g}", time, overrides) for time in EXPECTED]
        shown = (f"{y:.4f} | {y / there - 1.0:+.1%}" for y, there in zip(row, EXPECTED.values(), strict=True))
        print(f"| {name} | {' | '.join(shown)} |", flush=True)


def _mean_height(folder: Path, time: float, overrides: tuple[str, ...]) -> float:
    """Height of the centre of mass at a time after the release, m."""
    factor = time / sqrt(HEIGHT / GRAVITY)
    case = mpmcol.load_case("frictional-floor", [*CASE, f"stages.collapse.max_time_factor={factor}", *overrides])
    last = mpmcol.run(case, folder).snapshot(-1)
    mass = last.arrays["mass"]
    return float(mass @ last.arrays["position"][:, 1] / mass.sum())


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path, help="folder of the runs; runs that are done are not repeated")
    main(parser.parse_args().out)
