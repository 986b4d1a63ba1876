"""Results of a run at rest, without a simulation: a wedge that becomes longer."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from mpmcol.case import Case, load_case
from mpmcol.io.results import Results
from mpmcol.measure import ColumnShape, Measurement, measure
from mpmcol.plotting import charts

SHAPE = ColumnShape("plane", "one-sided", r_i=0.09, h_i=0.09, spacing=0.002, density=2650.0, point_size=0.001)


def deposit(spread: float, shape: ColumnShape = SHAPE) -> Measurement:
    """The column sheared into a wedge that is (1 + spread) r_i long."""
    length = shape.r_i * (1.0 + spread)
    size, height = shape.point_size, 2.0 * shape.r_i * shape.h_i / length
    x, y = np.meshgrid(np.arange(size / 2, length, size), np.arange(size / 2, height, size), indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel()])
    points = points[points[:, 1] < height * (1.0 - points[:, 0] / length)]
    mass = np.full(len(points), shape.density * size**2)
    return measure(points, mass, np.zeros_like(points), shape)


@dataclass
class SyntheticRun(Results):
    """Results of a run at rest, without a simulation."""

    folder: Path
    shape: ColumnShape = SHAPE
    experiment: str = "paper"

    times = (0.0, 0.1, 0.2, 0.3)

    @property
    def case(self) -> Case:
        return load_case("coarse-channel", [f"score.experiment={self.experiment}"])

    @property
    def snapshots(self) -> list[Path]:
        return [self.folder / f"{i}.vtkhdf" for i in range(len(self.times))]

    @property
    def summary(self) -> dict[str, Any]:
        return {"status": "done", "at_rest": True}

    def snapshot(self, i: int) -> SimpleNamespace:
        return SimpleNamespace(time=self.times[i], stage="collapse")

    def measure(self, i: int = -1) -> Measurement:
        return deposit(1.5 * self.times[i] / 0.3, self.shape)

    @property
    def history(self) -> dict[str, np.ndarray]:
        time = np.append(np.linspace(-0.1, 0.0, 3), np.linspace(0.0, 0.4, 41))
        risen = np.clip(time / 0.25, 0.0, 1.0)
        total = self.shape.potential_energy(9.81)
        front = self.shape.r_i * (1.0 + 1.5 * risen)
        before = np.arange(44) < 3  # the last one ends at release, with a separate ledger
        return {
            "stage": np.where(before, "equilibrate", "collapse"),
            "time": time,
            "height": self.shape.h_i * (1.0 - 0.3 * risen),
            "potential": total * (1.0 - 0.6 * risen) + 5.0,
            "residual": 0.002 * total * risen,
            **dict.fromkeys(charts.FRONT_STYLES, front),
            **dict.fromkeys(charts.ENERGY_STYLES, np.where(before, 9.0 * total, 0.1 * total * risen)),
        }
