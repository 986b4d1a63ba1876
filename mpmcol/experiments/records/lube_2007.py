"""Lube, Huppert, Sparks & Freundt 2007: one-sided collapse down a channel 200 mm wide (Eq. 37)."""

from __future__ import annotations

from mpmcol.experiments.base import HEIGHT_SCATTER, RUNOUT_SCATTER, Experiment, Law, Piece
from mpmcol.experiments.records.lube_2005 import FINAL_SHAPE

EXPERIMENT = Experiment(
    name="lube-2007",
    title="Lube et al. 2007, channel 200 mm wide, one-sided",
    doi="10.1063/1.2712431",
    model="plane",
    release="one-sided",
    kind="laboratory",
    material="sand",
    laws=(
        Law("zeta", (Piece(0.5, 1.8, 1.6, 1.0), Piece(2.8, 20.0, 2.2, 2 / 3)), RUNOUT_SCATTER, verified=True),
        Law("beta", (Piece(0.5, 1.15, 1.0, 0.0), Piece(1.15, 20.0, 1.0, -3 / 5)), HEIGHT_SCATTER, verified=False),
        Law("stop_time", (Piece(0.5, 20.0, 3.3, 0.0),), 0.10, note="commonly quoted; source not read", verified=False),
    ),
    channel_width=0.2,
    profiles=(FINAL_SHAPE,),
    note=(
        "zeta: Eq. 37 of Coetzee & Purvance 2026 (doi:10.20944/preprints202605.0398.v1), for a from about 0.5 "
        "to 20; at a = 2.8 the upper law applies. Other authors attribute the same law to Lube et al. 2005. "
        "beta: h_f / r_i = a (a < 1.15), a^(2/5) (a > 1.15), from a plotting script in alexander-busch/ADWELL "
        "that has the wrong sign in its exponents; the exponent 2/5 agrees with lube-2005. The break and the "
        "height of short columns were not checked in the original. The "
        "paper gives no height in plane strain. The universal final surface is that of lube-2005."
    ),
)
