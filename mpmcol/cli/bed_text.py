"""Text output on a granular bed, of `mpmcol run` and `mpmcol measure`."""

from __future__ import annotations

from collections.abc import Iterator

from mpmcol.measure import ColumnShape, Erosion
from mpmcol.units import length_text

NO_DROP = 1e-4  # of r_i: changes of the surface below that are elastic


def bed_lines(erosion: Erosion | None, shape: ColumnShape, energy_unit: str) -> Iterator[str]:
    """What of the bed moved, and the deposit over its old surface; nothing without a bed.

    energy_unit: in words, as in result.json; masses are per the same length or angle.
    """
    if erosion is None:
        return
    mass = f"{erosion.eroded_mass:.3g} {energy_unit.replace('J', 'kg', 1)}"
    whole = ", its whole thickness" if erosion.reaches_floor(shape) else ""
    yield f"bed: {mass} moved, down to a depth of {length_text(erosion.eroded_depth)}{whole}"
    lowered = "nowhere lower"
    if erosion.surface_drop > NO_DROP * shape.r_i:
        lowered = f"at most {length_text(erosion.surface_drop)} lower"
    yield (
        f"surface over that of the bed at the release: deposit up to {length_text(erosion.deposit_front)}, zeta "
        f"{erosion.deposit_front / shape.r_i - 1.0:.3f}; {lowered}"
    )
