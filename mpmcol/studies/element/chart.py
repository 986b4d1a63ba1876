"""Chart and table of an element test."""

from __future__ import annotations

import csv
import io
from pathlib import Path

from matplotlib.figure import Figure

from mpmcol.case import Case
from mpmcol.io.atomic import atomic_write
from mpmcol.io.columns import header
from mpmcol.io.glossary import ELEMENT
from mpmcol.plotting.figures import Heading, add_heading, save_figure
from mpmcol.studies.element.paths import StrainPath
from mpmcol.studies.element.run import Columns


def write_table(folder: Path, columns: Columns) -> Path:
    """Write element.csv. Raises OutputError."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header(list(columns), ELEMENT))
    writer.writerows(zip(*(values.tolist() for values in columns.values()), strict=True))
    atomic_write(folder / ELEMENT, text.getvalue().encode())
    return folder / ELEMENT


def draw_chart(folder: Path, case: Case, path: StrainPath, columns: Columns) -> list[Path]:
    """Write element.png: stress path, and shear stress or tension and volumetric strain over strain.

    Raises OutputError.
    """
    figure = Figure(figsize=(11.0, 3.8), layout="constrained")
    stress_path, strength, volume = figure.subplots(1, 3)
    kilo = 1e-3
    stress_path.plot(kilo * columns["pressure"], kilo * columns["shear"])
    stress_path.set(xlabel="pressure $p$ (kPa)", ylabel=r"shear stress $\sqrt{J_2}$ (kPa)")
    stress_path.plot(kilo * columns["pressure"][-1], kilo * columns["shear"][-1], "o")
    is_tension = path.measures == "tension"
    strength.plot(100.0 * columns["strain"], kilo * (-columns["pressure"] if is_tension else columns["shear"]))
    label = "mean tension $-p$ (kPa)" if is_tension else r"shear stress $\sqrt{J_2}$ (kPa)"
    strength.set(xlabel=f"{path.strain} (%)", ylabel=label)
    volume.plot(100.0 * columns["strain"], 100.0 * columns["volumetric_strain"])
    volume.set(xlabel=f"{path.strain} (%)", ylabel="volumetric strain (%), dilation > 0")
    for axes in (stress_path, strength, volume):
        axes.grid(alpha=0.3)
    add_heading(strength, Heading(f"{case.material.law}: {path.description}", case.title))
    return save_figure(figure, folder / "element.png", svg=False)
