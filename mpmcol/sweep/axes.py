"""The axes of a sweep from the options of the command line."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from mpmcol.case import Problem
from mpmcol.case.problem import set_option
from mpmcol.sweep.ranges import Axis, parse_values
from mpmcol.sweep.runs import ASPECT


def parse_axes(aspect: str | None, settings: Sequence[str]) -> tuple[list[Axis], list[Problem]]:
    """Axes from the values of --aspect and the KEY=VALUES of --set, and what is wrong with the others."""
    axes: dict[str, Axis] = {}
    problems: list[Problem] = []
    for place, key, text in _given(aspect, settings):
        try:
            if not (key and text):
                raise ValueError("expected KEY=VALUES, for example material.friction_deg=30,33,36")
            if key in axes:
                raise ValueError(f"{key} is given twice")
            axes[key] = Axis(key, parse_values(text))
        except ValueError as wrong:
            problems.append(Problem(place, None, key, str(wrong), ""))
    if not axes and not problems:
        hint = "give --aspect 0.5:7, or --set material.friction_deg=30,33,36"
        problems.append(Problem("mpmcol sweep", None, "", "there is nothing to vary", hint))
    return list(axes.values()), problems


def _given(aspect: str | None, settings: Iterable[str]) -> Iterable[tuple[str, str, str]]:
    """Where it was given, key and values."""
    if aspect is not None:
        yield f"--aspect {aspect}", ASPECT, aspect.strip()
    for setting in settings:
        key, _, text = setting.partition("=")
        yield set_option(setting), ".".join(part.strip() for part in key.split(".")), text.strip()
