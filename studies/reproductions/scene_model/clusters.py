"""Small clusters of nearby points with similar motion, on the floor (SA 3.5)."""

from dataclasses import dataclass

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.cluster.hierarchy import fcluster, linkage
from scipy.ndimage import median_filter

from peopleboy.studies.reproductions.scene_model.printed_config import PrintedConfig
from peopleboy.tracker.frame import DEPTH, Floats, Frame
from peopleboy.tracker.scene_model.connected_pieces import Bools
from peopleboy.tracker.scene_model.geometry import Geometry, grey_of
from peopleboy.tracker.scene_model.scene import Metres

# The filtered points of a frame with their velocities: 6-D data (SA 3.3, 3.4).

Grey = NDArray[np.uint8]


@dataclass(frozen=True, slots=True, eq=False)
class Cloud:
    """The points of a frame, organised as its image.

    Attributes:
        depth_m: (H, W) depth [m]; 0 where a reading was dropped.
        points_m: (H, W, 3) in the robot frame.
        velocity_m: (H, W, 3) displacement since the previous frame [m]; 0 where unknown.
        grey: (H, W) input of the optical flow.
    """

    depth_m: Metres
    points_m: Metres
    velocity_m: Metres
    grey: Grey

    @property
    def speed_m(self) -> Metres:
        """(H, W) displacement since the previous frame [m]."""
        return np.asarray(np.sqrt(np.einsum("hwk,hwk->hw", self.velocity_m, self.velocity_m)), np.float32)


class CloudMaker:
    """Computes the point cloud of each frame; the previous frame is stored.

    Args:
        config: settings.
    """

    def __init__(self, config: PrintedConfig) -> None:
        self._config = config
        self._before: Cloud | None = None

    def __call__(self, frame: Frame, geometry: Geometry) -> Cloud:
        """Filter a frame's readings, and estimate the motion of each point.

        Raises:
            BadInput: there are neither colours nor amplitude of the same pixels.
        """
        grey, amplitude = grey_of(frame)
        depth = _cleaned(frame.depth(DEPTH), amplitude, self._config)
        origin = geometry.calibration.robot_from_camera[:3, 3].astype(np.float32)
        points = origin + geometry.rays * depth[:, :, None]
        velocity = np.zeros_like(points)
        if self._before is not None:
            flow = _flow(grey, self._before.grey, config=self._config)
            velocity = _smoothed(_ways(points, depth, self._before.points_m, self._before.depth_m, flow))
        self._before = Cloud(depth, points, velocity, grey)
        return self._before


def _cleaned(depth: NDArray[np.uint16], amplitude: Metres, config: PrintedConfig) -> Metres:
    """Smooth (H, W) depths [mm], nearer ones more; drop dark and mixed readings (SA 3.3)."""
    fine, coarse = (cv2.medianBlur(depth, size) for size in (3, 5))
    coarsest = median_filter(depth, 7, mode="nearest")  # OpenCV's median of 16 bits has no 7 x 7 pixels
    near_mm, nearest_mm = 1000.0 * config.near_m, 1000.0 * config.nearest_m
    smooth = np.select([fine < nearest_mm, fine < near_mm], [coarsest, coarse], fine)
    smooth = smooth.astype(np.float32) / np.float32(1000.0)
    smooth[(depth == 0) | (amplitude < config.dark * float(amplitude.mean()))] = 0.0
    return np.asarray(
        _without_flying(smooth, config.neighbours, np.float32(config.edge_m), np.float32(config.edge_share)),
        np.float32,
    )


def _flow(grey: Grey, before: Grey, config: PrintedConfig) -> Metres:
    """Return the displacement (H, W, 2) [px] of each pixel to the previous frame; NaN where it is unknown.

    Hierarchical Lucas-Kanade (SA 3.4), for every pixel.
    """
    height, width = grey.shape
    pixels = np.stack(np.meshgrid(np.arange(width), np.arange(height)), axis=2).astype(np.float32)
    size, levels = (config.flow_px, config.flow_px), config.flow_levels - 1
    points = pixels.reshape(-1, 1, 2)
    places, found, _ = cv2.calcOpticalFlowPyrLK(
        grey, before, points, np.empty_like(points), winSize=size, maxLevel=levels
    )
    flow = places.reshape(height, width, 2) - pixels
    flow[found.reshape(height, width) == 0] = np.nan
    return np.asarray(flow, np.float32)


