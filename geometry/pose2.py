"""Planar poses: the group SE(2)."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Pose2:
    """Pose of a frame on the floor in its parent frame: x forward, y left, heading counter-clockwise.

    Points of the frame are called local, points of the parent frame global.

    Attributes:
        x, y: [m] origin.
        heading: [rad] direction of the x axis; need not be wrapped.
    """

    x: float = 0.0
    y: float = 0.0
    heading: float = 0.0

    def compose(self, child: "Pose2") -> "Pose2":
        """Return the global pose of a frame whose local pose is given; the heading is wrapped to +-pi."""
        x, y = self.transform_point((child.x, child.y))
        return Pose2(x, y, math.remainder(self.heading + child.heading, math.tau))

    def integrate(self, motion: "Pose2") -> "Pose2":
        """Return this pose after a motion in its own frame; the heading counts full turns."""
        # The matrix product and not `transform_point`: BLAS fuses multiplication and addition, which
        # differs in the last bit, and dead reckoning over a run must stay reproducible.
        x, y = np.array([self.x, self.y]) + self.rotation @ (motion.x, motion.y)
        return Pose2(float(x), float(y), self.heading + motion.heading)

    def inverse(self) -> "Pose2":
        """Return the pose of the parent frame in this one."""
        x, y = self.to_local((0.0, 0.0))
        return Pose2(x, y, -self.heading)

    def relative_to(self, other: "Pose2") -> "Pose2":
        """Return this pose in the frame of another one; the heading is wrapped to +-pi."""
        x, y = other.to_local((self.x, self.y))
        return Pose2(x, y, math.remainder(self.heading - other.heading, math.tau))

    def transform_point(self, local: tuple[float, float]) -> tuple[float, float]:
        """Map a local point x, y [m] to the parent frame."""
        cosine, sine = math.cos(self.heading), math.sin(self.heading)
        x, y = local
        return self.x + cosine * x - sine * y, self.y + sine * x + cosine * y

    def transform_points(self, local: Floats) -> Floats:
        """Map local points (N, 3) [m] to the parent frame; heights stay."""
        turn = np.eye(3)
        turn[:2, :2] = self.rotation
        return np.asarray(local @ turn.T + (self.x, self.y, 0.0))

    def transform_polar(self, distance: float, bearing: float) -> Floats:
        """Map a local point at a distance [m] and a bearing [rad] to the parent frame: (2,)."""
        angle = self.heading + bearing
        return np.array([self.x + distance * math.cos(angle), self.y + distance * math.sin(angle)])

    def to_local(self, point: tuple[float, float]) -> tuple[float, float]:
        """Map a global point x, y [m] to this frame."""
        dx, dy = point[0] - self.x, point[1] - self.y
        cosine, sine = math.cos(self.heading), math.sin(self.heading)
        return dx * cosine + dy * sine, dy * cosine - dx * sine

    def points_to_local(self, points: Floats) -> Floats:
        """Map global points (..., 2) [m] to this frame."""
        return self.vectors_to_local(points - np.array([self.x, self.y]))

    def vectors_to_local(self, vectors: Floats) -> Floats:
        """Rotate global vectors (..., 2) into this frame."""
        return np.asarray(vectors @ self.rotation)

    def covariance_to_local(self, covariance: Floats) -> Floats:
        """Rotate a global covariance (2, 2) into this frame."""
        return np.asarray(self.rotation.T @ covariance @ self.rotation)

    @property
    def rotation(self) -> Floats:
        """(2, 2) rotation matrix from this frame to its parent."""
        cosine, sine = math.cos(self.heading), math.sin(self.heading)
        return np.array([[cosine, -sine], [sine, cosine]])
