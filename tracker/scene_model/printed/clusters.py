"""Small clusters of points that are near each other and move alike, on the ground (SA 3.5)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.frame import Floats
from peopleboy.tracker.scene_model.pieces import Bools
from peopleboy.tracker.scene_model.printed.cloud import Cloud
from peopleboy.tracker.scene_model.printed.printed_config import PrintedConfig

_STRIDE = 1 << 12  # of cells' numbers, more than there are in a row


@dataclass(frozen=True, slots=True, eq=False)
class Clusters:
    """The clusters of a frame.

    Attributes:
        place_m: (L, 2) centroids on the ground [m].
        weight: (L,) their points.
        velocity_m: (L, 2) mean way since the frame before [m].
        is_moving: (L,) whether their points move.
        pixels: (N,) flat indices of the points.
        points_m: (N, 2) where they are on the ground.
    """

    place_m: Floats
    weight: Floats
    velocity_m: Floats
    is_moving: Bools
    pixels: NDArray[np.intp]
    points_m: Floats


def find_clusters(cloud: Cloud, candidates: Bools, config: PrintedConfig) -> Clusters:
    """Cluster the points of a mask (H, W): those of a cell on the ground that move, and those that do not.

    The source clusters hierarchically by complete linkage, with a metric and a level that it does not print,
    into clusters that are small on purpose; cells are as small, and found in time linear in the points.
    """
    pixels = np.flatnonzero(candidates & (cloud.depth_m > 0.0))
    points = cloud.points_m.reshape(-1, 3)[pixels, :2].astype(np.float64)
    ways = cloud.velocity_m.reshape(-1, 3)[pixels, :2].astype(np.float64)
    is_moving = cloud.speed_m.ravel()[pixels] > config.moving_m
    cells = np.floor(points / config.cell_m).astype(np.int64) + _STRIDE // 2
    key = (cells[:, 0] * _STRIDE + cells[:, 1]) * 2 + is_moving
    _, index = np.unique(key, return_inverse=True)
    weight = np.bincount(index).astype(np.float64)

    def mean(values: Floats) -> Floats:
        sums = [np.bincount(index, column, len(weight)) for column in values.T]
        return np.asarray(np.stack(sums, axis=1) / weight[:, None])

    kept = weight >= config.least_points
    moving = np.bincount(index, is_moving, len(weight)) > 0
    return Clusters(mean(points)[kept], weight[kept], mean(ways)[kept], moving[kept], pixels, points)
