"""Collapses with the laws: strength in plane strain and its scatter, cohesion, and grain size. One line per run.

    python scripts/laws/collapses.py OUT [GROUP ...]

Runs in OUT that are finished are not repeated. All groups take an hour.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from math import asin, degrees
from pathlib import Path
from typing import NamedTuple

import mpmcol

R_I = 0.09  # m, of coarse-channel
COMMON = (
    "geometry.base=rigid", "method.wall_impulse=true", "stages.initial_stress=k0", "stages.collapse.damping=0",
    "output.snapshots=1",
)  # fmt: skip
DENSITY = 1550.0  # kg/m3
GRAINS = "mu_s=0.32, mu_2=0.60, I_0=0.4, grain_density=2500.0"  # Lagree et al. 2011, doi:10.1017/jfm.2011.335
CONSTANT = GRAINS.replace("mu_2=0.60", "mu_2=0.32")
MU_S = degrees(asin(0.32))  # friction angle with mu = 0.32 in plane strain

CFL = (0.24, 0.26, 0.28, 0.30, 0.44, 0.46, 0.48, 0.50)  # runs that differ in the time step only


class Run(NamedTuple):
    """A column with a material; h in m. cfl: None for that of the case."""

    name: str
    a: float
    h: float
    material: str
    cfl: float | None = None


def material(law: str, keys: str) -> str:
    """Override that replaces the material of a case."""
    return f"material={{law='{law}', density={DENSITY}, youngs_modulus=2e6, poissons_ratio=0.2, {keys}}}"


def strength() -> Iterator[Run]:
    """Drucker-Prager as strong as Mohr-Coulomb in plane strain, and with other matches."""
    yield Run("mohr-coulomb-33", 1.0, 0.005, material("mohr-coulomb", "friction_deg=33"))
    for match in ("plane-strain", "tangent", "compression"):
        yield Run(f"{match}-33", 1.0, 0.005, material("drucker-prager", f"friction_deg=33, match='{match}'"))
    for h in (0.005, 0.004):
        for law in ("mohr-coulomb", "drucker-prager"):
            yield Run(f"{law}-18.66-{1e3 * h:g}mm", 2.0, h, material(law, f"friction_deg={MU_S}"))


def scatter() -> Iterator[Run]:
    """Mohr-Coulomb and Drucker-Prager of equal strength in plane strain, with other time steps."""
    for h, count in ((0.006, 8), (0.005, 8), (0.004, 4)):
        for law in ("mohr-coulomb", "drucker-prager"):
            for cfl in CFL[:count]:
                name = f"{law}-18.66-{1e3 * h:g}mm-cfl{cfl}"
                yield Run(name, 2.0, h, material(law, f"friction_deg={MU_S}"), cfl)


def cohesion() -> Iterator[Run]:
    """Runout with cohesion over rho g h_i."""
    for relative in (0.0, 0.05, 0.10, 0.15):
        c = relative * DENSITY * 9.81 * 0.5 * R_I
        yield Run(f"cohesion-{relative}", 0.5, 0.0025, material("drucker-prager", f"friction_deg=23.58, cohesion={c}"))


def grains() -> Iterator[Run]:
    """Runout with mu(I) over a, with smaller grains, and without dependence on the rate."""
    for a in (0.5, 1.0, 2.0, 5.0):
        yield Run(f"mu-i-a{a:g}", a, 0.005, material("mu-i", f"{GRAINS}, grain_diameter={a * R_I / 32}"))
    yield Run("mu-i-small", 2.0, 0.005, material("mu-i", f"{GRAINS}, grain_diameter={2.0 * R_I / 320}"))
    yield Run("mu-i-constant", 2.0, 0.005, material("mu-i", f"{CONSTANT}, grain_diameter=0.001"))


def refined() -> Iterator[Run]:
    """Runout with mu(I) over a on finer grids."""
    for h in (0.0035, 0.0025, 0.0018):
        for a in (0.5, 1.0, 2.0, 5.0):
            law = material("mu-i", f"{GRAINS}, grain_diameter={a * R_I / 32}")
            yield Run(f"mu-i-a{a:g}-{1e3 * h:g}mm", a, h, law)


GROUPS = {"strength": strength, "scatter": scatter, "cohesion": cohesion, "grains": grains, "refined": refined}


def main() -> None:
    """Run the groups and print runout and height."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("groups", nargs="*", metavar="GROUP", help=f"{', '.join(GROUPS)}; default: all")
    options = parser.parse_args()
    for group in options.groups or GROUPS:
        for name, a, h, law, cfl in GROUPS[group]():
            values = [*COMMON, f"geometry.aspect={a}", f"grid.spacing={h}", law]
            values += [] if cfl is None else [f"time.cfl={cfl}"]
            summary = mpmcol.run(mpmcol.load_case("coarse-channel", values), options.out / name, threads=1).summary
            zeta = ", ".join(f"{front} {value:.3f}" for front, value in summary["zeta"].items())
            print(f"{name}: a = {a:g}, zeta {zeta}, beta {summary['beta']:.3f}", flush=True)


if __name__ == "__main__":
    main()
