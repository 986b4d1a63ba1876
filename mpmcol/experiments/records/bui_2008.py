"""Bui, Fukagawa, Sako & Ohno 2008: aluminium rods, plane strain without side walls, one column."""

from __future__ import annotations

from mpmcol.experiments.base import HEIGHT_SCATTER, RUNOUT_SCATTER, Experiment, Law, Piece, Profile

_SOURCE = "LandslideSIM/MaterialPointSolver.jl, docs/src/assets/data/2d_collapse_experiments"
_R_I, _H_I = 0.2, 0.1

SURFACE = Profile(
    name="free surface",
    x=(
        0.0, 0.0196, 0.0398, 0.0600, 0.0803, 0.1001, 0.1203, 0.1401, 0.1603, 0.1802, 0.2000, 0.2202,
        0.2408, 0.2622, 0.2820, 0.3022, 0.3221, 0.3423, 0.3622, 0.3824, 0.4022, 0.4221, 0.4423,
    ),
    y=(
        0.0992, 0.0993, 0.0959, 0.0890, 0.0844, 0.0776, 0.0722, 0.0665, 0.0616, 0.0539, 0.0474, 0.0425,
        0.0348, 0.0307, 0.0265, 0.0215, 0.0189, 0.0136, 0.0109, 0.0079, 0.0037, 0.0022, 0.0015,
    ),
    unit="m",
    source=f"{_SOURCE}/surface.csv",
    verified=True,
    experiment="bui-2008",
)  # fmt: skip

FAILURE = Profile(
    name="failure line",
    x=(0.0212, 0.0398, 0.0600, 0.0797, 0.0999, 0.1196, 0.1394, 0.1596, 0.1794),
    y=(0.0989, 0.0901, 0.0802, 0.0652, 0.0545, 0.0368, 0.0257, 0.0104, 0.0005),
    unit="m",
    source=f"{_SOURCE}/failure.csv",
    verified=True,
    experiment="bui-2008",
)


def _at_this_column(value: float) -> tuple[Piece, ...]:
    """The measured value, for aspect ratios within 1 % of the column's."""
    a = _H_I / _R_I
    return (Piece(0.99 * a, 1.01 * a, value, 0.0),)


EXPERIMENT = Experiment(
    name="bui-2008",
    title="Bui et al. 2008, aluminium rods, 200 mm x 100 mm",
    doi="10.1002/nag.688",
    model="plane",
    release="one-sided",
    kind="laboratory",
    material="aluminium rods, phi = 19.8 deg",
    friction_deg=(18.0, 22.0),
    laws=(
        Law("zeta", _at_this_column(SURFACE.x[-1] / _R_I - 1.0), RUNOUT_SCATTER, verified=True),
        Law("beta", _at_this_column(SURFACE.y[0] / _H_I), HEIGHT_SCATTER, verified=True),
    ),
    profiles=(SURFACE, FAILURE),
    column=(_R_I, _H_I),
    note=(
        "Source: digitised surface and failure line. The area under the surface exceeds the initial area by "
        "1.5 %. Low friction and no side walls: the runout exceeds every channel law. phi = 19.8 deg, c = 0, "
        "density 2650 kg/m3 and K of about 0.7 MPa are those of the example that the data accompany; E = 0.84 "
        "MPa and rod diameters of 1 and 1.5 mm are unverified."
    ),
)
