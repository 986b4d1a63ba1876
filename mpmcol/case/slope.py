"""Flow on an inclined base: the slope on which it does not stop, and how much farther and longer it flows below that.

A layer of height h that moves down a slope th decelerates by g cos(th) (tan(delta) - tan(th)), with tan(delta) the
friction that the material mobilises in shear. Runout and duration therefore grow by about
tan(delta) / (tan(delta) - tan(th)) over those on a horizontal base; from th = delta on, nothing stops the flow.
"""

from __future__ import annotations

from math import atan, degrees, inf, radians, tan
from typing import Any

LARGEST_FACTOR = 5.0
ENDLESS_REMEDY = (
    'set a smaller geometry.slope_deg, or stages.collapse.end = "time" with the duration of interest as '
    "stages.collapse.max_time_factor"
)


def mobilised_friction(material: Any) -> float:
    """Ratio of shear to normal stress of a layer in shear, tan(delta); inf for a law without a yield surface."""
    return float(getattr(material, "mobilised_friction", inf))


def slope_factor(slope_deg: float, material: Any) -> float:
    """Runout and duration over those on a horizontal base, at most LARGEST_FACTOR."""
    return 1.0 / max(1.0 - tan(radians(slope_deg)) / mobilised_friction(material), 1.0 / LARGEST_FACTOR)


def limit_slope_deg(material: Any) -> float:
    """The slope from which on the material does not stop, delta, degrees; 90 with cohesion, which stops thin layers."""
    return 90.0 if getattr(material, "cohesion", 0.0) else degrees(atan(mobilised_friction(material)))


def endless_flow(case: Any) -> str:
    """Why the flow of a case does not stop; "" if it stops."""
    slope, limit = case.geometry.slope_deg, limit_slope_deg(case.material)
    if slope < limit:
        return ""
    return (
        f"geometry.slope_deg = {slope:g}: the flow does not stop on this slope, since the friction of the material in "
        f"shear is {limit:.3g} degrees, atan(sin(phi)) without dilatancy"
    )
