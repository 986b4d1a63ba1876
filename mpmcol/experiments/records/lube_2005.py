"""Lube, Huppert, Sparks & Freundt 2005: two-sided collapse between walls 10 cm apart, universal shape."""

from __future__ import annotations

from mpmcol.experiments.base import HEIGHT_SCATTER, RUNOUT_SCATTER, Experiment, Law, Piece, Profile

FINAL_SHAPE = Profile(
    name="universal final surface",
    x=(0.0, 0.1, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.7, 0.75, 0.8, 0.9, 0.95, 1.0),
    y=(1.0, 0.859, 0.708, 0.633, 0.560, 0.425, 0.299, 0.194, 0.108, 0.078, 0.055, 0.021, 0.007, 0.0),
    unit="1",
    source="alexander-busch/ADWELL, Shape_Lube2005.xlsx, 81 points interpolated; (1, 0) added",
    verified=True,
    experiment="lube-2005",
)

EXPERIMENT = Experiment(
    name="lube-2005",
    title="Lube et al. 2005, series A, channel 100 mm wide, two-sided",
    doi="10.1103/PhysRevE.72.041301",
    model="plane",
    release="two-sided",
    kind="laboratory",
    material="fine quartz sand, repose 29.5 deg",
    laws=(
        Law("zeta", (Piece(0.5, 1.8, 1.2, 1.0), Piece(2.8, 20.0, 1.9, 2 / 3)), RUNOUT_SCATTER, verified=True),
        Law("beta", (Piece(2.8, 20.0, 1.0, -3 / 5),), HEIGHT_SCATTER, verified=True),
    ),
    profiles=(FINAL_SHAPE,),
    channel_width=0.1,
    note=(
        "Lengths are relative to the half-width of the column. Source: Lagree et al. 2011 "
        "(doi:10.1017/jfm.2011.335), Eq. 3.1-3.2. beta: h_f / r_i is about a^(2/5) at large a. The digitised "
        "shape has an area factor of 0.372. With h_f / r_i = a^0.4, conservation of mass requires 0.404 for "
        "this runout (8 % compaction) and 0.355 for the runout of lube-2007 (5 % dilation)."
    ),
)
