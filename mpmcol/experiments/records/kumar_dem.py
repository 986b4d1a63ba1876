"""K. Kumar's thesis: plane collapse of discs with the discrete element method."""

from __future__ import annotations

from math import inf

from mpmcol.experiments.base import RUNOUT_SCATTER, Experiment, Law, Piece

EXPERIMENT = Experiment(
    name="kumar-dem",
    title="Kumar (thesis), discrete element method, discs",
    model="plane",
    release="one-sided",
    kind="simulation",
    material="discs, DEM",
    laws=(Law("zeta", (Piece(0.0, 2.7, 1.67, 1.0), Piece(2.7, inf, 2.7, 2 / 3)), RUNOUT_SCATTER),),
    note=(
        "kks32/phd-thesis, chapter 4. Mohr-Coulomb MPM agrees with it below a = 2.7 and runs farther above. "
        "A thesis without DOI; the ends of its range of a are not known here."
    ),
)
