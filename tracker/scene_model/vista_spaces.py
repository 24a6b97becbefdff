"""Registration of places seen from several standing positions: by odometry, and by their surfaces."""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.spatial import cKDTree

from peopleboy.geometry.pose2 import Pose2
from peopleboy.geometry.small_matrices import symmetric_eigen
from peopleboy.tracker.frame import Floats
from peopleboy.tracker.scene_model.geometry import Geometry
from peopleboy.tracker.scene_model.scene import Metres

_CELL_M: Final = 0.05  # one point of the map per cell
_STEPS: Final = 30
_REACH_M: Final = 0.4  # of initial correspondences; it shrinks
_CLOSEST_M: Final = 0.08
_FEWEST: Final = 100
_EDGE: Final = 0.06  # greatest share of depth by which neighbours on one surface differ
_FLOOR_M: Final = 0.08  # the floor does not constrain the position on it


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """Points of static surfaces, with normals.

    Attributes:
        points_m: (N, 3).
        normals: (N, 3) of length 1, away from the camera.
    """

    points_m: Floats
    normals: Floats

    @classmethod
    def of(cls, depth_m: Metres, geometry: Geometry) -> "Surface":
        """Return the surface of a background (H, W) [m], in the robot frame, without edges."""
        origin = geometry.calibration.robot_from_camera[:3, 3]
        points = origin + geometry.rays.astype(np.float64) * depth_m[:, :, None]
        middle, z = points[1:-1, 1:-1], depth_m[1:-1, 1:-1]
        across = points[1:-1, 2:] - points[1:-1, :-2]
        down = points[2:, 1:-1] - points[:-2, 1:-1]
        normals = np.cross(across, down)
        length = np.linalg.norm(normals, axis=2)
        around = np.stack([depth_m[1:-1, 2:], depth_m[1:-1, :-2], depth_m[2:, 1:-1], depth_m[:-2, 1:-1]])
        is_whole = (around > 0.0).all(axis=0) & (np.abs(around - z).max(axis=0) < _EDGE * z) & (z > 0.0)
        kept = is_whole & (length > 0.0)
        return cls(middle[kept], normals[kept] / length[kept][:, None]).thinned()

    def thinned(self) -> "Surface":
        """Return it with one point per cell."""
        cells = np.floor(self.points_m / _CELL_M).astype(np.int64)
        _, first = np.unique(cells, axis=0, return_index=True)
        return Surface(self.points_m[first], self.normals[first])

    def seen_from(self, pose: Pose2) -> "Surface":
        """Transform it from the robot frame."""
        turn = Pose2(heading=pose.heading)
        return Surface(pose.transform_points(self.points_m), turn.transform_points(self.normals))

    def joined(self, other: "Surface") -> "Surface":
        """Return the union of two."""
        return Surface(
            np.concatenate([self.points_m, other.points_m]), np.concatenate([self.normals, other.normals])
        ).thinned()


def registered(surface: Surface, known: Surface, guess: Pose2) -> Pose2:
    """Correct the pose of a surface by registration with the known surface.

    Iterative closest points, point to plane, with three unknowns on the floor. Where too little is known, or
    nothing constrains the position along a wall, the initial pose is kept in that direction.
    """
    is_upright = known.points_m[:, 2] > _FLOOR_M
    if is_upright.sum() < _FEWEST:
        return guess
    tree, targets, normals = (
        cKDTree(known.points_m[is_upright]),
        known.points_m[is_upright],
        known.normals[is_upright],
    )
    own = surface.points_m[surface.points_m[:, 2] > _FLOOR_M]
    pose, reach = guess, _REACH_M
    for _ in range(_STEPS):
        moved = pose.transform_points(own)
        way, index = tree.query(moved, distance_upper_bound=reach)
        found = np.isfinite(way)
        if found.sum() < _FEWEST:
            return guess
        pose, step = _stepped(pose, moved[found], targets[index[found]], normals[index[found]])
        reach = max(0.8 * reach, _CLOSEST_M)
        if step < 1e-5 and reach == _CLOSEST_M:
            break
    return pose


def _stepped(pose: Pose2, points: Floats, targets: Floats, normals: Floats) -> tuple[Pose2, float]:
    """Take a least-squares step of the distances to planes, without unconstrained directions."""
    apart = ((targets - points) * normals).sum(axis=1)
    x, y = points[:, 0] - pose.x, points[:, 1] - pose.y
    rows = np.stack([normals[:, 0], normals[:, 1], x * normals[:, 1] - y * normals[:, 0]], axis=1)
    weight = 1.0 / np.maximum(np.abs(apart), 0.02)  # outliers count by their distance, not its square
    matrix = rows.T @ (rows * weight[:, None])
    values, vectors = symmetric_eigen(matrix)
    known = values > 0.02 * values[-1]
    move = vectors[:, known] @ ((vectors[:, known].T @ (rows.T @ (weight * apart))) / values[known])
    dx, dy, turn = move.tolist()
    heading = math.remainder(pose.heading + turn, math.tau)
    return Pose2(pose.x + dx, pose.y + dy, heading), float(np.abs(move).max())


class StaticMap:
    """The static surfaces seen so far, in the frame of the first place.

    Args:
        joins: whether places are registered, or joined by odometry alone.
    """

    def __init__(self, *, joins: bool) -> None:
        self._joins = joins
        self.surface: Surface | None = None

    def add(self, surface: Surface, guess: Pose2) -> Pose2:
        """Add a surface seen from a pose, and return the pose corrected by registration."""
        if self.surface is None:
            self.surface = surface.seen_from(guess)
            return guess
        pose = registered(surface, self.surface, guess) if self._joins else guess
        self.surface = self.surface.joined(surface.seen_from(pose))
        return pose
