"""The checks. To add one, add an entry; write down its band, with the source, before anything is run.

Runouts are measured by `front_height`, which like the experiments leaves out single grains detached from the deposit.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import radians, tan

from mpmcol.experiments import find_experiment, mark
from mpmcol.studies.validation.chart import draw_rods, draw_shape
from mpmcol.studies.validation.check import Band, Check, Column, Measure
from mpmcol.studies.validation.measures import (
    ROD,
    RODS,
    SURFACE,
    column_of,
    rods_failure,
    rods_front,
    rods_surface,
    shape_rms,
    undisturbed_ratio,
)

CHANNEL, CYLINDER = "channel", "cylinder"
HEIGHT_SCATTER = 0.05  # relative; packings of the experiments dilate by 5 to 10 %
LONG_DOMAIN = "1.5"  # m, so that runouts that are too long can be measured
SLIP, REPOSE = 59.0, 29.5  # degrees: inner cone of Lube et al. 2004, steepest slope at rest of Lube et al. 2005
LAW_QUANTITIES: dict[str, tuple[str, str, Measure]] = {  # description, unit, measure
    "zeta": ("runout zeta", "", column_of("zeta.front_height")),
    "beta": ("height beta", "", column_of("beta")),
    "stop_time": ("time at which the front stops", "sqrt(h_i/g)", column_of("stop_time")),
}


def law_check(name: str, experiment: str, quantity: str, column: Column, controls: Mapping[str, Column]) -> Check:
    """Make the check of a quantity against a law and its scatter.

    Raises ValueError if the experiment has no law for the quantity at the aspect ratio of the column.
    """
    published = find_experiment(experiment, "axisymmetric" if column.case == CYLINDER else "plane")
    law, expected = published.law(quantity), published.expected(quantity, column.a)
    if law is None or expected is None:
        raise ValueError(f"{experiment} has no {quantity} at a = {column.a:g}")
    description, unit, measure = LAW_QUANTITIES[quantity]
    value, scatter = expected
    notes = "; ".join(filter(None, (f"scatter: {law.scatter_source}", law.note)))
    title = f"{published.title}, doi:{published.doi}{mark(law.verified)}"
    source = f"{value:.3g} +- {100.0 * law.scatter:.0f} %, {title} ({notes})"
    band = Band(value - scatter, value + scatter, source, law.verified)
    return Check(name, experiment, f"{description}, a = {column.a:g}", unit, column, measure, band, controls)


def wrong_friction(column: Column, *degrees: float) -> dict[str, Column]:
    """Return the column with friction angles that are not those of the material."""
    long = column.with_values(geometry__domain_length=LONG_DOMAIN)
    return {f"friction {angle:g} deg": long.with_values(material__friction_deg=f"{angle}") for angle in degrees}


def slow_gate(column: Column) -> dict[str, Column]:
    """Return the column with a gate that opens too slowly."""
    return {"gate lifted at 0.3 m/s": column.with_values(stages__gate_speed="0.3")}


rods = Column("bui-rods", 0.5, h=0.0025, quick_h=0.005)
wrong_rods = wrong_friction(rods, 14.0, 25.0)
channel_05, channel_1, channel_3 = (Column(CHANNEL, a, h=0.002, quick_h=0.0045) for a in (0.5, 1.0, 3.0))
cylinder_055, cylinder_09 = (Column(CYLINDER, a, h=0.0025, quick_h=0.0035) for a in (0.55, 0.9))
cylinder_275 = Column(CYLINDER, 2.75, h=0.0025, quick_h=0.005)

CHECKS: tuple[Check, ...] = (
    Check(
        "rods-surface", RODS.name, "surface, RMS difference in height", "mm", rods, rods_surface,
        Band(
            0.0, 1e3 * ROD, f"diameter of a rod, the resolution of the surface (not read in doi:{RODS.doi})",
            verified=False,
        ),
        wrong_rods, draw_rods,
    ),
    Check(
        "rods-front", RODS.name, f"front, where the surface is {1e3 * SURFACE.y[-1]:g} mm high", "mm", rods, rods_front,
        Band(970.0 * SURFACE.x[-1], 1030.0 * SURFACE.x[-1], f"outermost digitised point +- 3 %; doi:{RODS.doi}"),
        wrong_rods,
    ),
    Check(
        "rods-failure", RODS.name, "failure line, RMS of the shortest distances", "mm", rods, rods_failure,
        Band(0.0, 1e3 * HEIGHT_SCATTER * 0.1, f"5 % of the column's height; doi:{RODS.doi}"),
        wrong_rods,
    ),
    law_check("channel-runout-short", "lube-2007", "zeta", channel_1, wrong_friction(channel_1, 22.0, 45.0)),
    law_check("channel-runout-tall", "lube-2007", "zeta", channel_3, wrong_friction(channel_3, 22.0, 45.0)),
    law_check("channel-height-short", "lube-2007", "beta", channel_1, wrong_friction(channel_1, 15.0)),
    law_check("channel-height-tall", "lube-2005", "beta", channel_3, wrong_friction(channel_3, 22.0, 45.0)),
    law_check("channel-stop", "lube-2007", "stop_time", channel_3, slow_gate(channel_3)),
    Check(
        "channel-shape", "lube-2005", "a = 3: RMS difference from the universal shape over height", "",
        channel_3, shape_rms,
        Band(0.0, HEIGHT_SCATTER, "5 % of the height, as much as dilation; doi:10.1103/PhysRevE.72.041301"),
        {"a = 0.5, whose top stays flat": channel_05},
        draw_shape,
    ),
    law_check("cylinder-runout-short", "lube-2004", "zeta", cylinder_09, wrong_friction(cylinder_09, 20.0, 45.0)),
    law_check("cylinder-runout-tall", "lube-2004", "zeta", cylinder_275, wrong_friction(cylinder_275, 22.0, 45.0)),
    law_check("cylinder-height-short", "lube-2004", "beta", cylinder_055, wrong_friction(cylinder_055, 15.0)),
    law_check("cylinder-height-tall", "lube-2004", "beta", cylinder_275, wrong_friction(cylinder_275, 22.0, 45.0)),
    law_check("cylinder-stop", "lube-2004", "stop_time", cylinder_275, slow_gate(cylinder_275)),
    Check(
        "cylinder-top-stays", "lube-2004", "a = 0.55: undisturbed radius over r_i", "", cylinder_055, undisturbed_ratio,
        Band(
            1.0 - 0.55 / tan(radians(REPOSE)), 1.0 - 0.55 / tan(radians(SLIP)),
            f"lines from the foot at the angle of repose, {REPOSE:g} deg, and at that of the cone that remains, "
            f"{SLIP:g} deg; doi:10.1017/S0022112004009036",
        ),
        {"a = 0.9": cylinder_09},
    ),
    Check(
        "cylinder-top-goes", "lajeunesse-2004", "a = 0.9: undisturbed radius over r_i", "", cylinder_09,
        undisturbed_ratio, Band(0.0, 0.05, "a cone, not a truncated one, above a = 0.74; doi:10.1063/1.1736611"),
        {"a = 0.55": cylinder_055},
    ),
)  # fmt: skip
