"""Lajeunesse, Mangeney-Castelnau & Vilotte 2004: axisymmetric columns of glass beads."""

from __future__ import annotations

from math import inf

from mpmcol.experiments.base import HEIGHT_SCATTER, RUNOUT_SCATTER, Experiment, Law, Piece

EXPERIMENT = Experiment(
    name="lajeunesse-2004",
    title="Lajeunesse et al. 2004, axisymmetric",
    doi="10.1063/1.1736611",
    model="axisymmetric",
    release="one-sided",
    kind="laboratory",
    material="glass beads",
    laws=(
        Law("zeta", (Piece(0.0, 0.74, 1.35, 1.0), Piece(0.74, inf, 2.0, 1 / 2)), RUNOUT_SCATTER),
        Law("beta", (Piece(0.0, 0.74, 1.0, 0.0), Piece(0.74, inf, 0.74, -1.0)), HEIGHT_SCATTER),
    ),
    note=(
        "A truncated cone below a = 0.74, a cone above; h_f / r_i is then 0.74. From a thesis that misprints "
        "both powers 1/2 as 1.2; consistent with r_f / r_i = sqrt(3 a / 0.74). That the grains are glass "
        "beads is general knowledge. The original was not read and the ends of its range of a are not known "
        "here."
    ),
)
