"""Lajeunesse, Monnier & Homsy 2005: glass beads in a channel."""

from __future__ import annotations

from math import inf

from mpmcol.experiments.base import HEIGHT_SCATTER, RUNOUT_SCATTER, Experiment, Law, Piece

EXPERIMENT = Experiment(
    name="lajeunesse-2005",
    title="Lajeunesse et al. 2005, channel",
    model="plane",
    release="one-sided",
    kind="laboratory",
    material="glass beads, repose 22 deg, avalanche 27.4 deg",
    laws=(
        Law("zeta", (Piece(0.0, 3.0, 1.8, 1.0), Piece(3.0, inf, 2.3, 2 / 3)), RUNOUT_SCATTER),
        Law("beta", (Piece(0.0, 0.7, 1.0, 0.0), Piece(1.0, inf, 1.0, -2 / 3)), HEIGHT_SCATTER),
        Law("stop_time", (Piece(0.0, inf, 3.0, 0.0),), 0.10),
    ),
    note=(
        "zeta as tabulated by Lagree et al. 2011. beta: h_f / L_i = a (a < 0.7), a^(1/3) (a > 0.7), from a "
        "thesis; the latter exceeds the initial height for 0.7 < a < 1 and is left out there, so its "
        "prefactor of 1 is doubtful elsewhere too. Timing from the same thesis: 0.8 + 2 + 0.6 of sqrt(h_i / "
        "g), slow surface motion to about 6; failure surface at 50-55 deg. Phys. Fluids 17, 103302; DOI not "
        "checked, original not read, ends of its range of a not known here."
    ),
)
