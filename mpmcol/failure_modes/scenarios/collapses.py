"""Collapses on coarse grids: tall columns, stiff and soft sand, slow gates."""

from __future__ import annotations

from functools import partial

from mpmcol.failure_modes.problems.collapse import CollapseResult, collapsed
from mpmcol.failure_modes.scenario import Curve, Observation, Scenario, failing, passing

CASE = "coarse-channel"
COARSE = "grid.spacing=0.01"
NO_FILTER, STIFF = "method.stress_filter=none", "material.youngs_modulus=100 MPa"
SOFT_COLUMN = ("geometry.aspect=20", "grid.spacing=0.015")
TALL = {10: "0.015", 20: "0.015", 35: "0.018"}  # aspect ratio, spacing in m: five or six cells across
OUTLIERS = "distance of the farthest point ahead of front_height, over front_height"
OUTLIERS_BOUND, OUTLIERS_SOURCE = 0.25, "chosen here: 25 %"
SCATTER = "scatter of experiments, 10 % (Bougouin & Lacaze 2018: prefactors 2.7 +- 0.3 and 3.7 +- 0.3)"


def outliers(*overrides: str) -> Observation:
    """Distance of the farthest point ahead of front_height, over front_height."""
    found = collapsed(CASE, *overrides)
    note = f"zeta {found.zeta:.3f}, largest J {found.largest_J:.3f}"
    return Observation(found.front_max / found.front_height - 1.0, note)


def runout_change(*overrides: str) -> Observation:
    """Relative change of zeta against the same column with default settings."""
    found, default = collapsed(CASE, COARSE, *overrides), collapsed(CASE, COARSE)
    return Observation(
        abs(found.zeta / default.zeta - 1.0), f"zeta {found.zeta:.3f}, default {default.zeta:.3f}", _front(found)
    )


def _front(found: CollapseResult) -> Curve:
    collapse = found.history["stage"] == "collapse"
    return found.history["time"][collapse], found.history["front_height"][collapse]


def _tall(a: int, spacing: str) -> Scenario:
    column = (f"geometry.aspect={a}", f"grid.spacing={spacing}")
    return Scenario(
        name=f"tall-{a}",
        mechanism=f"In the collapse of a column with a = {a} material points detach; without opening strain they "
        "dilate without bound.",
        metric=OUTLIERS,
        bound=OUTLIERS_BOUND,
        source=OUTLIERS_SOURCE,
        remedy="method.opening_strain = true (default); use front_height",
        trials=(
            failing("opening_strain = false", partial(outliers, *column, "method.opening_strain=false")),
            passing("opening_strain = true", partial(outliers, *column), default=True),
        ),
        slow=True,
    )


SCENARIOS = (
    *(_tall(a, spacing) for a, spacing in TALL.items()),
    Scenario(
        name="tall-soft",
        mechanism="A tall column of soft sand falls as fast as its own waves or faster: the impact compresses its "
        "foot beyond the range of the law. The fall itself is harmless.",
        metric=OUTLIERS,
        bound=OUTLIERS_BOUND,
        source=OUTLIERS_SOURCE,
        remedy="material.youngs_modulus of at least 5 rho g h_i; here 0.2 MPa, preferably 1 MPa",
        trials=(
            failing(
                "E = 0.1 MPa, no filter", partial(outliers, *SOFT_COLUMN, NO_FILTER, "material.youngs_modulus=0.1 MPa")
            ),
            passing("E = 0.2 MPa", partial(outliers, *SOFT_COLUMN, "material.youngs_modulus=0.2 MPa"), default=True),
            passing("E = 1 MPa", partial(outliers, *SOFT_COLUMN, "material.youngs_modulus=1 MPa"), default=True),
        ),
        slow=True,
    ),
    Scenario(
        name="stiff-outliers",
        mechanism="Stiff sand on a coarse grid: elastic energy of compressed points is released and detaches them "
        "ahead of the front.",
        metric=OUTLIERS,
        bound=OUTLIERS_BOUND,
        source=OUTLIERS_SOURCE,
        remedy="method.stress_filter = flow (default), or material.youngs_modulus = 10 MPa or less; use front_height, "
        "which hardly changes",
        trials=(
            failing("E = 100 MPa, no filter", partial(outliers, COARSE, NO_FILTER, STIFF)),
            passing("E = 100 MPa", partial(outliers, COARSE, STIFF), default=True),
            passing("E = 10 MPa", partial(outliers, COARSE), default=True),
            passing("E = 1 MPa", partial(outliers, COARSE, "material.youngs_modulus=1 MPa"), default=True),
        ),
        slow=True,
    ),
    Scenario(
        name="gate-speed",
        mechanism="A gate that rises slowly releases the column from below, and the deposit differs.",
        metric="relative change of the runout zeta against instantaneous release",
        bound=0.1,
        source=SCATTER,
        remedy="stages.gate_speed as in the experiment if it is below sqrt(g h_i), here 0.94 m/s, otherwise inf; "
        "Sarlin et al. 2021, doi:10.1103/PhysRevE.104.064904, on the release velocity",
        trials=(
            failing("gate_speed = 0.05 m/s", partial(runout_change, "stages.gate_speed=0.05")),
            passing("gate_speed = 1 m/s", partial(runout_change, "stages.gate_speed=1")),
            passing("gate_speed = inf", partial(runout_change), default=True),
        ),
        slow=True,
        axes=("time since release (s)", "front_height (m)"),
    ),
)
