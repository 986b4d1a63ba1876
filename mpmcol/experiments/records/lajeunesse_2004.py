"""Lajeunesse, Mangeney-Castelnau & Vilotte 2004: axisymmetric columns of glass beads."""

from __future__ import annotations

from math import inf

from mpmcol.experiments.base import GLASS_BEADS, HEIGHT_SCATTER, RUNOUT_SCATTER, Experiment, Law, Piece

EXPERIMENT = Experiment(
    name="lajeunesse-2004",
    title="Lajeunesse et al. 2004, axisymmetric",
    doi="10.1063/1.1736611",
    model="axisymmetric",
    release="one-sided",
    kind="laboratory",
    material="glass beads",
    friction_deg=GLASS_BEADS,
    laws=(
        Law("zeta", (Piece(0.0, 0.74, 1.35, 1.0), Piece(0.74, inf, 2.0, 1 / 2)), RUNOUT_SCATTER, verified=False),
        Law("beta", (Piece(0.0, 0.74, 1.0, 0.0), Piece(0.74, inf, 0.74, -1.0)), HEIGHT_SCATTER, verified=False),
    ),
    note=(
        "The deposit is a truncated cone below a = 0.74 and a cone above, where h_f / r_i = 0.74. Source: "
        "kks32/phd-thesis, chapter 2, which prints both powers 1/2 as 1.2; 1/2 is consistent with r_f / r_i = "
        "sqrt(3 a / 0.74). The coefficients, the material and the range of a were not checked in the original."
    ),
)
