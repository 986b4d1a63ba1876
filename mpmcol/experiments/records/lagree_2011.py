"""Lagree, Staron & Popinet 2011: simulations of a mu(I) continuum."""

from __future__ import annotations

from math import inf

from mpmcol.experiments.base import HEIGHT_SCATTER, RUNOUT_SCATTER, Experiment, Law, Piece

EXPERIMENT = Experiment(
    name="lagree-2011",
    title="Lagree et al. 2011, mu(I) continuum",
    doi="10.1017/jfm.2011.335",
    model="plane",
    release="one-sided",
    kind="simulation",
    material="mu(I) continuum",
    laws=(
        Law("zeta", (Piece(0.0, 7.0, 2.2, 1.0), Piece(7.0, inf, 3.9, 0.7)), RUNOUT_SCATTER, verified=True),
        Law("beta", (Piece(0.52, inf, 0.65, -0.65),), HEIGHT_SCATTER, verified=True),
    ),
    note=(
        "Source: their Eq. 3.1-3.2; the break at a = 7 is approximate. The height law h_f / r_i = 0.65 a^0.35 "
        "is used from a = 0.52, where it equals the initial height. No side walls: the runout exceeds that of "
        "the channel experiments."
    ),
)
