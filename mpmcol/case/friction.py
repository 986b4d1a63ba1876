"""The table of a case file for friction of floor and walls."""

from __future__ import annotations

from mpmcol.units import Table, quantity


class FrictionTable(Table):
    """Coulomb friction of floor and walls, from which material may separate."""

    floor: float | None = quantity(
        'coefficient mu of the rigid floor, or a friction angle such as "22 deg"; 0: frictionless; default: a floor '
        "without slip",
        "",
        None,
        ge=0,
        le=10,
        is_tangent=True,
    )
    back_wall: float | None = quantity(
        "coefficient of the wall at x = 0 of a one-sided plane column, or a friction angle; default: a smooth wall "
        "from which material does not separate",
        "",
        None,
        ge=0,
        le=10,
        is_tangent=True,
    )
    side_walls: float | None = quantity(
        "coefficient of the side walls of a channel that is modelled in plane strain, or a friction angle; needs "
        "channel_width; default: smooth",
        "",
        None,
        ge=0,
        le=10,
        is_tangent=True,
    )
    channel_width: float | None = quantity("distance W between the side walls", "m", None, gt=0)
