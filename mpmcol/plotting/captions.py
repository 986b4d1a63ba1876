"""Titles, captions and names of runs, from their resolved cases."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from mpmcol.case import Case
from mpmcol.case.fields import number_of
from mpmcol.case.reference import field_at
from mpmcol.case.values import leaf_values
from mpmcol.io.results import Results
from mpmcol.measure import ColumnShape
from mpmcol.plotting.figures import Heading
from mpmcol.units import length_text

MODELS = {"plane": "plane strain", "axisymmetric": "axisymmetric", "quarter": "3D quarter model", "full": "3D model"}
LAWS = {"mohr-coulomb": "Mohr-Coulomb", "mohr-coulomb-softening": "softening Mohr-Coulomb", "elastic": "elastic"}
MOST_KEYS = 2  # in the name of a run
_ASPECT = re.compile(r",? *\ba = \d+(\.\d+)?")


def heading_of(case: Case, shape: ColumnShape) -> Heading:
    """The title of the case with the aspect ratio as resolved, and model, size, grid and material below it."""
    return Heading(run_title(case.title, shape), ", ".join(_parameters(case, shape)))


def common_heading(title: str, runs: Sequence[tuple[Case, ColumnShape]]) -> Heading:
    """A title without an aspect ratio, and the parameters that all runs have in common."""
    parameters = [_parameters(*run) for run in runs]
    return Heading(_ASPECT.sub("", title), ", ".join(p for p in parameters[0] if all(p in own for own in parameters)))


def run_title(title: str, shape: ColumnShape) -> str:
    """The title of a case with the aspect ratio of the column, which may differ from the one that the title had."""
    return f"{_ASPECT.sub('', title) or MODELS[shape.model]}, a = {shape.a:.3g}"


def _parameters(case: Case, shape: ColumnShape) -> list[str]:
    per_cell = round((shape.spacing / shape.point_size) ** shape.dimension)
    sizes = {"r_i": shape.r_i, "h_i": shape.h_i, "h": shape.spacing}
    lengths = [f"${name}$ = {length_text(value)}" for name, value in sizes.items()]
    return [MODELS[shape.model], *lengths, f"{per_cell} points per cell", material_text(case)]


def material_text(case: Case) -> str:
    """Constitutive law and friction angle; of a softening law from peak to residual."""
    material = case.material
    name = LAWS.get(material.law, material.law)
    peak = getattr(material, "friction_peak_deg", None)
    friction = getattr(material, "friction_deg", None) or getattr(material, "friction_residual_deg", None)
    if friction is None:
        return name
    angle = f"{peak:g} to {friction:g}" if peak else f"{friction:g}"
    return rf"{name}, $\varphi$ = {angle}$\degree$"


def run_names(runs: Sequence[Results]) -> list[str]:
    """Names by the one or two keys of the cases that differ, else by folders; paths where folders share a name."""
    values = [leaf_values(run.case) for run in runs]
    keys = dict.fromkeys(key for one in values for key in one if not key.startswith(("title", "output.", "score.")))
    differing = [key for key in keys if len({str(one.get(key)) for one in values}) > 1]
    if 1 <= len(differing) <= MOST_KEYS:
        names = [", ".join(_value_text(key, one.get(key)) for key in differing) for one in values]
        if len(set(names)) == len(names):
            return names
    folders = [run.folder.resolve().name for run in runs]
    return folders if len(set(folders)) == len(folders) else [str(run.folder) for run in runs]


def _value_text(key: str, value: Any) -> str:
    number, name = number_of(field_at(tuple(key.split(".")), "")), key.rpartition(".")[2]
    if isinstance(value, float) and number and number.unit == "m":
        return f"{name} = {length_text(value)}"
    unit = f" {number.unit}" if number and number.unit and value is not None else ""
    return f"{name} = {value:.6g}{unit}" if isinstance(value, float) else f"{name} = {value}{unit}"
