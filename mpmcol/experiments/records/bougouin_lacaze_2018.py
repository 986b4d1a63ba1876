"""Bougouin & Lacaze 2018: dense columns in a fluid; the free-fall and inertial regimes, as in air."""

from __future__ import annotations

from math import inf

from mpmcol.experiments.base import GLASS_BEADS, Experiment, Law, Piece

_RUNOUT_SCATTER = "published: 2.7 +- 0.3 and 3.7 +- 0.3 (the larger of the two, relative)"
_HEIGHT_SCATTER = "published: 0.8 +- 0.07"

EXPERIMENT = Experiment(
    name="bougouin-lacaze-2018",
    title="Bougouin & Lacaze 2018, free-fall and inertial regimes",
    doi="10.1103/PhysRevFluids.3.064305",
    model="plane",
    release="one-sided",
    kind="laboratory",
    material="glass beads in fluid, free-fall and inertial regimes",
    friction_deg=GLASS_BEADS,
    laws=(
        Law(
            "zeta",
            (Piece(0.0, 2.0, 2.7, 1.0), Piece(2.0, inf, 3.7, 0.64)),
            0.3 / 2.7,
            _RUNOUT_SCATTER,
            verified=False,
        ),
        Law(
            "beta",
            (Piece(0.0, 0.75, 1.0, 0.0), Piece(0.75, inf, 0.8, -0.65)),
            0.07 / 0.8,
            _HEIGHT_SCATTER,
            verified=False,
        ),
    ),
    note=(
        "Source: a plotting script in alexander-busch/ADWELL, with exponents 0.64 +- 0.02 and -0.65 +- 0.04. "
        "The script divides the height fit by a once more; here the fit is h_f / h_i, for which its pieces meet "
        "at the break. The material and the range of a were not checked in the original."
    ),
)
