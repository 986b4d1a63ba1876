"""Whole collapses on coarse grids: tall columns, stiff and soft sand, gates that take their time."""

from __future__ import annotations

from functools import partial

from mpmcol.failure_modes.problems.collapse import Collapse, collapsed
from mpmcol.failure_modes.scenario import Curve, Reading, Scene, Trial

CASE = "quickstart"
COARSE = "grid.spacing=0.01"
SOFT_COLUMN = ("geometry.aspect=20", "grid.spacing=0.015")
TALL = {10: "0.015", 20: "0.015", 35: "0.018"}  # aspect ratio, spacing in m: five or six cells across
OUTLIERS = "farthest point ahead of the front, over the front"
OUTLIERS_BOUND, OUTLIERS_SOURCE = 0.25, "a few grains fly ahead in experiments, too; the farthest point is no front"
SCATTER = "the scatter of the experiments, a tenth"


def outliers(*overrides: str) -> Reading:
    """How far the farthest point is ahead of the front by the deposit's height, over that front."""
    found = collapsed(CASE, *overrides)
    note = f"zeta {found.zeta:.3f}, largest J {found.largest_J:.3f}"
    return Reading(found.front_max / found.front_height - 1.0, note)


def runout_change(*overrides: str) -> Reading:
    """Of zeta, against the same column as it is by default."""
    found, default = collapsed(CASE, COARSE, *overrides), collapsed(CASE, COARSE)
    return Reading(abs(found.zeta / default.zeta - 1.0), f"zeta {found.zeta:.3f} for {default.zeta:.3f}", _front(found))


def _front(found: Collapse) -> Curve:
    flows = found.history["stage"] == "collapse"
    return found.history["time"][flows], found.history["front_height"][flows]


def _tall(a: int, spacing: str) -> Scene:
    column = (f"geometry.aspect={a}", f"grid.spacing={spacing}")
    return Scene(
        name=f"tall-{a}",
        mechanism=f"A column of a = {a} splashes: its grains fly apart, and those of open sand swell without end.",
        sign=OUTLIERS,
        unit="",
        bound=OUTLIERS_BOUND,
        source=OUTLIERS_SOURCE,
        remedy="method.opening_strain = true, the default; score by front_height",
        trials=(
            Trial("opening_strain = false", False, partial(outliers, *column, "method.opening_strain=false")),
            Trial("opening_strain = true", True, partial(outliers, *column), default=True),
        ),
        slow=True,
    )


SCENES = (
    *(_tall(a, spacing) for a, spacing in TALL.items()),
    Scene(
        name="tall-soft",
        mechanism="A tall column of soft sand that falls as fast as its own waves or faster crushes its foot when it "
        "lands; the fall itself harms nothing.",
        sign=OUTLIERS,
        unit="",
        bound=OUTLIERS_BOUND,
        source=OUTLIERS_SOURCE,
        remedy="material.youngs_modulus of at least 5 rho g h_i; here 0.2 MPa, better 1 MPa",
        trials=(
            Trial("E = 0.1 MPa", False, partial(outliers, *SOFT_COLUMN, "material.youngs_modulus=0.1 MPa")),
            Trial(
                "E = 0.2 MPa", True, partial(outliers, *SOFT_COLUMN, "material.youngs_modulus=0.2 MPa"), default=True
            ),
            Trial("E = 1 MPa", True, partial(outliers, *SOFT_COLUMN, "material.youngs_modulus=1 MPa"), default=True),
        ),
        slow=True,
    ),
    Scene(
        name="stiff-outliers",
        mechanism="Stiff sand on a coarse grid: what is squeezed between nodes springs off, and grains shoot ahead.",
        sign=OUTLIERS,
        unit="",
        bound=OUTLIERS_BOUND,
        source=OUTLIERS_SOURCE,
        remedy="material.youngs_modulus = 10 MPa or less; front_height, which hardly changes",
        trials=(
            Trial(
                "E = 100 MPa",
                False,
                partial(outliers, COARSE, "material.youngs_modulus=100 MPa"),
                default=True,
            ),
            Trial("E = 10 MPa", True, partial(outliers, COARSE), default=True),
            Trial("E = 1 MPa", True, partial(outliers, COARSE, "material.youngs_modulus=1 MPa"), default=True),
        ),
        slow=True,
    ),
    Scene(
        name="gate-speed",
        mechanism="A gate that rises slowly lets the column out from below, and another pile comes to rest.",
        sign="change of the runout zeta against a gate that is gone at once",
        unit="",
        bound=0.1,
        source=SCATTER,
        remedy="stages.gate_speed of the experiment where its gate is slower than sqrt(g h_i), here 0.94 m/s; inf else",
        trials=(
            Trial("gate_speed = 0.05 m/s", False, partial(runout_change, "stages.gate_speed=0.05")),
            Trial("gate_speed = 1 m/s", True, partial(runout_change, "stages.gate_speed=1")),
            Trial("gate_speed = inf", True, partial(runout_change), default=True),
        ),
        slow=True,
        axes=("time since release (s)", "front (m)"),
    ),
)
