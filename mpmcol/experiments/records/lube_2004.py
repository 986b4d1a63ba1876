"""Lube, Huppert, Sparks & Hallworth 2004: axisymmetric columns (the paper's Eq. 38-40)."""

from __future__ import annotations

from mpmcol.experiments.base import HEIGHT_SCATTER, RUNOUT_SCATTER, Experiment, Law, Piece

EXPERIMENT = Experiment(
    name="lube-2004",
    title="Lube et al. 2004, axisymmetric",
    doi="10.1017/S0022112004009036",
    model="axisymmetric",
    release="one-sided",
    kind="laboratory",
    material="several granular materials",
    laws=(
        Law("zeta", (Piece(0.2, 1.7, 1.24, 1.0), Piece(1.7, 35.0, 1.6, 1 / 2)), RUNOUT_SCATTER, verified=True),
        Law("beta", (Piece(0.2, 1.0, 1.0, 0.0), Piece(1.7, 10.0, 0.88, -5 / 6)), HEIGHT_SCATTER, verified=True),
        Law("stop_time", (Piece(0.2, 35.0, 3.0, 0.0),), 0.10, note="commonly quoted; source not read", verified=False),
    ),
    note=(
        "Source: Eq. 38 and 40 of Coetzee & Purvance 2026 (doi:10.20944/preprints202605.0398.v1), for a from "
        "0.2 to 35. At a = 1.7 the upper law applies; the runout steps there from 2.108 to 2.086. The "
        "undisturbed inner cone has an angle of about 59 deg at a = 1.7. The volume factor V / (pi r_f^2 h_f) "
        "that follows from these fits is 0.190 (a = 2) to 0.211 (a = 10); that of a cone is 0.333. Warnett et "
        "al. 2014 (doi:10.1007/s10035-013-0469-x) find that the final radius also depends on the radius of the "
        "column."
    ),
)
