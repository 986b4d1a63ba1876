"""Dunatunga & Kamrin 2015: the material point method with a mu(I)-type law."""

from __future__ import annotations

from mpmcol.experiments.base import RUNOUT_SCATTER, Experiment, Law, Piece

EXPERIMENT = Experiment(
    name="dunatunga-kamrin-2015",
    title="Dunatunga & Kamrin 2015, Table 3, material point method",
    doi="10.1017/jfm.2015.383",
    model="plane",
    release="one-sided",
    kind="simulation",
    material="mu(I)-type continuum",
    laws=(Law("zeta", (Piece(0.0, 1.8, 2.28, 1.0),), RUNOUT_SCATTER, verified=True),),
    note="Published for small a. The limit a < 1.8 is that of the linear law of the channel experiments.",
)
