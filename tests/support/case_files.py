"""Case files for tests, and the problems that loading them reports."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from mpmcol.case import Problem, load_case
from mpmcol.errors import CaseError

Write = Callable[..., Path]

GOOD = """\
schema = 1
title = "test"

[geometry]
model = "plane"
radius = 0.09
aspect = 3.0

[grid]
spacing = 0.002

[material]
law = "mohr-coulomb"
density = 2650.0
youngs_modulus = 10e6
poissons_ratio = 0.2
friction_deg = 33.0
"""


def error_of(source: str | Path, *overrides: str) -> CaseError:
    with pytest.raises(CaseError) as raised:
        load_case(source, overrides)
    return raised.value


def problems_of(source: str | Path, *overrides: str) -> list[Problem]:
    return list(error_of(source, *overrides).problems)


def only_problem(source: str | Path, *overrides: str) -> Problem:
    problems = problems_of(source, *overrides)
    assert len(problems) == 1, "\n".join(map(str, problems))
    return problems[0]
