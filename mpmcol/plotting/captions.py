"""Titles, captions and names of runs, from their resolved cases."""

from __future__ import annotations

import contextlib
import tomllib
from collections.abc import Mapping, Sequence
from typing import Any

from mpmcol.case import Case
from mpmcol.case.fields import number_of
from mpmcol.case.geometry import GeometryTable
from mpmcol.case.reference import field_at
from mpmcol.case.title import MODELS, run_title, title_without_aspect
from mpmcol.case.values import leaf_values
from mpmcol.experiments import OUTLINE, Experiment
from mpmcol.io.results import Results
from mpmcol.io.snapshot import Meta
from mpmcol.measure import ColumnShape
from mpmcol.measure.shape import AZIMUTHS
from mpmcol.plotting.figures import Heading
from mpmcol.units import counted, length_text, pressure_text

LENGTHS = {"r_i": "r_i", "h_i": "h_i", "h": "spacing"}  # symbols
NAMES = {  # of the laws
    "mohr-coulomb": "Mohr-Coulomb",
    "mohr-coulomb-softening": "Mohr-Coulomb with softening",
    "mohr-coulomb-random": "Mohr-Coulomb, random field",
    "drucker-prager": "Drucker-Prager",
    "mu-i": r"$\mu(I)$",
}
SYMBOLS = {r"\varphi": "φ", r"\degree": "°", r"\mu": "μ", "$": ""}  # outside of charts
FRICTION = ("friction_deg", "friction_peak_deg", "friction_residual_deg")
COHESION = ("cohesion", "cohesion_residual")
MOST_KEYS = 2  # in the name of a run
OUTLINE_KEY = "geometry.outline"  # too long for a name
PARTS = ("base_material.", "layers.", "walls.")  # whose keys have the names of keys of the column
DERIVED = ("stages.k0", "stages.collapse.max_time_factor")  # by default from friction angle and slope


def heading_of(case: Case, shape: ColumnShape) -> Heading:
    """The title of the case with the aspect ratio as resolved, and model, size, grid and material below it."""
    title = run_title(case.title, shape.model, shape.rectangle_a)
    return Heading(title, ", ".join(_parameters(vars(shape), _tables(case))))


def heading_of_snapshot(meta: Meta) -> Heading:
    """As `heading_of`, from the metadata of a snapshot."""
    case = tables_of_snapshot(meta)
    a = None if meta.get("section") == OUTLINE else float(meta["h_i"]) / float(meta["r_i"])
    title = run_title(str(meta["title"]), str(meta["model"]), a)
    return Heading(title, ", ".join(_parameters(meta, case)))


def tables_of_snapshot(meta: Meta) -> dict[str, Any]:
    """Tables of the resolved case in the metadata of a snapshot; empty if another program wrote it."""
    with contextlib.suppress(tomllib.TOMLDecodeError):
        return tomllib.loads(str(meta.get("case", "")))
    return {}


def geometry_of_snapshot(meta: Meta) -> GeometryTable:
    """The table geometry of the resolved case; with defaults if another program wrote the snapshot."""
    return GeometryTable(**{"model": meta["model"], **tables_of_snapshot(meta).get("geometry", {})})


def common_heading(title: str, runs: Sequence[tuple[Case, ColumnShape]]) -> Heading:
    """A title without an aspect ratio, and the parameters that all runs have in common."""
    parameters = [_parameters(vars(shape), _tables(case)) for case, shape in runs]
    return Heading(
        title_without_aspect(title), ", ".join(p for p in parameters[0] if all(p in own for own in parameters))
    )


def noted(heading: Heading, experiment: Experiment) -> Heading:
    """A heading with the reason why no experiment is drawn."""
    return heading if experiment.laws else heading._replace(note=experiment.title)


def _parameters(shape: Mapping[str, Any], case: Mapping[str, Any]) -> list[str]:
    """Texts for the model, the slope, the column, the grid, the material and the floor; case: its tables."""
    dimension = 3 if shape["model"] in AZIMUTHS else 2
    per_cell = round((float(shape["spacing"]) / float(shape["point_size"])) ** dimension)
    lengths = [f"${name}$ = {length_text(float(shape[key]))}" for name, key in LENGTHS.items()]
    slope = float(shape.get("slope_deg", 0.0))
    inclined = [rf"base inclined by {slope:g}$\degree${' along x' if dimension == 3 else ''}"] if slope else []
    return [MODELS[shape["model"]], *inclined, *lengths, f"{per_cell} points per cell", *_material_text(case)]


def material_text(case: Case) -> str:
    """Law, friction angle and cohesion of the column and friction of the floor, without mathematical markup."""
    text = ", ".join(_material_text(_tables(case)))
    for symbol, letter in SYMBOLS.items():
        text = text.replace(symbol, letter)
    return text


def _tables(case: Case) -> dict[str, Any]:
    return {"material": case.material.model_dump(), "friction": case.friction.model_dump(), "layers": case.layers}


def _material_text(case: Mapping[str, Any]) -> list[str]:
    """Law, friction angle and cohesion (of a softening law from peak to residual), number of layers of other materials
    and friction of the floor if there are any.
    """
    material, floor, layers = case.get("material", {}), case.get("friction", {}).get("floor"), case.get("layers", ())
    if "law" not in material:
        return []
    name = NAMES.get(law := str(material["law"]), law)
    angles = [f"{material[key]:g}" for key in FRICTION if material.get(key) is not None]
    variation = material.get("friction_variation")
    cohesion = [material[key] for key in COHESION if material.get(key) is not None]
    return [
        rf"{name}, $\varphi$ = {' to '.join(angles)}$\degree$" if angles else name,
        *([] if variation is None else [rf"tan $\varphi$ varies by {100.0 * variation:.3g} %"]),
        *([f"$c$ = {' to '.join(map(pressure_text, cohesion))}"] if any(cohesion) else []),
        *([f"{counted(len(layers), 'layer')} of other material"] if layers else []),
        *([] if floor is None else [rf"floor $\mu$ = {floor:.3g}"]),
    ]


def run_names(runs: Sequence[Results]) -> list[str]:
    """Names by the one or two keys of the cases that differ, else by folders; paths where folders share a name."""
    values = [leaf_values(run.case) for run in runs]
    keys = dict.fromkeys(key for one in values for key in one if not key.startswith(("title", "output.", "score.")))
    differing = [key for key in keys if len({str(one.get(key)) for one in values}) > 1]
    differing = [key for key in differing if key not in DERIVED] or differing
    if 1 <= len(differing) <= MOST_KEYS and OUTLINE_KEY not in differing:
        names = [", ".join(_value_text(key, one.get(key)) for key in differing) for one in values]
        if len(set(names)) == len(names):
            return names
    folders = [run.folder.resolve().name for run in runs]
    return folders if len(set(folders)) == len(folders) else [str(run.folder) for run in runs]


def _value_text(key: str, value: Any) -> str:
    number, name = number_of(field_at(tuple(key.split(".")), "")), key.rpartition(".")[2]
    if key.startswith(PARTS):
        name = key
    if isinstance(value, float) and number and number.unit == "m":
        return f"{name} = {length_text(value)}"
    unit = f" {number.unit}" if number and number.unit and value is not None else ""
    return f"{name} = {value:.6g}{unit}" if isinstance(value, float) else f"{name} = {value}{unit}"
