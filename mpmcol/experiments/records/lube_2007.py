"""Lube, Huppert, Sparks & Freundt 2007: one-sided collapse down a channel 200 mm wide (Eq. 37)."""

from __future__ import annotations

from mpmcol.experiments.base import HEIGHT_SCATTER, RUNOUT_SCATTER, Experiment, Law, Piece

EXPERIMENT = Experiment(
    name="lube-2007",
    title="Lube et al. 2007, channel 200 mm wide, one-sided",
    doi="10.1063/1.2712431",
    model="plane",
    release="one-sided",
    kind="laboratory",
    material="sand",
    laws=(
        Law("zeta", (Piece(0.5, 1.8, 1.6, 1.0), Piece(2.8, 20.0, 2.2, 2 / 3)), RUNOUT_SCATTER),
        Law("beta", (Piece(0.5, 1.15, 1.0, 0.0), Piece(1.15, 20.0, 1.0, -3 / 5)), HEIGHT_SCATTER),
        Law("stop_time", (Piece(0.5, 20.0, 3.3, 0.0),), 0.10, note="general knowledge, not looked up"),
    ),
    note=(
        "zeta: Eq. 37 of Coetzee & Purvance 2026 (doi:10.20944/preprints202605.0398.v1), who quote a from "
        "about 0.5 to 20; at a = 2.8 the upper law is taken. The same numbers are elsewhere attributed to "
        "Lube et al. 2005, plotted with a band of +-0.1 in zeta. beta: h_f / r_i = a (a < 1.15), a^(2/5) (a "
        "> 1.15), read from a public plotting script whose exponents are mis-signed; the 2/5 is confirmed by "
        "other sources. The original was not read."
    ),
)