@njit(cache=True, nogil=True)
def _without_flying(depth, fewest, near_m, near_share):  # type: ignore[no-untyped-def]
    height, width = depth.shape
    kept = depth.copy()
    for v in range(1, height - 1):
        for u in range(1, width - 1):
            z = depth[v, u]
            near, count = max(near_m, near_share * z), -1
            for row in range(v - 1, v + 2):
                for column in range(u - 1, u + 2):
                    count += abs(depth[row, column] - z) < near
            if count < fewest:
                kept[v, u] = 0.0
    return kept


@njit(cache=True, nogil=True)
def _ways(points, depth, before, depth_before, flow):  # type: ignore[no-untyped-def]
    """Look up each point's predecessor in the previous frame, by optical flow."""
    height, width = depth.shape
    ways = np.zeros((height, width, 3), np.float32)
    for v in range(height):
        for u in range(width):
            if np.isnan(flow[v, u, 0]):
                continue
            column, row = round(u + flow[v, u, 0]), round(v + flow[v, u, 1])
            if depth[v, u] <= 0.0 or not (0 <= column < width and 0 <= row < height):
                continue
            if depth_before[row, column] > 0.0:
                for k in range(3):
                    ways[v, u, k] = points[v, u, k] - before[row, column, k]
    return ways


def _smoothed(ways: Metres) -> Metres:
    """Apply a 5 x 5 median to each component (SA 3.4)."""
    return np.stack([cv2.medianBlur(np.ascontiguousarray(ways[:, :, k]), 5) for k in range(3)], axis=2)


@dataclass(frozen=True, slots=True, eq=False)
class Clusters:
    """The clusters of a frame.

    Attributes:
        place_m: (L, 2) centroids on the floor [m].
        weight: (L,) numbers of points.
        velocity_m: (L, 2) mean displacement since the previous frame [m].
        is_moving: (L,) whether their points move.
        pixels: (N,) flat indices of the points.
        points_m: (N, 2) their positions on the floor.
    """

    place_m: Floats
    weight: Floats
    velocity_m: Floats
    is_moving: Bools
    pixels: NDArray[np.intp]
    points_m: Floats


def find_clusters(cloud: Cloud, candidates: Bools, config: PrintedConfig) -> Clusters:
    """Cluster the points of a mask (H, W) by complete linkage of positions and velocities (SA 3.5).

    The source prints neither the metric nor the level: a velocity counts as a length, and no two points of a
    cluster are farther apart than the level. The tree is built for each block of the image by itself, because
    linkage takes time with the square of the points; the clusters are smaller than a block of a person.
    """
    pixels = np.flatnonzero(candidates & (cloud.depth_m > 0.0))
    points = cloud.points_m.reshape(-1, 3)[pixels].astype(np.float64)
    ways = cloud.velocity_m.reshape(-1, 3)[pixels].astype(np.float64)
    data = np.hstack([points, config.velocity_weight * ways])
    index = _linked(data, _blocks(pixels, cloud.depth_m.shape[1], config.block_px), config.level_m)
    weight = np.bincount(index).astype(np.float64)

    def mean(values: Floats) -> Floats:
        sums = [np.bincount(index, column, len(weight)) for column in values.T]
        return np.asarray(np.stack(sums, axis=1) / weight[:, None])

    kept = weight >= config.least_points
    velocity = mean(ways)
    moving = np.linalg.norm(velocity, axis=1) > config.moving_m
    return Clusters(
        mean(points)[kept, :2], weight[kept], velocity[kept, :2], moving[kept], pixels, points[:, :2]
    )


def _blocks(pixels: NDArray[np.intp], width: int, side: int) -> NDArray[np.intp]:
    """Return the number (N,) of the square block of the image in which each pixel is."""
    rows, columns = np.divmod(pixels, width)
    return np.asarray(rows // side * width + columns // side)


def _linked(data: Floats, blocks: NDArray[np.intp], level: float) -> NDArray[np.intp]:
    """Return the cluster (N,), from 0 on, of each row of data (N, 6), by complete linkage in its block."""
    index = np.zeros(len(data), np.intp)
    order = np.argsort(blocks, kind="stable")
    first = np.flatnonzero(np.diff(blocks[order], prepend=-1))
    count = 0
    for rows in np.split(order, first[1:]) if len(order) else ():
        if len(rows) > 1:
            tree = linkage(data[rows], "complete")
            index[rows] = count + fcluster(tree, level, "distance") - 1
        else:
            index[rows] = count
        count = int(index[rows].max()) + 1
    return index
