"""What a sweep will cost, from the pace of this machine."""

from __future__ import annotations

from collections.abc import Sequence

from mpmcol.setup.cost import estimate
from mpmcol.sweep.compile_cache import kernels_of
from mpmcol.sweep.runs import PlannedRun


def forecast(points: Sequence[PlannedRun], threads: int) -> list[float]:
    """Seconds that each point will take, from the pace of the middle one of those that share kernels."""
    ordered = sorted(points, key=lambda point: point.work)
    groups: dict[tuple[object, ...], list[PlannedRun]] = {}
    for point in ordered:
        groups.setdefault(kernels_of(point), []).append(point)
    pace = {key: estimate(group[len(group) // 2].case, threads).ns_per_point_step for key, group in groups.items()}
    return [1e-9 * pace[kernels_of(point)] * point.work for point in points]
