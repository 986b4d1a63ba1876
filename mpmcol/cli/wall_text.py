"""Text output on the forces on walls, of `mpmcol run` and `mpmcol measure`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from mpmcol.io.glossary import FORCE_UNITS, MOMENT_UNITS


def wall_lines(wall_forces: Mapping[str, Any] | None, model: str) -> Iterator[str]:
    """Peak and final forces on walls, and moments; nothing of a wall without force or of a run that records none.

    wall_forces: as in result.json. model: geometry.model.
    """
    force_unit, moment_unit = FORCE_UNITS[model], MOMENT_UNITS[model]
    for wall, force in (wall_forces or {}).items():
        if force["peak"] > 0.0:
            mean = force["sustained"]
            sustained = "" if mean is None else f", {mean:.3g} {force_unit} as mean over 0.2 sqrt(h_i/g)"
            moment = f", moment at most {force['moment']:.3g} {moment_unit}" if "moment" in force else ""
            yield (
                f"force on {wall}: at most {force['peak']:.3g} {force_unit} at {force['time']:.3g} s (mean over "
                f"{1e3 * force['window']:.2g} ms, with elastic waves){sustained}, {force['at_end']:.3g} {force_unit} "
                f"at the end{moment}"
            )
