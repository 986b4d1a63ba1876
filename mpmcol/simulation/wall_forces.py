"""Mean forces, moments and pressures on the walls, from the impulses of their nodes."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from mpmcol.measure.wall_forces import AXES, column, moment_column
from mpmcol.mpm.contact import FRICTION_WORK, Contacts, wall_impulses
from mpmcol.setup.geometry import VERTICAL
from mpmcol.setup.model import Model
from mpmcol.setup.wall_faces import WallFace, WallFoot, contact_positions, wall_faces, wall_feet

PRESSURE_ROWS = 10  # rows of the history over which the pressure on the walls is averaged

NORMAL_IMPULSES = (0, 4, 8)  # of the sums of a node: that on the wall with normal axis k, along the normal

Pressures = tuple[float, list[float]]  # duration of the mean, s, and normal pressure at each row of nodes, Pa


class WallForces:
    """Forces on `walls`, the walls of a table of contacts in the order of their numbers; none without names."""

    def __init__(self, model: Model, walls: Sequence[str]) -> None:
        self._contacts: Contacts = model.contacts
        self._walls, self._axes = walls, AXES[: model.discretization.dimension]
        self.faces: tuple[WallFace, ...] = wall_faces(model) if walls else ()
        positions = contact_positions(model) if walls else np.zeros((0, 2))
        self._feet: tuple[WallFoot, ...] = wall_feet(model.discretization, positions) if walls else ()
        self._height = positions[:, VERTICAL]  # of the nodes in the table of contacts above the base, m
        self._time, self._impulses = 0.0, self._no_impulses()
        self._means = self._no_impulses()
        self._recent: deque[tuple[float, list[float]]] = deque(maxlen=PRESSURE_ROWS + 1)
        self.at_release: Pressures | None = None

    def start(self, time: float) -> None:
        """Start to measure at a time (s) at which the sums of impulses were set to zero."""
        self.at_release = self.pressures()
        self._recent.clear()
        self._time, self._impulses = time, self._no_impulses()

    def columns(self, time: float) -> dict[str, float]:
        """Columns of the history: mean forces since the previous call, or those of that call if no time has passed."""
        if not self._walls:
            return {}
        impulses = np.append(wall_impulses(self._contacts, len(self._walls)).reshape(-1), self._moment_impulses())
        if time > self._time:
            self._means = (impulses - self._impulses) / (time - self._time)
            self._time, self._impulses = time, impulses
            self._recent.append((time, self._normal_impulses()))
        forces, moments = np.split(self._means, [3 * len(self._walls)])
        named = {
            column(wall, axis): float(forces[3 * number + k])
            for number, wall in enumerate(self._walls)
            for k, axis in enumerate(self._axes)
        }
        return named | {
            moment_column(self._walls[foot.wall]): float(moment)
            for foot, moment in zip(self._feet, moments, strict=True)
        }

    def pressures(self) -> Pressures | None:
        """Mean pressures at all rows of nodes of all faces over the last PRESSURE_ROWS rows of the history.

        None without faces, or if there are not two rows yet.
        """
        if len(self._recent) < 2 or not self.faces:
            return None
        (start, before), (end, after) = self._recent[0], self._recent[-1]
        area = np.concatenate([face.area for face in self.faces])
        return end - start, ((np.array(after) - np.array(before)) / (end - start) / area).tolist()

    def pressure_rows(self) -> list[dict[str, Any]]:
        """Rows of wall_pressure.csv: at release those of back wall, gate and floor, at the end those of all walls."""
        rows = []
        for state, pressures in (("release", self.at_release), ("end", self.pressures())):
            window, values = pressures or (0.0, [])
            remaining = iter(values)
            for face in self.faces if values else ():
                for position, area, pressure in zip(face.position, face.area, remaining, strict=False):
                    rows.append(
                        {
                            "wall": self._walls[face.wall], "face": face.name, "state": state,
                            "position": float(position), "force": pressure * float(area), "pressure": pressure,
                            "window": window,
                        }
                    )  # fmt: skip
        return rows

    def _no_impulses(self) -> np.ndarray:
        return np.zeros(3 * len(self._walls) + len(self._feet))

    def _moment_impulses(self) -> np.ndarray:
        """Angular impulse about the foot of each wall that has one, positive if it overturns the wall, N m s."""
        impulses = self._contacts.sums[:-1, :FRICTION_WORK].reshape(-1, 3, 3)
        moments = []
        for foot in self._feet:
            own = np.where((self._contacts.wall == foot.wall)[:, :, None], impulses, 0.0).sum(axis=1)
            outward = (own * foot.normals).sum(axis=1)
            moments.append(float(self._height @ outward - foot.distance @ own[:, VERTICAL]))
        return np.array(moments)

    def _normal_impulses(self) -> list[float]:
        """Impulse into the wall of each row of nodes of each face, N s."""
        rows: list[float] = []
        for face in self.faces:
            by_axis = self._contacts.sums[face.nodes][:, NORMAL_IMPULSES]
            impulse = (face.normals * by_axis).sum(axis=1)
            rows += np.bincount(face.row, impulse, len(face.position)).tolist()
        return rows

    def memory(self) -> dict[str, Any]:
        """State as plain values, for a checkpoint."""
        return {
            "time": self._time,
            "impulses": self._impulses.tolist(),
            "means": self._means.tolist(),
            "recent": [list(row) for row in self._recent],
            "at_release": self.at_release,
        }

    def set_memory(self, memory: Mapping[str, Any]) -> None:
        """Continue from a state."""
        self._time = memory["time"]
        self.at_release = tuple(memory["at_release"]) if memory["at_release"] else None
        self._impulses, self._means = np.array(memory["impulses"]), np.array(memory["means"])
        self._recent.clear()
        self._recent.extend((time, rows) for time, rows in memory["recent"])
