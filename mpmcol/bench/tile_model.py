"""Speed-up with several threads that the tiles of the points allow."""

from __future__ import annotations

import numpy as np

from mpmcol.mpm.grid import Tiles


def points_of_groups(tiles: Tiles) -> list[np.ndarray]:
    """Points of each tile in the order in which tiles are processed, one array for each group that has tiles."""
    points = np.diff(tiles.start)[tiles.grouped]
    return [group for group in np.split(points, tiles.group_start[1:-1]) if len(group)]


def largest_share(points: np.ndarray, threads: int) -> int:
    """Points of the busiest thread in a group whose tiles have `points` (n_tiles,) points.

    Numba's `prange` gives each thread consecutive tiles, as many as any other or one more; the first ones have more.
    """
    parts = np.array_split(points, min(threads, len(points)))  # further threads have no tile
    return max(int(part.sum()) for part in parts)


def model_speedup(groups: list[np.ndarray], threads: int) -> float:
    """Speed-up over one thread if time is proportional to points, and a group waits for its busiest thread."""
    return sum(int(group.sum()) for group in groups) / sum(largest_share(group, threads) for group in groups)
