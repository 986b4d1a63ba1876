"""The two-sided runout of Lube et al. 2005 as several papers quote it, with a single break at a = 2.3."""

from __future__ import annotations

from mpmcol.experiments.base import RUNOUT_SCATTER, Experiment, Law, Piece

EXPERIMENT = Experiment(
    name="lube-2005-single-break",
    title="Lube et al. 2005 with a single break, at a = 2.3, as quoted",
    doi="10.1103/PhysRevE.72.041301",
    model="plane",
    release="two-sided",
    kind="laboratory",
    material="fine quartz sand, repose 29.5 deg",
    laws=(Law("zeta", (Piece(0.5, 2.3, 1.2, 1.0), Piece(2.3, 20.0, 1.9, 2 / 3)), RUNOUT_SCATTER, verified=False),),
    channel_width=0.1,
    note="A variant of the law of lube-2005, not another data set. The break was not checked in the original.",
)
