"""Friction and positions of walls that are known to be unfit; the checks are entries of `unfit_settings.CHECKS`."""

from __future__ import annotations

from collections.abc import Iterator
from math import atan, degrees, inf, radians, sin
from typing import Any

from mpmcol.case import Case
from mpmcol.setup.domain import expected_front

GATE_CELLS = 2


def rough_floor(case: Case, h: float) -> str | None:
    """The column yields before it slides on the floor; Mohr-Coulomb without dilatancy mobilises sin(phi) in shear."""
    floor, (mobilised, text) = case.friction.floor, _shear_strength(case)
    if floor is None or mobilised == 0.0 or floor < mobilised:
        return None
    return (
        f"friction.floor = {floor:.4g} ({degrees(atan(floor)):.3g} degrees): the column shears at {text} of the "
        "pressure before it slides, nearly as on a floor without slip, with runouts up to 10 % longer; set less than "
        f"{mobilised:.3g}, or omit it"
    )


def rough_wall(case: Case, h: float) -> str | None:
    """The same on the faces of walls, where it has no other effect than the smallest such friction."""
    mobilised, text = _shear_strength(case)
    for wall in case.walls:
        if wall.friction >= mobilised > 0.0:
            return (
                f"walls: friction = {wall.friction:.4g} of {wall.name}: the material shears at {text} of the pressure "
                f"before it slides, as on a rough wall; set less than {mobilised:.3g}"
            )
    return None


def _shear_strength(case: Case) -> tuple[float, str]:
    """Largest ratio of shear to normal stress of the column without cohesion, and its text; inf without a yield."""
    for name, ratio in _coefficients(case.material):
        return ratio, f"{name} = {ratio:.3g}"
    return inf, ""


def _coefficients(material: Any) -> Iterator[tuple[str, float]]:
    """The largest friction coefficient of a law and its name; nothing for a law without friction."""
    if hasattr(material, "mu_2"):
        yield "mu_2", material.mu_2
    elif hasattr(material, "match"):  # Drucker-Prager, with the coefficient that its angle is matched to
        yield "mu", material.mobilised_friction
    elif angles := [value for name, value in material if name.startswith("friction_")]:
        yield f"sin({max(angles):g} degrees)", sin(radians(max(angles)))


def wall_at_gate(case: Case, h: float) -> str | None:
    """Nodes within two cells of the column receive the pressure on the gate."""
    for wall in case.walls:
        if case.stages.gate and (gap := wall.from_ - case.geometry.r_i) < GATE_CELLS * h and wall.from_ > 0.0:
            return (
                f"walls: from = {wall.from_:g} m of {wall.name} is {max(gap, 0.0) / h:.2g} cells from the column: "
                "before the release it carries a part of the force on the gate; set "
                f"{case.geometry.r_i + GATE_CELLS * h:.4g} m or more, or stages.gate = false"
            )
    return None


def wall_out_of_reach(case: Case, h: float) -> str | None:
    """The flow ends before a wall beyond the longest runout among the experiments."""
    for wall in case.walls:
        if min(abs(wall.from_), abs(wall.to or wall.from_)) > (front := expected_front(case)):
            return (
                f"walls: from = {wall.from_:g} m of {wall.name} is beyond the expected front at {front:.4g} m, and the "
                f"flow may not reach it; set less than {front:.4g} m"
            )
    return None
