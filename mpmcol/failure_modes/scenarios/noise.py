"""Noise of the stresses between the points of a cell: pressures, local damping, locking of clay."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from mpmcol.failure_modes.problems.collapse import collapsed
from mpmcol.failure_modes.scenario import Observation, Scenario, failing, passing

SAND = ("coarse-channel", "grid.spacing=0.01")
PLAIN, FILTERED = "method.stress_filter=none", "method.stress_filter=flow"
CLAY = (
    "channel",
    *("geometry.radius=12", "geometry.aspect=0.8", "geometry.base_thickness=1.2", "grid.spacing=0.6"),
    *("material.friction_deg=0.01", "material.cohesion=35 kPa", "material.poissons_ratio=0.45"),
)
NO_LARGER_THAN_WEIGHT = "at rest no pressure exceeds the weight of the material above by much; chosen here: 1.2"


def excess_damping(*case: str) -> Observation:
    """Energy that local damping took, over what it takes from a smooth flow."""
    shares = collapsed(*case).dissipation
    return Observation(shares["damping"] / shares["smooth_damping"], f"{100.0 * shares['damping']:.1f} % of the energy")


def largest_pressure(*case: str) -> Observation:
    """Largest pressure of a deposit over the weight at its foot."""
    stress = collapsed(*case).stress
    note = f"percentile 1: {stress['pressure_p1']:.2f}, stress-free: {100.0 * stress['stress_free']:.0f} %"
    return Observation(stress["pressure_max"], note)


def _noise(
    name: str, mechanism: str, measure: Callable[..., Observation], metric: str, bound: float, source: str,
    column: tuple[str, ...] = SAND, slow: bool = False,
) -> Scenario:  # fmt: skip
    """A column that fails without the stress filter and passes with it."""
    return Scenario(
        name=name,
        mechanism=mechanism,
        metric=metric,
        bound=bound,
        source=source,
        remedy="method.stress_filter = flow (default)",
        trials=(
            failing("no filter", partial(measure, *column, PLAIN)),
            passing("stress filter", partial(measure, *column, FILTERED), default=True),
        ),
        slow=slow,
    )


PRESSURE = largest_pressure, "largest pressure of a deposit over the weight at its foot", 1.2, NO_LARGER_THAN_WEIGHT
SCENARIOS = (
    _noise(
        "noise-damping",
        "Stresses that differ between the points of a cell accelerate the nodes at random; local damping takes energy "
        "from every oscillation.",
        excess_damping,
        "energy taken by local damping, over 2 alpha_d times the largest kinetic energy",
        3.0,
        "chosen here; a smooth flow has 1",
    ),
    _noise(
        "noise-pressure",
        "Points of sand yield and open one by one: in a deposit most are stress-free, others carry a multiple of the "
        "weight above.",
        *PRESSURE,
    ),
    _noise(
        "noise-clay",
        "Plastic flow of clay conserves volume, but the grid cannot represent that at every point: volumetric locking.",
        *PRESSURE,
        column=CLAY,
        slow=True,
    ),
)
