"""Titles of cases, with the model and the aspect ratio as resolved."""

from __future__ import annotations

import re

from mpmcol.case.schema import Case

MODELS = {"plane": "plane strain", "axisymmetric": "axisymmetric", "quarter": "3D quarter model", "full": "3D model"}
_ASPECT = re.compile(r"(?:, *+|(?<![ ,]) ++)?\ba = (\d++(?:\.\d++)?)")


def title_of(case: Case) -> str:
    """The title of a case with its aspect ratio, which an override may have changed."""
    geometry = case.geometry
    return run_title(case.title, geometry.model, geometry.a if geometry.polygon is None else None)


def run_title(title: str, model: str, a: float | None) -> str:
    """A title with the aspect ratio of the column instead of the one that it had; without one, the name of the model.

    a: None if the column is no rectangle.
    """
    return (title_without_aspect(title) or MODELS[model]) + ("" if a is None else f", a = {a:.3g}")


def with_own_aspect(case: Case) -> Case:
    """The case with its aspect ratio in the title, if that states another one: of a case that it extends."""
    stated = _ASPECT.search(case.title)
    a = None if case.geometry.polygon is not None else f"{case.geometry.a:.3g}"
    if stated is None or (a is not None and f"{float(stated[1]):.3g}" == a):
        return case
    return case.model_copy(update={"title": title_of(case)})


def title_without_aspect(title: str) -> str:
    """A title for several aspect ratios."""
    return _ASPECT.sub("", title)
