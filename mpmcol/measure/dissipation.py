"""Where the released potential energy of a collapse went."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

CANCELLING = 0.05  # of the released energy: smaller shares of opposite signs need no explanation


@dataclass(frozen=True)
class Dissipation:
    """Shares of the potential energy released so far; their sum is one, up to the remaining energy."""

    released: float  # J (per metre or per radian in two dimensions)
    friction: float  # plastic work
    damping: float  # local damping, Eq. 23
    walls: float  # without their friction
    transfer: float
    filter: float
    remaining: float  # kinetic, and elastic energy gained
    smooth_damping: float  # what damping takes from a smooth flow: 2 alpha_d times the largest kinetic energy
    wall_friction: float = 0.0  # friction on floor and walls

    @property
    def numerical(self) -> float:
        """Share of transfer, filter and walls: apart from their friction, walls at rest do no physical work."""
        return self.transfer + self.filter + self.walls

    @property
    def damping_ratio(self) -> float:
        """Damping over that of a smooth flow; infinite if damping took energy that it should not."""
        return self.damping / self.smooth_damping if self.smooth_damping > 0.0 else (np.inf if self.damping else 0.0)


def walls_and_transfer(shares: Mapping[str, float]) -> float | None:
    """The sum of the two shares where one gives what the other takes; None where they do not cancel."""
    walls, transfer = shares.get("walls", 0.0), shares.get("transfer", 0.0)
    return walls + transfer if walls * transfer < 0.0 and min(abs(walls), abs(transfer)) > CANCELLING else None


def dissipation(history: Mapping[str, np.ndarray], alpha_d: float) -> Dissipation | None:
    """Shares at the end of a history; None before the release, or if nothing was released.

    history: columns of history.csv; wall_friction may be missing. alpha_d: local damping of the collapse.
    """
    flow = history["stage"] != "equilibrate"
    if not flow.any():
        return None
    rows = {name: values[flow] for name, values in history.items()}
    released = float(rows["potential"][0] - rows["potential"][-1])
    if not released > 0.0:
        return None
    names = ("plastic", "damping", "walls", "transfer", "filter")
    last = {name: float(rows[name][-1]) / released for name in names}
    remaining = sum(float(rows[name][-1] - rows[name][0]) for name in ("kinetic", "elastic")) / released
    return Dissipation(
        released=released,
        friction=last.pop("plastic"),
        wall_friction=float(rows["wall_friction"][-1]) / released if "wall_friction" in rows else 0.0,
        **last,
        remaining=remaining,
        smooth_damping=2.0 * alpha_d * float(rows["kinetic"].max()) / released,
    )
