"""Values proposed for a case, with those that they require: advice causes no warning that the case does not have."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from mpmcol.case import Case, load_case
from mpmcol.errors import CaseError, UsageError
from mpmcol.setup.discretization import discretize
from mpmcol.setup.time_step import case_limit, rounded_down
from mpmcol.setup.unfit_settings import kind_of
from mpmcol.studies.definition import Value, as_overrides

Values = Mapping[str, Value]


def completed(source: str | Path, overrides: Sequence[str], values: Values) -> dict[str, Value] | None:
    """Values to replace in a case, with base thickness and time step that fit them.

    Returns None if the case would then be refused, or have warnings of a kind that it has not without them.
    """
    known = _kinds(load_case(source, overrides))
    try:
        proposed = load_case(source, [*overrides, *as_overrides(values)])
        whole = dict(values) | _whole_base(proposed) | _stable_step(proposed)
        return whole if _kinds(load_case(source, [*overrides, *as_overrides(whole)])) <= known else None
    except (CaseError, UsageError):  # other values of the case contradict the proposed ones
        return None


def _whole_base(case: Case) -> dict[str, Value]:
    """The thickness of the elastic base in whole cells, where it is not."""
    given, used = case.geometry.base_thickness, discretize(case).base
    return {} if used in (0.0, given) else {"geometry.base_thickness": used}


def _stable_step(case: Case) -> dict[str, Value]:
    """The largest stable time.cfl with two digits, where that of the case is larger."""
    limit, _ = case_limit(case)
    return {"time.cfl": rounded_down(limit)} if 0.01 <= limit < case.time.cfl else {}


def _kinds(case: Case) -> set[str]:
    """Kinds of the warnings of a case."""
    return {kind_of(warning) for warning in discretize(case).warnings}
