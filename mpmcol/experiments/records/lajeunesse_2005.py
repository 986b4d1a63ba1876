"""Lajeunesse, Monnier & Homsy 2005: glass beads in a channel."""

from __future__ import annotations

from math import inf

from mpmcol.experiments.base import GLASS_BEADS, HEIGHT_SCATTER, RUNOUT_SCATTER, Experiment, Law, Piece

EXPERIMENT = Experiment(
    name="lajeunesse-2005",
    title="Lajeunesse et al. 2005, channel",
    model="plane",
    release="one-sided",
    kind="laboratory",
    material="glass beads, repose 22 deg, avalanche 27.4 deg",
    friction_deg=GLASS_BEADS,
    laws=(
        Law("zeta", (Piece(0.0, 3.0, 1.8, 1.0), Piece(3.0, inf, 2.3, 2 / 3)), RUNOUT_SCATTER, verified=True),
        Law("beta", (Piece(0.0, 0.7, 1.0, 0.0), Piece(1.0, inf, 1.0, -2 / 3)), HEIGHT_SCATTER, verified=False),
        Law("stop_time", (Piece(0.0, inf, 3.0, 0.0),), 0.10, verified=False),
    ),
    note=(
        "Phys. Fluids 17, 103302; DOI not checked. zeta as quoted by Lagree et al. 2011 "
        "(doi:10.1017/jfm.2011.335). beta: h_f / r_i = a (a < 0.7), a^(1/3) (a > 0.7), from kks32/phd-thesis, "
        "chapter 2; the latter exceeds the initial height for 0.7 < a < 1 and is omitted there, so its "
        "prefactor of 1 is doubtful. Stop time from chapter 4 of the same thesis: 0.8 + 2 + 0.6 of sqrt(h_i / "
        "g), slow surface motion until about 6; failure surface at 50-55 deg. The range of a was not checked "
        "in the original."
    ),
)
