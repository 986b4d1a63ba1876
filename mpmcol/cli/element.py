"""`mpmcol element`: element test of the law of a case."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mpmcol.cli.options import Positive, out_option, overrides_option

if TYPE_CHECKING:
    from mpmcol.studies.element.run import Columns

STILL_ELASTIC = 0.9  # slope of the shear stress at the end over that at the start, of a material that did not yield
TESTS = ("plane-strain", "triaxial", "shear", "extension")


@click.command()
@click.argument("case")
@overrides_option
@click.option("--test", type=click.Choice(TESTS), default=TESTS[0], show_default=True, help="Strain path.")
@click.option(
    "--pressure",
    metavar="VALUE",
    type=Positive("Pa", "20000 or '20 kPa'"),
    help="Initial pressure, Pa or with a unit  [default: rho g h_i]",
)
@click.option(
    "--strain", metavar="VALUE", type=Positive("", "0.05 or 5%", most=10.0), default=0.05, show_default=True,
    help="Strain at the end: vertical, shear or volumetric; at most 10.",
)  # fmt: skip
@click.option(
    "--steps", metavar="N", type=click.IntRange(10, 1_000_000), default=1000, show_default=True, help="Number of steps."
)
@click.option(
    "--rate", metavar="VALUE", type=Positive("", "1"), default=1.0, show_default=True, help="Rate of the strain, 1/s."
)
@out_option("elements/CASE-TEST")
def element(
    case: str,
    overrides: tuple[str, ...],
    test: str,
    pressure: float | None,
    strain: float,
    steps: int,
    rate: float,
    out: Path | None,
) -> None:
    """Element test of the law of a case under a strain path.

    CASE is a TOML file or the name of a shipped case (mpmcol cases). The point starts with an isotropic pressure. The
    tests are plane-strain and triaxial compression at constant lateral stress, simple shear at constant normal stress,
    and isotropic extension. Writes element.csv and element.png: stress path, shear stress and volumetric strain.
    """
    from mpmcol.case import load_case
    from mpmcol.io.atomic import make_folder
    from mpmcol.studies.element.chart import draw_chart, write_table
    from mpmcol.studies.element.paths import PATHS
    from mpmcol.studies.element.run import element_test

    loaded, path = load_case(case, overrides), PATHS[test]
    folder = make_folder(out or Path("elements") / f"{Path(case).stem}-{test}")
    weight = loaded.material.density * loaded.geometry.gravity * loaded.geometry.h_i
    columns = element_test(loaded, path, weight if pressure is None else pressure, strain, steps, rate)
    click.echo(f"{loaded.material.law}: {path.description}, initial pressure {columns['pressure'][0]:.4g} Pa")
    for line in _strength_lines(path.measures, columns, getattr(loaded.material, "cohesion", 0.0) > 0.0):
        click.echo(line)
    click.echo(f"volumetric strain at the end {columns['volumetric_strain'][-1]:.4g}")
    click.echo(write_table(folder, columns))
    for chart in draw_chart(folder, loaded, path, columns):
        click.echo(chart)


def _strength_lines(measures: str, columns: Columns, is_cohesive: bool) -> Iterator[str]:
    """The strength that a test gives, or that the material has not yielded."""
    shear, angle, tension = columns["shear"], columns["mobilised_deg"], -columns["pressure"]
    if measures == "tension":
        largest, last = max(tension.max(), 0.0), max(tension[-1], 0.0)
        if tension[-1] - tension[-2] > STILL_ELASTIC * (tension[1] - tension[0]) > 0.0:
            yield f"no tensile strength up to a mean tension of {last:.4g} Pa; set a larger --strain"
        else:
            yield f"tensile strength (largest mean tension) {largest:.4g} Pa, tension at the end {last:.4g} Pa"
        yield f"opening strain at the end {columns['opening_strain'][-1]:.4g}"
    else:
        largest = columns["max_shear"]
        yield f"largest shear stress (s1 - s3) / 2 {largest.max():.4g} Pa, at the end {largest[-1]:.4g} Pa"
        yield f"largest sqrt(J2) {shear.max():.4g} Pa, at the end {shear[-1]:.4g} Pa"
        part = ", of stresses to which cohesion contributes" if is_cohesive else ""
        yield f"largest mobilised friction angle {angle.max():.4g} deg, at the end {angle[-1]:.4g} deg{part}"
        if shear[-1] - shear[-2] > STILL_ELASTIC * (shear[1] - shear[0]):
            yield "note: the stress rises at the end as it did at the start: no strength yet; set a larger --strain"
