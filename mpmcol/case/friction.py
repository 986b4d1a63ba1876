"""The table of a case file for friction of floor and walls."""

from __future__ import annotations

from typing import Any

from mpmcol.units import Table, quantity


def coefficient(description: str, default: float | None = None) -> Any:
    """Declare a key for a friction coefficient, which an angle may give."""
    return quantity(description, "", default, ge=0, le=10, is_tangent=True)


class FrictionTable(Table):
    """Coulomb friction of floor and walls, from which material may separate."""

    floor: float | None = coefficient(
        'coefficient mu of the rigid floor, or a friction angle such as "22 deg"; 0: frictionless; default: a floor '
        "without slip"
    )
    back_wall: float | None = coefficient(
        "coefficient of the wall at x = 0 of a one-sided plane column, or a friction angle; default: a smooth wall "
        "from which material does not separate"
    )
    side_walls: float | None = coefficient(
        "coefficient of the side walls of a channel that is modelled in plane strain, or a friction angle; needs "
        "channel_width; default: smooth"
    )
    channel_width: float | None = quantity("distance W between the side walls", "m", None, gt=0)
