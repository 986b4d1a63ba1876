"""Speed-up with several threads that the tiles of the points allow."""

from __future__ import annotations

import numpy as np

from mpmcol.mpm.grid import Tiles, share_tiles

USEFUL_THREADS = 8  # per tile: with more the largest share is hardly smaller


def points_of_groups(tiles: Tiles) -> list[np.ndarray]:
    """Points of each tile in the order in which tiles are processed, one array for each group that has tiles."""
    points = np.diff(tiles.start)[tiles.grouped]
    return [group for group in np.split(points, tiles.group_start[1:-1]) if len(group)]


def model_speedup(tiles: Tiles, threads: int) -> float:
    """Speed-up over one thread if time is proportional to points, and a group waits for its busiest thread."""
    before = np.concatenate(([0], np.cumsum(np.diff(tiles.start)[tiles.grouped])))
    useful = min(threads, USEFUL_THREADS * len(tiles.grouped))
    shares = np.diff(before[share_tiles(tiles, useful)], axis=1)  # points of each thread, (n_groups, threads)
    return float(shares.sum() / shares.max(axis=1).sum())
