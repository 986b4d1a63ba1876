"""Flow on an inclined base: the slope on which it does not stop, and how much farther and longer it flows below that.

A layer of height h that moves down a slope th decelerates by g cos(th) (tan(delta) - tan(th)), with tan(delta) the
friction that the material mobilises in shear. Runout and duration therefore grow by about
tan(delta) / (tan(delta) - tan(th)) over those on a horizontal base; from th = delta on, nothing stops the flow.
"""

from __future__ import annotations

from math import atan, degrees, inf, radians, tan
from typing import Any

LARGEST_FACTOR = 5.0
BED, FLOOR = "the bed", "the floor"
ENDLESS_REMEDY = (
    'set a smaller geometry.slope_deg, or stages.collapse.end = "time" with the duration of interest as '
    "stages.collapse.max_time_factor"
)


def mobilised_friction(material: Any, floor: float | None = None) -> float:
    """Ratio of shear to normal stress of a layer in shear, tan(delta), or that of a floor with less friction.

    inf for a law without a yield surface. floor: coefficient of Coulomb friction; None without slip.
    """
    return min(float(getattr(material, "mobilised_friction", inf)), inf if floor is None else floor)


def slope_factor(slope_deg: float, material: Any, floor: float | None = None) -> float:
    """Runout and duration over those on a horizontal base, at most LARGEST_FACTOR."""
    slope, friction = tan(radians(slope_deg)), mobilised_friction(material, floor)
    if slope >= friction * (1.0 - 1.0 / LARGEST_FACTOR):
        return LARGEST_FACTOR if slope > 0.0 else 1.0
    return 1.0 / (1.0 - slope / friction)


def flow_materials(case: Any) -> dict[str, Any]:
    """Materials that the flow shears, by their names in messages: those of the column and of a granular bed."""
    layers = {f"layer {number}": layer.material for number, layer in enumerate(case.layers, 1)}
    bed = {BED: case.base_material} if case.geometry.base == "granular" else {}
    return {"the material": case.material, **layers, **bed}


def case_slope_factor(case: Any) -> float:
    """`slope_factor` of the weakest material of a case, or of its floor."""
    slope, floor = case.geometry.slope_deg, case.friction.floor
    return max(slope_factor(slope, material, floor) for material in flow_materials(case).values())


def limit_slope_deg(material: Any, floor: float | None = None) -> float:
    """The slope from which on the material does not stop, delta, degrees; 90 with cohesion, which stops thin layers."""
    is_cohesive = floor is None and getattr(material, "cohesion", 0.0) > 0.0
    return 90.0 if is_cohesive else degrees(atan(mobilised_friction(material, floor)))


def endless_flow(case: Any) -> str:
    """Why the flow of a case does not stop, by its weakest part; "" if it stops."""
    slope, floor = case.geometry.slope_deg, case.friction.floor
    limits = {name: limit_slope_deg(material) for name, material in flow_materials(case).items()}
    if floor is not None:
        limits[FLOOR] = degrees(atan(floor))
    weakest = min(limits, key=lambda name: limits[name])
    if slope < limits[weakest] or slope == 0.0:
        return ""
    moving = "bed and column flow on and do" if weakest == BED else "the flow does"
    friction = "friction angle of the floor is" if weakest == FLOOR else f"friction of {weakest} in shear is"
    law = "" if weakest == FLOOR else ", atan(sin(phi)) without dilatancy"
    return (
        f"geometry.slope_deg = {slope:g}: {moving} not stop on this slope, since the {friction} "
        f"{limits[weakest]:.3g} degrees{law}"
    )


def remedy_of_motion(case: Any) -> str:
    """What lets a column come to rest that still moved at the end of a run, with the cost; "" if its end was a time."""
    if case.stages.collapse.end == "time":
        return ""
    if cause := endless_flow(case):
        return f"{cause}; {ENDLESS_REMEDY}"
    return (
        f"stages.collapse.max_time_factor = {2.0 * case.stages.collapse.max_time_factor:g} allows twice as many steps"
    )
