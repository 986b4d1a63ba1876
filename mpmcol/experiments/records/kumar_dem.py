"""Kumar (thesis, University of Cambridge): plane collapse of discs, discrete element method."""

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
    laws=(Law("zeta", (Piece(0.0, 2.7, 1.67, 1.0), Piece(2.7, inf, 2.7, 2 / 3)), RUNOUT_SCATTER, verified=True),),
    note=(
        "Source: kks32/phd-thesis, chapter 4; a thesis without DOI. Mohr-Coulomb MPM agrees with it below "
        "a = 2.7 and has a longer runout above. The range of a is not stated."
    ),
)
